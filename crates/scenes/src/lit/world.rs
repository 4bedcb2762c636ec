//! A test scene of the laboratory, lit.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use rand::RngExt;

use super::{ASPECT, Falloff, Light, LightKind, LitObject, LitScene, Material};
use crate::random::generator;
use crate::world::{Mesh, Motion, Object, Shape, World};

/// How often the triangles of a sphere are cut into four: 1,280 triangles.
const BALL_CUTS: u32 = 3;

impl LitScene {
    /// A test scene at the frame it is set to, with its camera of `frame`: objects in seeded
    /// colours, a sun and a pale sky.
    pub fn of_world(world: &World, frame: usize, seed: u64) -> Self {
        let mut random = generator(seed, 0);
        let mut scene = Self::bare(world, frame);
        for (i, object) in scene.objects.iter_mut().enumerate() {
            let channel = |_| random.random_range(0.2..0.8);
            scene.materials.push(Material::matt(Vec3::from_array(std::array::from_fn(channel))));
            object.materials = vec![i as u32; object.mesh.triangles.len()].into();
        }
        scene
    }

    /// The same without materials.
    pub(crate) fn bare(world: &World, frame: usize) -> Self {
        let ball = Arc::new(Mesh::ball(BALL_CUTS));
        let object = |object: &Object| {
            let (mesh, transform) = mesh_of(&object.shape, &ball);
            let moves = object.motion != Motion::Static;
            LitObject { name: object.name.clone(), materials: Arc::default(), mesh, transform, moves }
        };
        Self {
            name: world.name.clone(),
            objects: world.objects.iter().map(object).collect(),
            materials: Vec::new(),
            lights: vec![Light {
                kind: LightKind::Directional { direction: Vec3::new(0.35, -1.0, 0.25), half_angle: 0.0 },
                color: Vec3::new(3.0, 2.8, 2.5),
                falloff: Falloff::INVERSE_SQUARE,
            }],
            sky: Vec3::new(0.3, 0.36, 0.45),
            camera: world.camera(frame, ASPECT),
        }
    }
}

/// The triangles of a shape, and where they are.
pub(crate) fn mesh_of(shape: &Shape, ball: &Arc<Mesh>) -> (Arc<Mesh>, Affine3A) {
    match shape {
        Shape::Sphere { center, radius } => {
            let place = Affine3A::from_scale_rotation_translation(
                Vec3::splat(*radius),
                glam::Quat::IDENTITY,
                *center,
            );
            (ball.clone(), place)
        }
        Shape::Box { min, max } => (Arc::new(Mesh::cuboid(*min, *max)), Affine3A::IDENTITY),
        Shape::Mesh { mesh, transform } => (mesh.clone(), *transform),
    }
}
