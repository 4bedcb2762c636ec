//! Walls against sampled eyes and points.

use casca::glam::{Affine3A, Vec3};
use casca::{Aabb, ObjectDesc, Scene, TriMesh};
use casca_scenes::random::{Generator, generator};
use casca_truth::places::{self, coordinates};
use proptest::prelude::*;
use rand::RngExt;

use super::*;
use crate::wall::Side;

fn wall() -> Wall {
    // In y from 0 to 3 and in z from -2 to 2, at x = 5.
    Wall { axis: 0, at: 5.0, from: Side::Both, min: [0.0, -2.0], max: [3.0, 2.0] }
}

fn eyes(center: DVec3, reach: f64) -> Eyes {
    Eyes::new(center, reach, Span { min: center - reach, max: center + reach })
}

fn cuboid(center: DVec3, half: f64) -> Span {
    Span { min: center - half, max: center + half }
}

#[test]
fn a_wall_hides_what_no_eye_sees_past_it() {
    let hides = |reach, half, z| {
        let (eyes, target) = (eyes(DVec3::new(0.0, 1.5, 0.0), reach), cuboid(DVec3::new(7.0, 1.5, z), half));
        wall().hides(&eyes, &target, 0.0)
    };
    assert!(hides(0.0, 0.1, 0.0) && hides(0.5, 0.5, 0.0));
    // From the middle, z = 2 at x = 5 is seen at z = 2.8 at x = 7.
    assert!(hides(0.0, 0.0, 2.79) && !hides(0.0, 0.0, 2.81));
    // An eye 0.5 m to the side sees 0.2 m more.
    assert!(hides(0.5, 0.0, 2.55) && !hides(0.5, 0.0, 2.65));
    assert!(!hides(0.0, 2.5, 0.0), "it sticks out");
    let beside = cuboid(DVec3::new(3.0, 1.5, 0.0), 0.5);
    assert!(!wall().hides(&eyes(DVec3::new(0.0, 1.5, 0.0), 0.0), &beside, 0.0), "it is before the wall");
    let flush = Span { min: DVec3::new(5.0, 1.0, -1.0), max: DVec3::new(6.0, 2.0, 1.0) };
    let front = eyes(DVec3::new(0.0, 1.5, 0.0), 0.1);
    assert!(wall().hides(&front, &flush, 0.0) && !wall().hides(&front, &flush, 1e-6), "it is at the wall");
    let through = eyes(DVec3::new(4.8, 1.5, 0.0), 0.5);
    assert!(!wall().hides(&through, &cuboid(DVec3::new(7.0, 1.5, 0.0), 0.1), 0.0), "eyes on both sides");
}

/// A coordinate, half of the time a multiple of a half.
fn coordinate(low: f32, high: f32) -> impl Strategy<Value = f64> {
    coordinates(low..high, 0.5).prop_map(f64::from)
}

/// The same along all axes.
fn triple(low: f32, high: f32) -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(coordinate(low, high))
}

fn place_in(random: &mut Generator, span: &Span) -> DVec3 {
    places::place_in(span.min, span.max, || random.random_range(0.0..1.0))
}

