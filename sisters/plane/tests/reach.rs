//! Views with a reach against exact queries from eyes within it.

mod common;
mod oracle;

use casca_plane::{
    BitGrid, Disc, GridSpec, Method, ObjectDesc, Polyline, Query, Rect, Scene, Segment, Shape, TileLayer,
    View,
};
use common::cases;
use common::forms::{occluder, shape, target};
use glam::{UVec2, Vec2};
use num_traits::Zero;
use oracle::{Form, Look, Number, Point, Region};
use proptest::prelude::*;

fn spec(min: f32, cell: f32, cells: u32) -> GridSpec {
    GridSpec { min: Vec2::splat(min), cell, dims: UVec2::splat(cells) }
}

/// A scene of shapes, of which some hide.
fn scene(spec: &GridSpec, objects: &[(Shape, bool)]) -> Scene {
    let mut scene = Scene::new(spec).unwrap();
    for (shape, hides) in objects {
        let desc = ObjectDesc::fixed(shape.clone());
        scene.insert(if *hides { desc.occluder(shape.clone()) } else { desc }).unwrap();
    }
    scene
}

/// Eyes within a reach: the middle, the rim and between, none beyond it by rounding.
fn eyes(middle: Vec2, reach: f32, count: usize) -> Vec<Vec2> {
    let turn = |i: usize| Vec2::from_angle(i as f32 * 2.399_963);
    let shares = |i: usize| if i.is_multiple_of(2) { 1.0 } else { (i as f32 / count as f32).sqrt() };
    let all = (0..count).map(|i| middle + turn(i) * reach * shares(i));
    all.filter(|eye| eye.as_dvec2().distance(middle.as_dvec2()) < reach.into()).chain([middle]).collect()
}

/// Points of small whole numbers and halves: many walls meet at ends, lie on lines, and touch.
fn lattice() -> impl Strategy<Value = Vec2> + Clone {
    (0..24i32, 0..24i32).prop_map(|(x, y)| Vec2::new(x as f32, y as f32) / 2.0)
}

/// Points anywhere, half of their coordinates those of the lattice.
fn anywhere() -> impl Strategy<Value = Vec2> + Clone {
    let coordinate = prop_oneof![0.0..12.0f32, (0..24i32).prop_map(|i| i as f32 / 2.0)];
    (coordinate.clone(), coordinate).prop_map(Vec2::from)
}

fn objects(lattice_only: bool) -> BoxedStrategy<Vec<(Shape, bool)>> {
    let any = |point: BoxedStrategy<Vec2>| {
        proptest::collection::vec((shape(point, true), proptest::bool::weighted(0.7)), 1..14)
    };
    // Boxed strategies are clones of each other.
    if lattice_only { any(lattice().boxed()).boxed() } else { any(anywhere().boxed()).boxed() }
}

