//! Rays to the corners and the centre of a box.

use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::ray::Ray;

use super::rays::{Part, parts, tree};
use crate::numeric::baselines::END;
use casca_scenes::world::{Motion, Object};

/// Answers whether a box is in sight by nine rays, to its corners and its centre, as games usually
/// do.
///
/// A box of which only other points are in sight is lost.
pub struct NineRays {
    /// The static and the moving occluders.
    trees: [(Bvh2, Vec<Part>); 2],
}

/// The occluders of one kind of motion.
fn occluders(objects: &[Object], is_static: bool, params: BvhBuildParams) -> (Bvh2, Vec<Part>) {
    let mut found = Vec::new();
    for object in objects.iter().filter(|o| o.occludes && (o.motion == Motion::Static) == is_static) {
        parts(object, &mut found);
    }
    tree(found, params)
}

impl NineRays {
    /// Rays among the occluders of a scene.
    pub fn new(objects: &[Object]) -> Self {
        let fixed = occluders(objects, true, BvhBuildParams::medium_build());
        let moving = occluders(objects, false, BvhBuildParams::fastest_build());
        Self { trees: [fixed, moving] }
    }

    /// Takes up the places of moving objects.
    pub fn update(&mut self, objects: &[Object]) {
        self.trees[1] = occluders(objects, false, BvhBuildParams::fastest_build());
    }

    /// Whether one of the nine rays from an eye reaches its end.
    pub fn sees_box(&self, eye: Vec3, min: Vec3, max: Vec3) -> bool {
        let corner = |i: u32| Vec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), max, min);
        self.sees((min + max) * 0.5, eye) || (0..8).any(|i| self.sees(corner(i), eye))
    }

    /// Whether no occluder is on the way from an eye to a point.
    fn sees(&self, point: Vec3, eye: Vec3) -> bool {
        let way = Vec3A::from(point) - Vec3A::from(eye);
        let length = way.length();
        if length == 0.0 {
            return true;
        }
        let ray = Ray::new(eye.into(), way / length, 0.0, length * (1.0 - END));
        self.trees
            .iter()
            .all(|(bvh, parts)| parts.is_empty() || bvh.ray_traverse_miss(ray, |_, i| parts[i].hit(&ray)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use casca_scenes::world::Shape;

    #[test]
    fn a_box_is_seen_by_its_corners_and_centre_only() {
        let wall = |x0: f32, x1: f32| Object {
            name: String::new(),
            shape: Shape::Box { min: Vec3::new(x0, -9.0, -5.0), max: Vec3::new(x1, 9.0, -4.0) },
            motion: Motion::Static,
            occludes: true,
            tested: true,
        };
        // A slit that shows neither a corner nor the centre of the box behind it.
        let mut objects = vec![wall(-9.0, 0.4), wall(0.6, 9.0)];
        let mut rays = NineRays::new(&objects);
        let sees = |rays: &NineRays, x: f32, z: f32| {
            rays.sees_box(Vec3::ZERO, Vec3::new(x - 2.0, -2.0, z - 2.0), Vec3::new(x + 2.0, 2.0, z))
        };
        assert!(!sees(&rays, 0.0, -10.0));
        assert!(sees(&rays, 0.0, -3.0), "a corner before the wall");
        assert!(sees(&rays, 1.21, -10.0), "the centre behind the slit");
        // The right wall moves aside, and shows corners.
        objects[1].motion = Motion::Dynamic { max_speed: 1.0 };
        rays = NineRays::new(&objects);
        assert!(!sees(&rays, 0.0, -10.0));
        objects[1].shape = Shape::Box { min: Vec3::new(2.0, -9.0, -5.0), max: Vec3::new(9.0, 9.0, -4.0) };
        rays.update(&objects);
        assert!(sees(&rays, 0.0, -10.0));
    }
}
