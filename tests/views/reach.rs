//! Views whose eye may go some way: their sets have all that any of these eyes sees, by segments
//! cut by the shapes themselves.

use crate::common::worlds::{Solid, World, camera, point, solid, steps, target};
use crate::common::*;

/// All that these eyes see, whose half-spaces go with them, is in the set of a view.
fn are_served(world: &World, view: &View, planes: &[Plane], eyes: &[Vec3]) -> Result<(), TestCaseError> {
    for method in [Method::point(), Method::Point(PointOptions::fast()), Method::cell(), Method::Frustum] {
        let mut query = query_by(method);
        let pvs = query.run(&world.scene, view);
        prop_assert!(pvs.is_valid_for(&world.scene, view));
        for eye in eyes.iter().map(|eye| eye.as_dvec3()) {
            let moved = |p: &Plane| {
                let normal = p.normal.as_dvec3();
                (normal, f64::from(p.offset) - normal.dot(eye - view.eye().unwrap()))
            };
            for id in world.seen(eye, &planes.iter().map(moved).collect::<Vec<_>>()) {
                prop_assert!(pvs.contains(id), "{method:?}: {id} from {eye}, {view:?}");
            }
        }
    }
    Ok(())
}

/// Half of an edge of a view cell, which may be flat.
fn half() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0f32), 0.0f32..0.3, 0.0f32..3.0]
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn all_eyes_within_reach_are_served(
        solids in prop::collection::vec(solid(), 1..14),
        targets in prop::collection::vec(target(), 60),
        (eye, axis) in (point(), prop::option::of(0usize..3)),
        near in 0.05f32..1.0,
        reach in prop_oneof![Just(0.01f32), 0.0f32..0.3, 0.0f32..3.0],
        steps in steps(),
    ) {
        let planes = axis.map_or_else(Vec::new, |axis| camera(eye, axis, near));
        let view = View::from_planes(eye, &planes).unwrap().with_reach(reach).unwrap();
        let eyes: Vec<Vec3> = steps.iter().map(|step| eye + *step * reach * 0.999).collect();
        are_served(&World::new(&solids, &targets), &view, &planes, &eyes)?;
    }

    #[test]
    fn all_eyes_of_a_view_cell_are_served(
        solids in prop::collection::vec(solid(), 1..14),
        targets in prop::collection::vec(target(), 60),
        middle in point(),
        half in prop::array::uniform3(half()).prop_map(Vec3::from),
        steps in prop::collection::vec(prop::array::uniform3(-1.5f32..1.5), 12),
    ) {
        let cell = Aabb::new(middle - half, middle + half);
        // Most on the sides, some in corners.
        let eye = |step: &[f32; 3]| (middle + half * Vec3::from(*step)).clamp(cell.min, cell.max);
        let eyes: Vec<Vec3> = steps.iter().map(eye).collect();
        are_served(&World::new(&solids, &targets), &View::of_cell(cell).unwrap(), &[], &eyes)?;
    }
}

/// Walls with one hole, along a line from one corner of a view cell: few random solids leave an
/// object that only one eye of a cell sees.
#[test]
fn what_one_corner_of_a_view_cell_sees_through_a_hole_is_found() {
    let mut random = Random(5);
    let mut next = move || random.unit();
    let (mut checked, mut hidden) = (0, 0);
    for round in 0..2000 {
        // With `Cell`, rooms that are a little larger than a cell of the grid, or much.
        let size = if round % 2 == 0 { 0.2 } else { 4.0 };
        let eye = Vec3::new(10.0 + next(), 20.0 + next(), 20.0 + next());
        let half = Vec3::new(0.5 * next(), next(), next()) * size;
        let side = |c: f32| if c < 0.5 { 1.0 } else { -1.0 };
        let corner = eye + half * Vec3::new(1.0, side(next()), side(next()));
        let (from, wide) = ((corner.x + 0.1 + 4.0 * next()).round().max(corner.x + 0.1), 0.02 + 0.4 * next());
        let to = from + 1.0 + (2.0 * next()).round();
        let slope = Vec3::new(1.0, 2.4 * next() - 1.2, 2.4 * next() - 1.2);
        let at = |x: f32| corner + slope * (x - corner.x);
        let (low, high) = (at(from).min(at(to)) - wide, at(from).max(at(to)) + wide);
        let mut scene = empty();
        let mut ball = |at: Vec3| scene.fixed(Sphere::new(at, 0.05));
        let seen = ball(at(to + 3.0 + 3.0 * next()));
        let behind = ball(Vec3::new(to + 4.0, 36.0, 36.0));
        for [y0, y1, z0, z1] in [
            [1.0, low.y, 1.0, 39.0],
            [high.y, 39.0, 1.0, 39.0],
            [low.y, high.y, 1.0, low.z],
            [low.y, high.y, high.z, 39.0],
        ] {
            scene.solid(Aabb::new(Vec3::new(from, y0, z0), Vec3::new(to, y1, z1)));
        }
        let view = View::of_cell(Aabb::new(eye - half, eye + half)).unwrap();
        for method in [Method::cell(), Method::point()] {
            let mut query = query_by(method);
            let pvs = query.run(&scene, &view);
            assert!(pvs.contains(seen), "{method:?}: from {corner} in {half} around {eye}");
            checked += 1;
            hidden += u32::from(!pvs.contains(behind));
        }
    }
    assert!(hidden > checked / 3, "{hidden} {checked}");
}

#[test]
fn a_view_cell_may_stand_beside_a_wall() {
    let (world, eye) = wall();
    let behind = world.targets[0].0;
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
    let wall = Solid::Box(Aabb::new(Vec3::new(2.0, 2.0, 15.0), Vec3::new(30.0, 30.0, 17.0)));
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
    assert!(!pvs.contains(world.targets[0].0), "a wall still hides if it is half a unit smaller");
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
    let pole = Solid::Box(Aabb::new(Vec3::new(15.0, 2.0, 15.0), Vec3::new(17.0, 30.0, 17.0)));
    let world = World::new(&[pole], &[Sphere::new(Vec3::new(16.0, 16.0, 18.0), 0.1)]);
    let view = around(Vec3::new(16.0, 16.0, 6.0));
    let mut query = Query::new();
    for (reach, seen) in [(0.0, false), (0.5, false), (1.01, true)] {
        let pvs = query.run(&world.scene, &view.clone().with_reach(reach).unwrap());
        assert_eq!(pvs.contains(world.targets[0].0), seen, "{reach}");
    }
}

#[test]
fn walls_thinner_than_the_reach_hide_what_is_behind_them() {
    let wall = Solid::Box(Aabb::new(Vec3::new(2.0, 2.0, 16.0), Vec3::new(30.0, 30.0, 16.1)));
    let targets = [16.0, 28.0].map(|x| Sphere::new(Vec3::new(x, 16.0, 24.0), 0.1));
    let world = World::new(&[wall], &targets);
    let view = around(Vec3::new(16.0, 16.0, 6.0));
    let mut query = Query::new();
    let pvs = query.run(&world.scene, &view.with_reach(0.5).unwrap());
    assert!(!pvs.contains(world.targets[0].0) && !pvs.contains(world.targets[1].0));
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
