//! Objects of generated scenes.

use std::sync::Arc;

use glam::{Affine3A, Vec3};

use crate::world::{Mesh, Motion, Object, Shape};

pub(super) fn solid_box(name: &str, min: Vec3, max: Vec3) -> Object {
    object(name, Shape::Box { min, max })
}

pub(super) fn object(name: &str, shape: Shape) -> Object {
    Object { name: name.to_owned(), shape, motion: Motion::Static, occludes: true, tested: true }
}

/// A mesh in world space.
pub(super) fn mesh(mesh: Mesh) -> Shape {
    Shape::Mesh { mesh: Arc::new(mesh), transform: Affine3A::IDENTITY }
}

/// A box with its base at `base`.
pub(super) fn standing_box(name: &str, base: Vec3, size: Vec3) -> Object {
    let half = Vec3::new(size.x * 0.5, 0.0, size.z * 0.5);
    solid_box(name, base - half, base + half + Vec3::Y * size.y)
}