fn views(eye: Vec2, kind: u8, range: f32, direction: Vec2) -> View {
    let view = match kind % 4 {
        0 => View::all_round(eye),
        1 => View::sector(eye, direction, 0.6),
        2 => View::sector(eye, direction, 2.2),
        _ => View::sector(eye, direction, 0.02),
    };
    let view = view.unwrap();
    if kind >= 4 { view.with_range(range).unwrap() } else { view }
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn no_object_that_an_eye_within_reach_sees_is_missing(
        on_lattice: bool,
        (walls, others) in (objects(true), objects(false)),
        middle in anywhere(),
        reach in prop_oneof![Just(1e-3f32), 0.01..0.3f32, 0.3..3.0f32],
        (kind, range, turn) in (0..8u8, 1.0..15.0f32, 0.0..6.3f32),
        cells in prop_oneof![Just(13u32), Just(4), Just(40)],
    ) {
        let grid = spec(-0.5, 13.0 / cells as f32, cells);
        let objects = if on_lattice { walls } else { others };
        let scene = scene(&grid, &objects);
        let direction = Vec2::from_angle(turn);
        let wide = views(middle, kind, range, direction).with_reach(reach).unwrap();
        for method in [Method::Point, Method::Sector, Method::Cell] {
            let (mut query, mut exact) = (Query::with_method(method).unwrap(), Query::with_method(method).unwrap());
            let kept = query.run(&scene, &wide).clone();
            for eye in eyes(middle, reach, 24) {
                let view = views(eye, kind, range, direction);
                let found = exact.run(&scene, &view);
                if !kept.is_valid_for(&scene, &view) {
                    // Only eyes of a cell in a solid do not count.
                    prop_assert!(method == Method::Cell && found.stats().eye_in_occluder);
                    continue;
                }
                for id in found {
                    prop_assert!(kept.contains(id), "{method:?} from {eye} misses {:?}", scene.bounds(id));
                    let bounds = scene.bounds(id).unwrap().clone();
                    prop_assert!(query.sees(bounds).unwrap());
                }
                if method == Method::Point && exact.sees_point(Vec2::splat(6.0)) {
                    prop_assert!(query.sees_point(Vec2::splat(6.0)));
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(12))]

    #[test]
    fn no_object_is_missing_by_rational_numbers(
        objects in objects(true),
        middle in anywhere(),
        reach in 0.05..1.5f32,
    ) {
        let scene = scene(&spec(-0.5, 1.0, 13), &objects);
        let mut query = Query::new();
        let kept = query.run(&scene, &View::all_round(middle).unwrap().with_reach(reach).unwrap());
        let blocking: Vec<Form> =
            objects.iter().filter(|(_, hides)| *hides).map(|(shape, _)| occluder(shape)).collect();
        for eye in eyes(middle, reach, 6) {
            let region = Region::new(&Point::of(eye), &blocking, &Look::default());
            for (id, (shape, _)) in scene.ids().zip(&objects) {
                let seen = region.meets(&target(shape), &Number::zero());
                prop_assert!(!seen || kept.contains(id), "{shape:?} from {eye}");
            }
        }
    }
}

/// A point behind a wall along y = 0 that is made of parts, for an eye at (0, -5) and a reach: is
/// it seen?
fn sees_behind(walls: &[Shape], reach: f32, behind: Vec2) -> bool {
    let objects: Vec<_> = walls.iter().map(|wall| (wall.clone(), true)).collect();
    let scene = scene(&spec(-20.0, 1.0, 40), &objects);
    let view = View::all_round(Vec2::new(0.3, -5.0)).unwrap().with_reach(reach).unwrap();
    let mut query = Query::new();
    query.run(&scene, &view);
    query.sees_point(behind)
}

#[test]
fn parts_that_join_hide_as_one() {
    let at = Vec2::new;
    let wall = |a: f32, b: f32| Shape::from(Segment::new(at(a, 0.0), at(b, 0.0)));
    let rect = |a: f32, b: f32, top: f32| Shape::from(Rect::new(at(a, 0.0), at(b, top)));
    let corners: Vec<Vec2> = (-10..=10).map(|x| at(x as f32, 0.0)).collect();
    let behind: Vec<Vec2> = (-8..=8).map(|x| at(x as f32 / 2.0, 1.5)).collect();
    let walls = [
        vec![wall(-10.0, 10.0)],
        (-10..10).map(|x| wall(x as f32, x as f32 + 1.0)).collect(),
        // Each shorter than the reach.
        (-40..40).map(|x| wall(x as f32 / 4.0, (x + 1) as f32 / 4.0)).collect(),
        vec![Polyline::new(&corners).unwrap().into()],
        (-10..10).map(|x| rect(x as f32, x as f32 + 1.0, 1.0 + (x as f32 % 2.0).abs() / 4.0)).collect(),
        // Ends lie in others.
        vec![wall(-10.0, 1.0), rect(0.0, 2.0, 1.0), wall(1.5, 10.0)],
        vec![wall(-10.0, 0.0), Disc::new(at(0.1, 0.3), 0.5).into(), wall(0.2, 10.0)],
        // The end of one lies on the side of another.
        vec![wall(-10.0, 0.0), Segment::new(at(0.0, -1.0), at(0.0, 1.0)).into(), wall(0.0, 10.0)],
    ];
    for (i, walls) in walls.iter().enumerate() {
        for &p in &behind {
            assert!(!sees_behind(walls, 0.5, p), "{i}: {p}");
        }
        // Without a part, eyes look through, the more the farther they reach.
        let gap: Vec<_> = walls.iter().filter(|wall| !holds_middle(wall)).cloned().collect();
        assert!(sees_behind(&gap, 0.5, at(0.2, 1.5)), "{i}");
    }
    // Two that only nearly touch.
    let apart = [wall(-10.0, 0.0), wall(0.0f32.next_up(), 10.0)];
    assert!(sees_behind(&apart, 0.5, at(0.0, 1.5)) && !sees_behind(&apart, 0.5, at(3.0, 1.5)));
}

/// Whether a shape has points near the origin.
fn holds_middle(shape: &Shape) -> bool {
    let mut query = Query::new();
    let scene = Scene::new(&spec(-20.0, 1.0, 40)).unwrap();
    query.run(&scene, &View::all_round(Vec2::ZERO).unwrap().with_range(0.5).unwrap());
    query.sees(shape.clone()).unwrap()
}

/// Far behind a wall, the shadow is as much narrower as the reach at either side, and no more.
#[test]
fn the_shadow_is_narrower_by_the_reach() {
    let at = Vec2::new;
    let wall = |a: f32, b: f32| Shape::from(Segment::new(at(a, 0.0), at(b, 0.0)));
    let walls = [
        vec![wall(-2.0, 3.0)],
        // The last parts are shorter than the reach.
        vec![wall(-2.0, 2.75), wall(2.75, 2.875), wall(2.875, 3.0)],
    ];
    for (walls, reach) in walls.iter().flat_map(|walls| [0.1, 0.5, 1.0].map(|reach| (walls, reach))) {
        for far in [10.0, 1000.0] {
            // How far to the right its shadow reaches for an eye.
            let border = |eye: Vec2| eye.x + (3.0 - eye.x) * (far - eye.y) / -eye.y;
            let all = eyes(at(0.3, -5.0), reach, 1000).into_iter().map(border);
            let narrowest = all.fold(f32::INFINITY, f32::min);
            assert!(sees_behind(walls, reach, at(narrowest, far)), "{walls:?} {reach} {far}");
            let slack = reach * 1.75;
            let inside = at(narrowest - slack, far);
            assert!(!sees_behind(walls, reach, inside), "{walls:?} {reach} {far}");
        }
    }
}

/// Two walls make a wedge that opens to the right. An eye looks into it past the end of the first
/// one; the second one does not make that longer.
#[test]
fn a_wall_that_hangs_on_another_does_not_hide_what_is_between() {
    let at = Vec2::new;
    let first = Segment::new(at(-2.0, 0.0), at(3.0, 0.0));
    let second = Segment::new(at(2.8, 0.0), at(9.8, 7.0));
    assert!(sees_behind(&[first.into(), second.into()], 0.5, at(3.15, 0.3)));
    assert!(!sees_behind(&[first.into(), second.into()], 0.5, at(2.0, 2.0)));
}

#[test]
fn results_hold_for_the_views_that_they_should() {
    let at = Vec2::new;
    let mut scene = scene(&spec(-8.0, 1.0, 16), &[]);
    let mut query = Query::new();
    let sector = |eye: Vec2, half: f32| View::sector(eye, Vec2::X, half).unwrap();
    let own = sector(Vec2::ZERO, 1.0).with_range(5.0).unwrap().with_reach(1.0).unwrap();
    let kept = query.run(&scene, &own).clone();
    let near = sector(at(0.5, 0.5), 1.0).with_range(5.0).unwrap();
    assert!(kept.is_valid_for(&scene, &own) && kept.is_valid_for(&scene, &near));
    assert!(kept.is_valid_for(&scene, &sector(at(0.5, 0.5), 0.7).with_range(4.0).unwrap()));
    assert!(kept.is_valid_for(&scene, &near.with_reach(0.25).unwrap()));
    for other in [
        near.with_reach(0.5).unwrap(),
        near.with_layers(1),
        near.with_range(5.5).unwrap(),
        sector(at(0.5, 0.5), 1.0),
        sector(at(0.5, 0.5), 1.1).with_range(5.0).unwrap(),
        sector(at(1.0, 0.5), 1.0).with_range(5.0).unwrap(),
        View::sector(at(0.5, 0.5), Vec2::new(1.0, 0.1), 1.0).unwrap().with_range(5.0).unwrap(),
        View::all_round(Vec2::ZERO).unwrap().with_range(5.0).unwrap(),
    ] {
        assert!(!kept.is_valid_for(&scene, &other), "{other:?}");
    }
    scene.insert(ObjectDesc::fixed(Disc::new(Vec2::ONE, 0.5))).unwrap();
    assert!(!kept.is_valid_for(&scene, &near));
    // Without a reach, a set holds for its own view only.
    let whole = View::all_round(Vec2::ZERO).unwrap();
    let kept = query.run(&scene, &whole).clone();
    assert!(kept.is_valid_for(&scene, &whole) && !kept.is_valid_for(&scene, &near));
}

/// Rooms of tiles with doorways: the sets are hardly larger than what all eyes see together.
#[test]
fn sets_are_tight() {
    let mut walls = BitGrid::new(48, 48);
    for y in 0..48 {
        for x in 0..48 {
            let is_wall = x % 8 == 0 || y % 8 == 0;
            let is_door = (x % 8 == 0 && (y + x / 8 * 3) % 8 == 3) || (y % 8 == 0 && (x + y / 8) % 8 == 5);
            walls.set(x, y, is_wall && !is_door);
        }
    }
    let mut scene = Scene::new(&spec(0.0, 1.0, 48)).unwrap();
    scene.insert_tiles(&TileLayer::new(Vec2::ZERO, 1.0, walls.clone()).unwrap()).unwrap();
    for (x, y) in (0..48).flat_map(|x| (0..48).map(move |y| (x, y))).filter(|&(x, y)| !walls.get(x, y)) {
        let disc = Disc::new(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), 0.2);
        scene.insert(ObjectDesc::fixed(disc)).unwrap();
    }
    for (reach, most) in [(0.05, 1.05), (0.25, 1.25), (0.5, 1.4)] {
        let (mut shown, mut seen, mut one) = (0, 0, 0);
        for middle in [(4.3, 4.2), (13.6, 20.5), (27.1, 26.4), (35.7, 11.5), (21.5, 43.8)].map(Vec2::from) {
            let mut query = Query::new();
            shown += query.run(&scene, &View::all_round(middle).unwrap().with_reach(reach).unwrap()).len();
            let mut all = std::collections::BTreeSet::new();
            for eye in eyes(middle, reach, 200) {
                all.extend(query.run(&scene, &View::all_round(eye).unwrap()).iter());
            }
            seen += all.len();
            one += query.run(&scene, &View::all_round(middle).unwrap()).len();
        }
        println!("reach {reach}: shown {shown}, seen by 200 eyes {seen}, by one {one}");
        assert!((shown as f64) < seen as f64 * most, "{shown} {seen}");
    }
}

/// Numbers of all sizes: no panic, and never less than without a reach.
#[test]
fn absurd_reaches() {
    let far = 3e38;
    let at = Vec2::new;
    let shapes: Vec<Shape> = vec![
        Segment::new(at(-far, 1.0), at(far, 1.0)).into(),
        Segment::new(at(1.0, 1.0), at(1.0, 1.0)).into(),
        Rect::new(at(2.0, 2.0), at(2.0, far)).into(),
        Disc::new(at(0.0, 1e-40), 1e-42).into(),
        Polyline::new(&[at(0.0, 2.0); 4]).unwrap().into(),
        Rect::new(at(-1e-38, -3.0), at(1e-38, -2.0)).into(),
    ];
    let objects: Vec<_> = shapes.into_iter().map(|shape| (shape, true)).collect();
    let scene = scene(&spec(-8.0, 1.0, 16), &objects);
    let mut query = Query::new();
    for eye in [at(0.0, 0.0), at(far, -far), at(1e-45, 0.0), at(7e4, 1.0), at(0.0, 2.0)] {
        let view = View::all_round(eye).unwrap();
        for view in [view, View::sector(eye, Vec2::Y, 0.0).unwrap(), View::sector(eye, Vec2::X, 1.0).unwrap()]
        {
            let least = query.run(&scene, &view).clone();
            for reach in [0.0, 1e-45, 1e-20, 0.5, 1e6, far] {
                let set = query.run(&scene, &view.with_reach(reach).unwrap());
                assert!(least.iter().all(|id| set.contains(id)), "{eye} {reach}");
                query.polygon();
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(200))]

    /// By cells, a view with a reach shows the union of the sets of the cells that it touches.
    #[test]
    fn cells_within_reach_are_seen_together(
        walls in proptest::collection::vec((0..16i32, 0..16i32, 1..6i32, 1..4i32), 4..24),
        others in proptest::collection::vec(anywhere(), 30),
        middle in anywhere(),
        // At most four cells along an axis.
        reach in prop_oneof![0.01..0.4f32, 0.4..1.4f32],
        hidden: bool,
        range in prop_oneof![Just(None), (0.5..6.0f32).prop_map(Some)],
    ) {
        let all_round = |eye: Vec2| {
            let view = View::all_round(eye).unwrap();
            range.map_or(view, |range| view.with_range(range).unwrap())
        };
        let mut scene = Scene::new(&spec(0.0, 1.0, 16)).unwrap();
        for (x, y, w, h) in walls {
            let wall = Rect::new(Vec2::new(x as f32, y as f32), Vec2::new((x + w) as f32, (y + h) as f32));
            scene.insert(ObjectDesc::fixed(wall).occluder(wall)).unwrap();
        }
        let mut query = Query::with_method(Method::Cell).unwrap();
        for at in others {
            scene.insert(ObjectDesc::dynamic(Disc::new(at + 1.5, 0.2)).max_speed(1.0)).unwrap();
        }
        if hidden {
            // Those that one eye does not see are in volumes.
            scene.begin_frame(0.0).unwrap();
            let pvs = query.run(&scene, &View::all_round(Vec2::splat(8.5)).unwrap()).clone();
            scene.end_frame([&pvs]).unwrap();
            scene.begin_frame(0.5).unwrap();
        }
        let eye = middle + 2.0;
        let kept = query.run(&scene, &all_round(eye).with_reach(reach).unwrap()).clone();
        prop_assume!(!kept.stats().eye_in_occluder);
        let cells = query.seen_cells(&scene).unwrap();
        let (mut all, mut in_sight) = (std::collections::BTreeSet::new(), BitGrid::new(16, 16));
        let mut exact = !hidden;
        let mut starts = Vec::new();
        for (x, y) in (0..16).flat_map(|x| (0..16).map(move |y| (x as f32, y as f32))) {
            let (cell, rim) = (Vec2::new(x, y), 1.0 - f32::EPSILON * 16.0);
            let nearest = eye.clamp(cell, cell + rim);
            let away = nearest.as_dvec2().distance(eye.as_dvec2()) - f64::from(reach);
            prop_assume!(away.abs() > 1e-5);
            if away > 0.0 {
                continue;
            }
            starts.push(cell);
            let view = all_round(nearest);
            let found = query.run(&scene, &view).clone();
            if found.stats().eye_in_occluder {
                // In a solid, an eye sees all, and does not count; others of the cell may.
                prop_assert!(!kept.is_valid_for(&scene, &view));
                exact = false;
                continue;
            }
            let seen = query.seen_cells(&scene).unwrap();
            seen.cells().for_each(|(x, y)| in_sight.set(x, y, true));
            all.extend(found.iter());
        }
        prop_assert!(all.iter().all(|&id| kept.contains(id)));
        prop_assert!(in_sight.cells().all(|(x, y)| cells.get(x, y)));
        if let Some(range) = range {
            // Other eyes of a cell see farther to a side, none beyond the range.
            let far = |(x, y): (u32, u32), start: &Vec2| {
                Vec2::new(x as f32, y as f32).distance(*start) - range > 2f32.sqrt() + 1e-4
            };
            prop_assert!(!cells.cells().any(|cell| starts.iter().all(|start| far(cell, start))));
        } else if exact {
            prop_assert_eq!(kept.len(), all.len());
            prop_assert_eq!(cells, in_sight);
        }
    }
}

/// An eye that may cross a border between cells sees what either cell does; far more cells hide
/// nothing.
#[test]
fn walls_hide_from_all_cells_within_reach() {
    let at = Vec2::new;
    let wall = Rect::new(at(2.0, 6.0), at(14.0, 7.0));
    let behind = Shape::from(Disc::new(at(8.0, 8.0), 0.3));
    let scene = scene(&spec(0.0, 1.0, 16), &[(wall.into(), true), (behind, false)]);
    let mut query = Query::with_method(Method::Cell).unwrap();
    let mut shown = |eye: Vec2, reach: f32| {
        query.run(&scene, &View::all_round(eye).unwrap().with_reach(reach).unwrap()).len()
    };
    assert_eq!(shown(at(8.5, 4.5), 0.4), 1);
    // Two cells, and four by four; then more than 16.
    assert_eq!(shown(at(8.0, 4.5), 0.4), 1);
    assert_eq!(shown(at(8.0, 4.0), 1.5), 1);
    assert_eq!(shown(at(8.5, 3.5), 2.5), 2);
    // Some cells look past the end of the wall.
    assert_eq!(shown(at(2.5, 6.8), 0.2), 2, "in the wall");
    assert_eq!(shown(at(1.0, 7.5), 0.7), 2);
}
