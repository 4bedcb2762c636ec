//! Objects of generated scenes, and models that several of them use.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};

use crate::random::Dice;
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

/// A mesh scaled, turned about the y axis and placed.
pub(super) fn placed(mesh: &Arc<Mesh>, size: Vec3, turn: f32, at: Vec3) -> Shape {
    let transform = Affine3A::from_scale_rotation_translation(size, Quat::from_rotation_y(turn), at);
    Shape::Mesh { mesh: mesh.clone(), transform }
}

/// A box with its base at `base`.
pub(super) fn standing_box(name: &str, base: Vec3, size: Vec3) -> Object {
    let half = Vec3::new(size.x * 0.5, 0.0, size.z * 0.5);
    solid_box(name, base - half, base + half + Vec3::Y * size.y)
}

/// A place on a square of flat ground, farther than `margin` from its border and the eyes of a walk.
pub(super) fn beside(eyes: &[Vec3], dice: &mut Dice, (size, ground): (f32, f32), margin: f32) -> Vec3 {
    let (flat, lo, hi) = (Vec3::new(1.0, 0.0, 1.0), Vec3::splat(margin), Vec3::splat(size - margin));
    loop {
        let p = dice.point(lo.with_y(ground), hi.with_y(ground));
        if eyes.iter().all(|eye| ((*eye - p) * flat).length() > margin) {
            return p;
        }
    }
}

/// Beams along the three axes and other boxes, by their least corners and sizes, as one mesh.
pub(super) fn beams(parts: &[([f32; 3], [f32; 3])]) -> Mesh {
    let mut all = Mesh::default();
    for &(least, size) in parts {
        let least = Vec3::from(least);
        all.append(Mesh::cuboid(least, least + Vec3::from(size)));
    }
    all
}

/// A prism with this number of sides around the y axis, of radius 1 and from y = 0 to 1.
pub(super) fn prism(sides: u32) -> Mesh {
    let rim = |i: u32, y: f32| {
        let (sin, cos) = (TAU * i as f32 / sides as f32).sin_cos();
        Vec3::new(cos, y, sin)
    };
    let mut positions: Vec<Vec3> = (0..sides).flat_map(|i| [rim(i, 0.0), rim(i, 1.0)]).collect();
    positions.extend([Vec3::ZERO, Vec3::Y]);
    let triangle = |i: u32| {
        let (a, b) = (2 * i, 2 * ((i + 1) % sides));
        [[a, a + 1, b + 1], [a, b + 1, b], [2 * sides, a, b], [2 * sides + 1, b + 1, a + 1]]
    };
    Mesh { positions, triangles: (0..sides).flat_map(triangle).collect(), ..Mesh::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_are_closed() {
        assert!([6, 10].map(prism).iter().all(Mesh::is_closed));
        let two = beams(&[([0.0; 3], [1.0; 3]), ([1.0, 0.0, 0.0], [1.0, 0.5, 0.5])]);
        assert!(two.is_closed() && two.triangles.len() == 24);
    }
}