proptest! {
    #![proptest_config(casca_truth::cases(500))]
    #[test]
    fn no_segment_gets_past_a_wall_that_hides(
        (axis, side, seed) in (0usize..3, any::<bool>(), any::<u64>()),
        (e, r) in (triple(-3.0, 3.0), coordinate(0.0, 1.0)),
        (t, half) in (triple(-3.0, 3.0), triple(0.0, 1.5)),
    ) {
        let wall = Wall { axis, at: 0.0, from: Side::Both, min: [-3.0, -2.0], max: [2.5, 3.5] };
        let (mut e, mut t) = (DVec3::from(e), DVec3::from(t));
        let sign = if side { 1.0 } else { -1.0 };
        (e[axis], t[axis]) = (sign * e[axis].abs(), -sign * t[axis].abs());
        let eyes = eyes(e, r);
        let target = Span { min: t - DVec3::from(half), max: t + DVec3::from(half) };
        if wall.hides(&eyes, &target, 0.0) {
            let mut random = generator(seed, 0);
            for _ in 0..200 {
                let eye = place_in(&mut random, eyes.span());
                let eye = if r > 0.0 { e + (eye - e).clamp_length_max(r * 0.999) } else { eye };
                let point = place_in(&mut random, &target);
                prop_assert!(wall.meets(eye, point), "{eye} {point}");
            }
        }
    }

    #[test]
    fn no_segment_gets_past_walls_that_hide_in_parts(
        walls in prop::collection::vec(
            (0usize..3, coordinate(-1.0, 1.0), prop::array::uniform4(coordinate(-2.0, 2.0))),
            1..6,
        ),
        (axis, apart, seed) in (0usize..3, coordinate(0.0, 0.5), any::<u64>()),
        (e, t) in (triple(-1.5, 1.5), triple(-1.5, 1.5)),
        half in prop::array::uniform6(coordinate(0.0, 0.5)),
    ) {
        // Most are walls between the eyes and the target, and large.
        let wall = |&(a, at, [p, q, r, s]): &(usize, f64, [f64; 4])| {
            let axis = if at > -0.5 { axis } else { a };
            Wall { axis, at, from: Side::Both, min: [p.min(q) - 1.0, r.min(s) - 1.0], max: [p.max(q) + 1.0, r.max(s) + 1.0] }
        };
        let all: Vec<Wall> = walls.iter().map(wall).collect();
        let (mut e, mut t) = (DVec3::from(e), DVec3::from(t));
        (e[axis], t[axis]) = (-1.0 - e[axis].abs(), 1.0 + t[axis].abs());
        let of = |c: DVec3, h: &[f64]| Span { min: c - DVec3::from_slice(h), max: c + DVec3::from_slice(h) };
        let (eyes, target) = (of(e, &half[..3]), of(t, &half[3..]));
        let found = Walls::new(all.clone());
        let hidden = found.hide_in_parts(&eyes, &target, apart, 200, &mut 0);
        let any_alone = all.iter().any(|w| w.hides(&Eyes::cuboid(eyes), &target, apart));
        prop_assert!(hidden || !any_alone, "what one wall hides, walls hide");
        if hidden {
            let mut random = generator(seed, 0);
            for _ in 0..200 {
                let (eye, point) = (place_in(&mut random, &eyes), place_in(&mut random, &target));
                prop_assert!(all.iter().any(|w| w.meets(eye, point)), "{eye} {point}");
            }
        }
    }

    #[test]
    fn what_no_wall_parts_is_reached(
        walls in prop::collection::vec((0usize..3, coordinate(-1.0, 1.0)), 1..6),
        (from, half) in (triple(-1.5, 1.5), triple(0.0, 1.0)),
        (reach, seed) in (coordinate(0.0, 1.5), any::<u64>()),
    ) {
        let wall = |&(axis, at): &(usize, f64)| Wall { axis, at, from: Side::Both, min: [-3.0; 2], max: [2.0, 3.0] };
        let all: Vec<Wall> = walls.iter().map(wall).collect();
        let (from, half) = (DVec3::from(from), DVec3::from(half));
        let from = Span { min: from - half, max: from + half };
        let span = Span { min: from.min - reach, max: from.max + reach };
        let reached = Walls::new(all.clone()).reached(&from, span);
        prop_assert!(reached.min.cmpge(span.min).all() && reached.max.cmple(span.max).all());
        let mut random = generator(seed, 0);
        for _ in 0..200 {
            let (start, end) = (place_in(&mut random, &from), place_in(&mut random, &span));
            let holds = reached.min.cmple(end).all() && reached.max.cmpge(end).all();
            let stopped = all.iter().any(|w| w.meets(start, end));
            prop_assert!(holds || stopped || reach == 0.0, "{start} {end} {reached:?}");
        }
    }
}

#[test]
fn what_lies_in_the_plane_of_a_wall_may_be_on_either_side() {
    let at = |x: f64, y: f64| Span { min: DVec3::new(x, y, 0.0), max: DVec3::new(x, y, 0.0) };
    let hides = |eye: Span, target: Span| wall().hides(&Eyes::cuboid(eye), &target, 0.0);
    assert!(hides(at(4.0, 1.5), at(6.0, 1.5)) && !hides(at(5.0, 1.5), at(6.0, 1.5)));
    assert!(!hides(at(5.0, 1.5), at(4.0, 1.5)) && !hides(at(4.0, 1.5), at(5.0, 1.5)));
    // At the height of its lower edge, rays only touch it.
    assert!(!hides(at(4.0, 0.0), at(6.0, 0.0)) && hides(at(4.0, 1.0), at(6.0, 0.0)));
    let walls = Walls::new(vec![wall()]);
    let around = |x: f64| cuboid(DVec3::new(x, 1.5, 0.0), 1.0);
    assert_eq!(walls.reached(&at(5.0, 1.5), around(5.0)), around(5.0));
    assert_eq!(walls.reached(&at(4.9, 1.5), around(4.9)).max.x, 5.0);
    // Who was pressed against it has not passed it, and may leave.
    let part = |from: f64, to: f64| walls.part(DVec3::new(from, 1.5, 0.0), DVec3::new(to, 1.5, 0.0));
    assert!(part(4.0, 6.0) && !part(4.0, 5.0) && !part(5.0, 6.0));
}

