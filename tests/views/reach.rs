//! Views whose eye may go some way. That their sets have all that any of these eyes sees is what
//! `tests/attack` tries.

use crate::common::worlds::{World, camera};
use crate::common::*;

#[test]
fn a_view_cell_may_stand_beside_a_wall() {
    let (world, eye) = wall();
    let behind = world.targets[0];
    let cell = |from: Vec3, to: Vec3| View::of_cell(Aabb::new(eye + from, eye + to)).unwrap();
    let mut query = Query::new();
    let mut sees = |view: View| query.run(&world.scene, &view).contains(behind);
    // The wall begins 7 before the eye.
    assert!(!sees(cell(Vec3::ZERO, Vec3::new(1.0, 1.0, 6.99))));
    assert!(sees(cell(Vec3::ZERO, Vec3::new(1.0, 1.0, 7.01))), "it meets the wall");
    assert!(sees(around(eye + Vec3::Z * 3.5).with_reach(3.57).unwrap()), "a ball");
}

#[test]
fn the_result_of_a_view_cell_holds_for_eyes_in_it() {
    let (world, eye) = wall();
    let half = Vec3::new(0.5, 0.0, 0.25);
    let view = View::of_cell(Aabb::new(eye - half, eye + half)).unwrap();
    let mut query = Query::new();
    let pvs = query.run(&world.scene, &view);
    for (step, holds) in [([0.49, 0.0, 0.24], true), ([0.0, 0.01, 0.0], false), ([0.0, 0.0, 0.26], false)] {
        let at = around(eye + Vec3::from(step));
        assert_eq!(pvs.is_valid_for(&world.scene, &at), holds, "{step:?}");
    }
    let ball = around(eye).with_reach(half.length()).unwrap();
    assert!(!pvs.is_valid_for(&world.scene, &ball));
    assert!(query.run(&world.scene, &ball.with_reach(0.6).unwrap()).is_valid_for(&world.scene, &view));
}

#[test]
fn a_view_cell_is_a_box() {
    let (low, high) = (Vec3::ONE, Vec3::splat(2.0));
    let bad = [(high, low), (Vec3::NAN, high), (low, Vec3::INFINITY), (Vec3::NEG_INFINITY, high)];
    for (low, high) in bad {
        assert!(View::of_cell(Aabb::new(low, high)).is_err(), "{low} {high}");
    }
    let point = View::of_cell(Aabb::new(low, low)).unwrap();
    assert_eq!(point, around(low));
    let cell = View::of_cell(Aabb::new(low, high)).unwrap();
    assert_eq!(cell.eye(), Some(DVec3::splat(1.5)));
    assert!(cell.reach() >= 0.75f64.sqrt() && cell.reach() < 0.87);
}

/// A wall across the grid, one object behind it and one at its side.
fn wall() -> (World, Vec3) {
    let wall = Aabb::new(Vec3::new(2.0, 2.0, 15.0), Vec3::new(30.0, 30.0, 17.0));
    let targets =
        [Sphere::new(Vec3::new(16.0, 16.0, 24.0), 1.0), Sphere::new(Vec3::new(31.5, 16.0, 17.5), 0.2)];
    (World::new(&[wall], &targets), Vec3::new(16.0, 16.0, 8.0))
}

#[test]
fn a_result_holds_for_all_eyes_within_reach() {
    let (world, eye) = wall();
    let view = around(eye);
    let mut query = Query::new();
    let pvs = query.run(&world.scene, &view.clone().with_reach(0.5).unwrap()).clone();
    assert!(!pvs.contains(world.targets[0]), "a wall still hides if it is half a unit smaller");
    for (step, holds) in [(0.0, true), (0.3, true), (0.499, true), (0.51, false)] {
        let at = around(eye + Vec3::X * step);
        assert_eq!(pvs.is_valid_for(&world.scene, &at), holds, "{step}");
        let close = at.with_reach(0.25).unwrap();
        assert_eq!(pvs.is_valid_for(&world.scene, &close), step == 0.0, "{step}");
    }
    assert!(!query.run(&world.scene, &view).is_valid_for(&world.scene, &around(eye + 0.01)));
    // Turned views see what this one does not.
    let planes = camera(eye, 2, 0.1);
    let ahead = View::from_planes(eye, &planes).unwrap().with_reach(0.5).unwrap();
    let pvs = query.run(&world.scene, &ahead);
    let moved = |by: f32| {
        let planes: Vec<Plane> =
            planes.iter().map(|p| Plane { offset: p.offset - p.normal.dot(Vec3::X * by), ..*p }).collect();
        View::from_planes(eye + Vec3::X * by, &planes).unwrap()
    };
    assert!(pvs.is_valid_for(&world.scene, &moved(0.4)) && !pvs.is_valid_for(&world.scene, &moved(0.6)));
    let turned = View::from_planes(eye, &camera(eye, 1, 0.1)).unwrap();
    assert!(!pvs.is_valid_for(&world.scene, &turned));
}

#[test]
fn solids_narrower_than_the_reach_hide_nothing() {
    let pole = Aabb::new(Vec3::new(15.0, 2.0, 15.0), Vec3::new(17.0, 30.0, 17.0));
    let world = World::new(&[pole], &[Sphere::new(Vec3::new(16.0, 16.0, 18.0), 0.1)]);
    let view = around(Vec3::new(16.0, 16.0, 6.0));
    let mut query = Query::new();
    for (reach, seen) in [(0.0, false), (0.5, false), (1.01, true)] {
        let pvs = query.run(&world.scene, &view.clone().with_reach(reach).unwrap());
        assert_eq!(pvs.contains(world.targets[0]), seen, "{reach}");
    }
}

#[test]
fn walls_thinner_than_the_reach_hide_what_is_behind_them() {
    let wall = Aabb::new(Vec3::new(2.0, 2.0, 16.0), Vec3::new(30.0, 30.0, 16.1));
    let targets = [16.0, 28.0].map(|x| Sphere::new(Vec3::new(x, 16.0, 24.0), 0.1));
    let world = World::new(&[wall], &targets);
    let view = around(Vec3::new(16.0, 16.0, 6.0));
    let mut query = Query::new();
    let pvs = query.run(&world.scene, &view.with_reach(0.5).unwrap());
    assert!(!pvs.contains(world.targets[0]) && !pvs.contains(world.targets[1]));
}

#[test]
fn a_reach_is_a_length() {
    let view = around(Vec3::ONE);
    for bad in [f32::NAN, f32::INFINITY, -1.0] {
        assert!(view.clone().with_reach(bad).is_err(), "{bad}");
    }
    let there_and_back = view.clone().with_reach(2.0).unwrap().with_reach(0.0).unwrap();
    assert_eq!(there_and_back, view);
    assert_eq!(view.with_reach(0.25).unwrap().reach(), 0.25);
}
