//! The scenes of the tests.

use casca_scenes::world::{Mesh, Motion, Object, Shape};

use crate::common::objects::shape;
use crate::common::*;

/// Random objects lie in a cube of this size, or near it.
pub const SIZE: f32 = 16.0;

/// The greatest speed of random objects that move.
pub const SPEED: f32 = 3.0;

/// The name of objects that are reported on expiry only.
pub const SILENT: &str = "silent";

/// Directions, often along an axis.
pub fn way() -> impl Strategy<Value = Vec3> {
    let axis = (0..6usize).prop_map(|i| if i % 2 == 0 { Vec3::AXES[i / 2] } else { -Vec3::AXES[i / 2] });
    prop_oneof![3 => direction(), 1 => axis]
}

pub fn place() -> impl Strategy<Value = Vec3> + Clone {
    prop_oneof![6 => vector(0.0..SIZE), 1 => vector(-SIZE..2.0 * SIZE)]
}

fn some_shape() -> impl Strategy<Value = Shape> {
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
    prop_oneof![9 => shape(place()), 1 => slab, 2 => mesh]
}

pub fn object() -> impl Strategy<Value = Object> {
    (some_shape(), 0..5u8, prop::bool::weighted(0.8)).prop_map(|(shape, kind, occludes)| Object {
        name: if kind == 0 { SILENT.into() } else { String::new() },
        shape,
        motion: if kind < 3 { Motion::Dynamic { max_speed: SPEED } } else { Motion::Static },
        occludes,
        tested: true,
    })
}

/// The sun at noon.
pub const ABOVE: Light = Light::directional(Vec3::NEG_Y);

pub fn solid(scene: &mut Scene, min: [f32; 3], max: [f32; 3]) -> ObjectId {
    let b = Aabb::new(min.into(), max.into());
    scene.solid(b)
}

/// Looks along -z from (32, 4, 50), as far as 40.
pub fn ahead() -> View {
    let eye = Vec3::new(32.0, 4.0, 50.0);
    looking(eye, Vec3::NEG_Z, [0.8, 1.5, 0.1, 40.0])
}

pub fn casters(scene: &Scene, view: &View, light: Vec3) -> Vec<ObjectId> {
    let (mut camera, mut out) = (Query::new(), Vec::new());
    camera.run(scene, view);
    Query::new().shadow_casters(scene, &camera, &Light::directional(light), &mut out).unwrap();
    out
}
