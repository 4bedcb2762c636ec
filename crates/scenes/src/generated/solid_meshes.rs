//! Scenes of solids with triangle meshes instead of the solids.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};

use crate::world::{Animation, Camera, Mesh, Motion, Shape, World};

/// The meshes that moving solids share, under transforms.
struct Models {
    /// Vertices at distance 1 from the origin, so that it lies in the sphere.
    ball: Arc<Mesh>,
    /// From the origin to (1, 1, 1).
    cube: Arc<Mesh>,
}

impl Models {
    fn shape(&self, solid: Shape) -> Shape {
        match solid {
            Shape::Sphere { center, radius } => Shape::Mesh {
                mesh: self.ball.clone(),
                transform: Affine3A::from_scale_rotation_translation(
                    Vec3::splat(radius),
                    Quat::IDENTITY,
                    center,
                ),
            },
            Shape::Box { min, max } => Shape::Mesh {
                mesh: self.cube.clone(),
                transform: Affine3A::from_scale_rotation_translation(max - min, Quat::IDENTITY, min),
            },
            mesh => mesh,
        }
    }
}

/// The animation of a scene of solids, as one of meshes.
struct Meshed {
    solids: Box<dyn Animation>,
    models: Models,
}

impl Animation for Meshed {
    fn shapes(&self, frame: usize, set: &mut dyn FnMut(usize, Shape)) {
        self.solids.shapes(frame, &mut |index, shape| set(index, self.models.shape(shape)));
    }

    fn camera(&self, frame: usize, aspect: f32) -> Camera {
        self.solids.camera(frame, aspect)
    }
}

/// The same scene with each solid as a mesh; spheres have 20 times 4^`cuts` triangles.
pub(super) fn meshed(mut world: World, cuts: u32) -> World {
    let models =
        Models { ball: Arc::new(Mesh::ball(cuts)), cube: Arc::new(Mesh::cuboid(Vec3::ZERO, Vec3::ONE)) };
    for object in &mut world.objects {
        let solid = object.shape.clone();
        object.shape = match solid {
            // The exact corners, so that neighbours abut as before.
            Shape::Box { min, max } if object.motion == Motion::Static => {
                super::parts::mesh(Mesh::cuboid(min, max))
            }
            solid => models.shape(solid),
        };
    }
    world.name.push_str("-meshes");
    world.animation = Box::new(Meshed { solids: world.animation, models });
    world
}
