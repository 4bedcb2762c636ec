//! The scenes of the tests.

use std::sync::Arc;

use casca::{Aabb, GridSpec, Light, ObjectDesc, ObjectId, Query, Scene, View};
use casca_scenes::world::{Mesh, Motion, Object, Shape};
use casca_truth::places::points;
use glam::camera::rh::{proj::directx, view::look_to_mat4};
use glam::{Affine3A, EulerRot, Quat, UVec3, Vec3};
use proptest::prelude::*;

/// Random objects lie in a cube of this size, or near it.
pub const SIZE: f32 = 16.0;

/// The greatest speed of random objects that move.
pub const SPEED: f32 = 3.0;

/// The name of objects that are reported on expiry only.
pub const SILENT: &str = "silent";

pub fn vector(range: std::ops::Range<f32>) -> impl Strategy<Value = Vec3> {
    points(range, 1.0)
}

pub fn direction() -> impl Strategy<Value = Vec3> {
    let any = vector(-1.0..1.0).prop_map(|d| d.normalize_or(Vec3::X));
    let axis = (0..6usize).prop_map(|i| if i % 2 == 0 { Vec3::AXES[i / 2] } else { -Vec3::AXES[i / 2] });
    prop_oneof![3 => any, 1 => axis]
}

fn shape() -> impl Strategy<Value = Shape> {
    let place = || prop_oneof![6 => vector(0.0..SIZE), 1 => vector(-SIZE..2.0 * SIZE)];
    let sphere = (place(), 0.1..3.0f32).prop_map(|(center, radius)| Shape::Sphere { center, radius });
    let free = (place(), vector(0.0..5.0)).prop_map(|(min, size)| Shape::Box { min, max: min + size });
    // Such boxes share faces.
    let on_cells = (prop::array::uniform3(-1..15i8), prop::array::uniform3(1..6i8)).prop_map(|(p, s)| {
        let min = Vec3::from_array(p.map(f32::from));
        Shape::Box { min, max: min + Vec3::from_array(s.map(f32::from)) }
    });
    let slab = (0..3usize, 0..16i8).prop_map(|(axis, at)| {
        let (mut min, mut max) = (Vec3::ZERO, Vec3::splat(SIZE));
        (min[axis], max[axis]) = (f32::from(at), f32::from(at) + 1.0);
        Shape::Box { min, max }
    });
    let mesh = (place(), vector(-3.0..3.0), 0.2..4.0f32, any::<bool>()).prop_map(|(at, turn, size, open)| {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let triangles = if open { triangles[..2].to_vec() } else { triangles };
        let turn = Quat::from_euler(EulerRot::XYZ, turn.x, turn.y, turn.z);
        let transform = Affine3A::from_scale_rotation_translation(Vec3::splat(size), turn, at);
        Shape::Mesh { mesh: Arc::new(Mesh { positions, triangles, ..Mesh::default() }), transform }
    });
    prop_oneof![3 => sphere, 3 => free, 3 => on_cells, 1 => slab, 2 => mesh]
}

pub fn object() -> impl Strategy<Value = Object> {
    (shape(), 0..5u8, prop::bool::weighted(0.8)).prop_map(|(shape, kind, occludes)| Object {
        name: if kind == 0 { SILENT.into() } else { String::new() },
        shape,
        motion: if kind < 3 { Motion::Dynamic { max_speed: SPEED } } else { Motion::Static },
        occludes,
        tested: true,
    })
}

/// The sun at noon.
pub const ABOVE: Light = Light::directional(Vec3::NEG_Y);

/// An empty scene of 64x32x64 cells.
pub fn street() -> Scene {
    Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::new(64, 32, 64) }).unwrap()
}

pub fn solid(scene: &mut Scene, min: [f32; 3], max: [f32; 3]) -> ObjectId {
    let b = Aabb::new(min.into(), max.into());
    scene.insert(ObjectDesc::fixed(b).occluder(b)).unwrap()
}

/// Looks along -z from (32, 4, 50), as far as 40.
pub fn ahead() -> View {
    let eye = Vec3::new(32.0, 4.0, 50.0);
    let matrix = directx::perspective(0.8, 1.5, 0.1, 40.0) * look_to_mat4(eye, Vec3::NEG_Z, Vec3::Y);
    View::perspective(eye, matrix).unwrap()
}

pub fn casters(scene: &Scene, view: &View, light: Vec3) -> Vec<ObjectId> {
    let (mut camera, mut out) = (Query::new(), Vec::new());
    camera.run(scene, view);
    Query::new().shadow_casters(scene, &camera, &Light::directional(light), &mut out).unwrap();
    out
}
