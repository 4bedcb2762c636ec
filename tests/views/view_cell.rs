//! Results of the cell method stand for every eye of the cell. `tests/attack` looks from many of these
//! eyes, and by views of all kinds; here are single cases.

use crate::common::*;

/// The radius of a ball behind an edge. The line of sight to it passes the edge at more than that.
const SPECK: f32 = 1e-5;

fn cell_query() -> Query {
    query_by(Method::cell())
}

/// A block in the way of a narrow frustum, and a ball behind it.
fn behind_a_block() -> (Scene, ObjectId, Vec<Plane>) {
    let mut scene = empty();
    scene.solid(Aabb::new(Vec3::new(6.0, 6.0, 5.0), Vec3::new(7.0, 7.0, 6.0)));
    let ball = scene.fixed(Sphere::new(Vec3::new(6.5, 7.03, 9.6), 0.02));
    // From (6.5, 6.5, 2.5) along z, up to slopes of 0.02 across and 0.05 to 0.08 along y.
    let spaces = [(1.0, 0.0, 0.02), (-1.0, 0.0, 0.02), (0.0, 1.0, -0.05), (0.0, -1.0, 0.08)];
    let eye = Vec3::new(6.5, 6.5, 2.5);
    let planes = spaces.map(|(x, y, z)| {
        let normal = Vec3::new(x, y, z);
        Plane { normal, offset: -normal.dot(eye) }
    });
    (scene, ball, planes.to_vec())
}

#[test]
fn an_eye_beside_the_first_sees_past_what_bounds_its_frustum() {
    let (scene, ball, planes) = behind_a_block();
    let mut query = cell_query();
    let eye = Vec3::new(6.5, 6.5, 2.5);
    let pvs = query.run(&scene, &View::from_planes(eye, &planes).unwrap()).clone();
    // At the block's back, z = 6, the line from here to the ball is at y = 7.014.
    let high = Vec3::new(6.5, 6.999, 2.5);
    assert!(Query::new().run(&scene, &around(high)).contains(ball));
    assert!(pvs.contains(ball) && pvs.view_cell() == Some(IVec3::new(6, 6, 2)));

    // From an eye further ahead, what lies in these half-spaces lies in those.
    let narrower = |eye: Vec3| {
        let spaces = [(1.0, 0.0, 0.01), (-1.0, 0.0, 0.01), (0.0, 1.0, -0.06), (0.0, -1.0, 0.07)];
        let plane = |(x, y, z)| {
            let normal = Vec3::new(x, y, z);
            Plane { normal, offset: -normal.dot(eye) }
        };
        View::from_planes(eye, &spaces.map(plane)).unwrap()
    };
    assert!(pvs.is_valid_for(&scene, &narrower(eye + Vec3::new(0.0, 0.026, 0.4))));
    assert!(!pvs.is_valid_for(&scene, &narrower(eye + Vec3::new(0.0, 0.039, 0.6))), "another cell");
    assert!(!pvs.is_valid_for(&scene, &narrower(eye + Vec3::new(0.0, 0.1, 0.4))), "it sees more");
    // Its half-spaces cut off the block's front from this eye, which sees through it.
    assert!(!pvs.is_valid_for(&scene, &View::from_planes(high, &planes).unwrap()));
}

#[test]
fn an_eye_that_may_lie_in_an_occluder_sees_through_it() {
    let mut scene = empty();
    let wall = Aabb::new(Vec3::new(4.0, 0.0, 0.0), Vec3::new(8.0, 16.0, 16.0));
    scene.solid(wall);
    let ball = scene.fixed(Sphere::new(Vec3::new(12.0, 9.0, 9.0), 3.0));
    // A matrix leaves open where the eye is, by more than it is before the wall.
    let eye = Vec3::new(3.999_985, 8.9, 9.1);
    let m = lens(eye, Vec3::X, [0.03, 1.0, 1e-6, 60.0]);
    let mut query = cell_query();
    let exact = query.run(&scene, &View::perspective(eye, m).unwrap());
    assert!(!exact.contains(ball) && !exact.stats().eye_in_occluder);
    let found = query.run(&scene, &View::from_view_projection(m).unwrap());
    assert!(found.contains(ball) && found.stats().eye_in_occluder);
}

#[test]
fn a_result_does_not_hold_for_an_eye_in_an_occluder_of_its_cell() {
    let mut scene = empty();
    scene.solid(Aabb::new(Vec3::new(6.5, 6.0, 2.0), Vec3::splat(9.0)));
    let eye = Vec3::new(6.25, 6.5, 2.5);
    let mut query = cell_query();
    let pvs = query.run(&scene, &around(eye));
    assert!(pvs.is_valid_for(&scene, &around(eye + Vec3::X * 0.125)));
    assert!(!pvs.is_valid_for(&scene, &around(eye + Vec3::X * 0.5)), "it sees out of the occluder");
}

#[test]
fn an_eye_beside_the_cell_sees_past_a_block_at_the_edge_of_a_side() {
    let mut scene = empty();
    scene.solid(Aabb::new(Vec3::new(-8.0, -10.0, 8.0), Vec3::new(-2.0, -6.0, 12.0)));
    let speck = scene.fixed(Sphere::new(Vec3::new(-57.622_963, -56.417_08, 58.570_54), SPECK));
    // Cells on all sides of the eye's.
    scene.fixed(Sphere::new(Vec3::new(20.0, 20.0, -20.0), 1.0));
    let view = around(Vec3::ZERO).with_reach(0.107).unwrap();
    let eye = Vec3::new(-0.076_368_61, 0.0, -0.074_937_634);
    assert!(view.reach() > f64::from(eye.length()));
    assert!(Query::new().run(&scene, &around(eye)).contains(speck));
    assert!(cell_query().run(&scene, &view).contains(speck));
}