#[test]
fn two_walls_hide_what_neither_does_alone() {
    // Two panels with a slit between them, and a third behind the slit.
    let panel = |at: f64, from: f64, to: f64| Wall {
        axis: 0,
        at,
        from: Side::Both,
        min: [-9.0, from],
        max: [9.0, to],
    };
    let hides = |walls: Vec<Wall>, parts: u32| {
        let eyes = Span { min: DVec3::new(-1.0, 0.0, -1.0), max: DVec3::new(0.0, 1.0, 1.0) };
        let target = Span { min: DVec3::new(9.0, 0.0, -2.0), max: DVec3::new(10.0, 1.0, 2.0) };
        Walls::new(walls).hide_in_parts(&eyes, &target, 0.0, parts, &mut 0)
    };
    let (left, right, behind) = (panel(4.0, -9.0, -0.2), panel(4.0, 0.2, 9.0), panel(5.0, -0.6, 0.6));
    assert!(hides(vec![left, right, behind], 2000));
    assert!(!hides(vec![left, right, behind], 5), "that needs more parts");
    assert!(!hides(vec![left, right], 2000));
    assert!(!hides(vec![left, behind], 2000));
    assert!(!hides(vec![left, right, panel(5.0, -0.1, 0.1)], 2000), "rays pass beside a narrow one");
}

#[test]
fn walls_stop_what_they_cover() {
    let walls = Walls::new(vec![
        wall(),
        Wall { axis: 1, at: 0.0, from: Side::Both, min: [-9.0, -9.0], max: [9.0, 9.0] },
    ]);
    let from = cuboid(DVec3::new(4.6, 0.4, 0.0), 0.3);
    // The floor first: the wall does not go below it.
    let reached = walls.reached(&from, cuboid(DVec3::new(4.6, 0.4, 0.0), 1.0));
    assert_eq!((reached.max.x, reached.min.y), (5.0, 0.0));
    assert!((reached.min.x - 3.6).abs() < 1e-9 && reached.max.z == 1.0);
    // The wall ends at z = 2: one may go around it.
    let corner =
        walls.reached(&cuboid(DVec3::new(4.6, 0.4, 1.5), 0.3), cuboid(DVec3::new(4.6, 0.4, 1.5), 1.0));
    assert_eq!(corner.max.x, 5.6);
}

#[test]
fn boxes_and_quads_are_walls_and_other_triangles_are_not() {
    let mut level = Scene::new(1.0).unwrap();
    for z in [0.0, 3.0] {
        let solid = Aabb::new(Vec3::new(4.0, 0.0, z), Vec3::new(4.5, 3.0, z + 3.0));
        level.insert(ObjectDesc::fixed(solid).occluder(solid)).unwrap();
    }
    let found = find(&level, 0.6);
    let across = found.iter().filter(|w| w.axis == 0).collect::<Vec<_>>();
    assert_eq!(across.len(), 2, "one a side: {across:?}");
    assert!(across.iter().all(|w| w.min == [0.0, 0.0] && w.max == [3.0, 6.0]));

    let corners =
        [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)].map(|(y, z)| Vec3::new(1.0, y, z)).to_vec();
    let count = |triangles: Vec<[u32; 3]>, turn: f32| {
        let mut level = Scene::new(1.0).unwrap();
        let turn = Affine3A::from_rotation_y(turn);
        let corners = corners.iter().map(|&p| turn.transform_point3(p)).collect();
        let mesh = std::sync::Arc::new(TriMesh::new(corners, triangles).unwrap());
        level.insert(ObjectDesc::fixed(mesh.clone()).occluder(mesh)).unwrap();
        find(&level, 0.6).len()
    };
    assert_eq!(count(vec![[0, 1, 2], [0, 2, 3]], 0.0), 1);
    assert_eq!(count(vec![[0, 1, 2], [0, 2, 1]], 0.0), 0, "one half, from both sides");
    assert_eq!(count(vec![[0, 1, 2], [0, 1, 3]], 0.0), 0, "two halves that overlap");
    assert_eq!(count(vec![[0, 1, 2], [0, 2, 3]], 0.3), 0, "across no axis");
}

#[test]
fn walls_of_meshes_that_hide_from_their_front_hide_and_stop_from_there_only() {
    // Its front looks to greater x.
    let corners =
        [(0.0, 0.0), (6.0, 0.0), (6.0, 6.0), (0.0, 6.0)].map(|(y, z)| Vec3::new(3.0, y, z)).to_vec();
    let how = casca::MeshOptions::default().facing(casca::Facing::Front);
    let go_on = &mut |_| std::ops::ControlFlow::Continue(());
    let mesh = TriMesh::prepare(corners, vec![[0, 1, 2], [0, 2, 3]], &how, go_on).unwrap();
    let mut level = Scene::new(1.0).unwrap();
    let mesh = std::sync::Arc::new(mesh);
    level.insert(ObjectDesc::fixed(mesh.clone()).occluder(mesh)).unwrap();
    let walls = Walls::of(&level, 0.6);
    let at = |x: f64| cuboid(DVec3::new(x, 3.0, 3.0), 0.2);
    let hides = |eyes: f64, target: f64| walls.hide(&Eyes::cuboid(at(eyes)), &at(target), 0.0, &mut 0);
    assert!(hides(4.0, 2.0) && !hides(2.0, 4.0));
    let reached = |from: f64| walls.reached(&at(from), cuboid(DVec3::new(from, 3.0, 3.0), 2.0));
    assert_eq!((reached(4.0).min.x, reached(2.0).max.x), (3.0, 4.0));
}
