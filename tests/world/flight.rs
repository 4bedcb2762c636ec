//! The flight of the example `large_world`, compared with exact visibility.

use casca::glam::Vec3;
use casca_scenes::world::{Camera, Motion, Object, Shape};
use casca_truth::oracle::{Oracle, OracleOptions};

#[allow(dead_code, missing_docs)]
#[path = "../../examples/large_world.rs"]
mod large_world;

#[test]
fn a_flight_over_tiles_that_come_and_go_loses_nothing() {
    let (mut number, mut exact, mut lost) = (0, 0, 0);
    let show = &mut |frame: &large_world::Frame| {
        number += 1;
        if number % 110 != 1 {
            return;
        }
        let (ids, boxes): (Vec<_>, Vec<_>) = (frame.there)().into_iter().unzip();
        let object = |b: casca::Aabb| {
            let shape = Shape::Box { min: b.min, max: b.max };
            Object { name: String::new(), shape, motion: Motion::Static, occludes: true, tested: true }
        };
        let objects: Vec<Object> = boxes.into_iter().map(object).collect();
        let camera = Camera { eye: Vec3::ZERO, view: frame.look, projection: frame.projection };
        let camera = camera.at((frame.eye - frame.scene.origin()).as_vec3());
        let options = OracleOptions { width: 480, height: 270, samples_per_object: 1, ..Default::default() };
        let sees = |i: usize| frame.query.pvs().contains(ids[i]);
        let verdict = Oracle::new(&objects, options).frame(&objects, &[], &camera, &sees);
        (exact, lost) = (exact + verdict.exact.len(), lost + verdict.false_negatives.len());
    };
    large_world::fly(5000.0, show).unwrap();
    assert!(exact > 1000 && lost == 0, "{lost} of {exact}");
}
