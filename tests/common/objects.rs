//! Random objects of test scenes, and what exact visibility finds of them.

use casca_scenes::world::{Camera, Motion, Object, Shape};
use casca_truth::oracle::{FalseNegative, Oracle, OracleOptions};

use super::*;

/// Spheres and boxes at such places, and boxes on the cells of a grid of one unit, which share faces
/// and fill cells.
pub fn shape(place: impl Strategy<Value = Vec3> + Clone + 'static) -> impl Strategy<Value = Shape> {
    let sphere = (place.clone(), 0.05..5.0f32).prop_map(|(center, radius)| Shape::Sphere { center, radius });
    let free = (place, points(0.0..7.0, 1.0)).prop_map(|(min, size)| Shape::Box { min, max: min + size });
    let on_cells = (prop::array::uniform3(-1..15i8), prop::array::uniform3(1..8i8)).prop_map(|(p, s)| {
        let min = Vec3::from_array(p.map(f32::from));
        Shape::Box { min, max: min + Vec3::from_array(s.map(f32::from)) }
    });
    prop_oneof![2 => sphere, 2 => free, 2 => on_cells]
}

/// Objects of such shapes that stand or move, and hide or do not.
pub fn object(shape: impl Strategy<Value = Shape>) -> impl Strategy<Value = Object> {
    (shape, any::<bool>(), prop::bool::weighted(0.8)).prop_map(|(shape, dynamic, occludes)| Object {
        name: String::new(),
        shape,
        motion: if dynamic { Motion::Dynamic { max_speed: 3.0 } } else { Motion::Static },
        occludes,
        tested: true,
    })
}

/// The shapes of an object that is no mesh.
pub fn shapes_of(object: &Object) -> (Bounds, Option<Occluder>) {
    match object.shape {
        Shape::Sphere { center, radius } => {
            let s = Sphere::new(center, radius);
            (s.into(), object.occludes.then(|| s.into()))
        }
        Shape::Box { min, max } => {
            let b = Aabb::new(min, max);
            (b.into(), object.occludes.then(|| b.into()))
        }
        Shape::Mesh { .. } => unreachable!("these scenes have no meshes"),
    }
}

pub fn describe(object: &Object) -> ObjectDesc {
    let (bounds, occluder) = shapes_of(object);
    let desc = match object.motion {
        Motion::Static => ObjectDesc::fixed(bounds),
        Motion::Dynamic { max_speed } => ObjectDesc::dynamic(bounds).max_speed(max_speed),
    };
    occluder.map_or(desc.clone(), |o| desc.occluder(o))
}

/// Of objects that a result leaves out, those that rays from a camera reach.
pub fn lost(
    objects: &[Object],
    camera: &Camera,
    seed: u64,
    sees: impl Fn(usize) -> bool,
) -> Vec<FalseNegative> {
    let options =
        OracleOptions { width: 160, height: 120, samples_per_object: 48, max_candidates: 1000, seed };
    Oracle::new(objects, options).frame(objects, &[], camera, &sees).false_negatives
}
