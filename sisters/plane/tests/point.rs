//! Sets and visible regions against exact visibility in rational arithmetic.

#[path = "tiles/cases.rs"]
mod cases;
mod oracle;

use casca_plane::{
    ConvexPolygon, Disc, GridSpec, ObjectDesc, ObjectId, Polyline, Query, Rect, Scene, Segment, Shape, View,
};
use cases::cases;
use glam::{UVec2, Vec2};
use num_traits::Zero;
use oracle::{Form, Look, Number, Point, Region, number};
use proptest::prelude::*;

fn of_all(points: &[Vec2]) -> Vec<Point> {
    points.iter().map(|&p| Point::of(p)).collect()
}

/// A shape as the oracle looks for it.
fn target(shape: &Shape) -> Form {
    match shape {
        Shape::Disc(disc) => Form::Disc(Point::of(disc.center), number(disc.radius.into())),
        _ => occluder(shape),
    }
}

/// A shape as it blocks.
fn occluder(shape: &Shape) -> Form {
    match shape {
        // As documented: by the polygon inside.
        Shape::Disc(disc) => Form::Solid(of_all(&disc.polygon())),
        Shape::Rect(rect) if rect.min.cmplt(rect.max).all() => Form::Solid(of_all(&rect.corners())),
        Shape::Rect(rect) => Form::Chain(of_all(&[rect.min, rect.max])),
        Shape::Polygon(polygon) => Form::Solid(of_all(polygon.corners())),
        Shape::Segment(s) => Form::Chain(of_all(&[s.a, s.b])),
        Shape::Polyline(line) => Form::Chain(of_all(line.points())),
        _ => unreachable!("all shapes are listed"),
    }
}

/// A shape with corners from a strategy of points.
fn shape(point: impl Strategy<Value = Vec2> + Clone + 'static, discs: bool) -> BoxedStrategy<Shape> {
    let pair = (point.clone(), point.clone());
    let segment = pair.clone().prop_map(|(a, b)| Segment::new(a, b).into());
    let rect = pair.clone().prop_map(|(a, b)| Rect::new(a.min(b), a.max(b)).into());
    let some = proptest::collection::vec(point.clone(), 3..6);
    let polygon = some.clone().prop_filter_map("flat", |p| ConvexPolygon::new(&p).ok().map(Shape::from));
    let chain = some.prop_map(|p| Polyline::new(&p).expect("3 points at least").into());
    let disc = pair.prop_map(|(a, b)| Disc::new(a, (b - a).length() / 2.0).into());
    if discs {
        prop_oneof![3 => segment, 2 => rect, 1 => polygon, 1 => chain, 2 => disc].boxed()
    } else {
        prop_oneof![4 => segment, 2 => rect, 1 => polygon, 1 => chain].boxed()
    }
}

/// A scene with the oracle's view of it.
struct Twin {
    scene: Scene,
    ids: Vec<ObjectId>,
    shapes: Vec<Shape>,
    blocking: Vec<Form>,
}

impl Twin {
    /// Objects, each with whether it hides others.
    fn new(spec: &GridSpec, objects: &[(Shape, bool)]) -> Self {
        let mut scene = Scene::new(spec).unwrap();
        let ids = objects.iter().map(|(shape, hides)| {
            let desc = ObjectDesc::new(shape.clone());
            scene.insert(if *hides { desc.occluder(shape.clone()) } else { desc }).unwrap()
        });
        let ids = ids.collect();
        let blocking = objects.iter().filter(|(_, hides)| *hides).map(|(shape, _)| occluder(shape)).collect();
        Self { scene, ids, shapes: objects.iter().map(|(shape, _)| shape.clone()).collect(), blocking }
    }

    /// Compares all answers for an eye that looks all round.
    fn check(&self, eye: Vec2, points: &[Vec2]) -> Result<(), TestCaseError> {
        let region = Region::new(&Point::of(eye), &self.blocking, &Look::default());
        let mut query = Query::new();
        query.run(&self.scene, &View::all_round(eye).unwrap());
        for (id, shape) in self.ids.iter().zip(&self.shapes) {
            let form = target(shape);
            let seen = query.pvs().contains(*id);
            let least = region.meets(&form, &Number::zero());
            prop_assert!(seen || !least, "{shape:?} is lost from {eye}");
            let most = least || matches!(form, Form::Disc(..)) && region.meets(&form, &number(1e-6));
            prop_assert!(!seen || most, "{shape:?} is not visible from {eye}");
            prop_assert_eq!(query.sees(shape.clone()).unwrap(), seen);
        }
        for &p in points {
            let seen = region.meets(&Form::Chain(vec![Point::of(p), Point::of(p)]), &Number::zero());
            prop_assert_eq!(query.sees_point(p), seen, "the point {} from {}", p, eye);
        }
        Ok(())
    }
}

fn spec(min: f32, cell: f32, cells: u32) -> GridSpec {
    GridSpec { min: Vec2::splat(min), cell, dims: UVec2::splat(cells) }
}

/// An object in the middle of each cell, so small that it touches no other cell.
#[test]
fn every_cell_is_visited() {
    let cells = || (0..17).flat_map(|x| (0..17).map(move |y| Vec2::new(x as f32, y as f32)));
    let objects: Vec<_> = cells().map(|p| (Shape::from(Segment::new(p + 0.5, p + 0.5)), false)).collect();
    let twin = Twin::new(&spec(0.0, 1.0, 17), &objects);
    for eye in [(8.5, 8.5), (3.0, 5.0), (0.1, 16.9), (-7.3, 4.2), (30.0, -11.0)] {
        let view = View::all_round(eye.into()).unwrap();
        assert_eq!(Query::new().run(&twin.scene, &view).len(), objects.len(), "{eye:?}");
    }
}

/// The object touches the wall from behind, and is in no cell that the eye sees.
#[test]
fn objects_that_touch_a_cell_in_sight_are_found() {
    let at = Vec2::new;
    let wall = Segment::new(at(3.0, 3.0), at(6.0, 3.0)).into();
    let rect = |min, max| Shape::from(Rect::new(min, max));
    let (touching, behind) = (rect(at(4.25, 3.0), at(4.5, 3.75)), rect(at(4.25, 3.25), at(4.5, 3.75)));
    let twin = Twin::new(&spec(0.0, 1.0, 8), &[(wall, true), (touching, false), (behind, false)]);
    twin.check(at(4.5, 1.5), &[at(4.5, 3.0), at(4.5, 3.0f32.next_up())]).unwrap();
    let view = View::all_round(at(4.5, 1.5)).unwrap();
    assert_eq!(Query::new().run(&twin.scene, &view).visible(), &twin.ids[..2]);
}

/// Points with small integer coordinates: many of them are the same, or on one line.
fn lattice() -> impl Strategy<Value = Vec2> + Clone {
    (0..8i32, 0..8i32).prop_map(|(x, y)| Vec2::new(x as f32, y as f32))
}

/// Grids that hold all, or some, of the points from 0 to 8.
fn grids() -> impl Strategy<Value = GridSpec> {
    prop_oneof![
        Just(spec(-1.0, 1.0, 10)),
        Just(spec(-0.5, 0.5, 18)),
        Just(spec(-10.0, 3.0, 10)),
        Just(spec(2.0, 0.75, 5)),
        Just(spec(20.0, 1.0, 8)),
    ]
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn small_integers(
        grid in grids(),
        objects in proptest::collection::vec((shape(lattice(), false), any::<bool>()), 1..8),
        eye in lattice(),
        half in any::<bool>(),
        points in proptest::collection::vec(lattice(), 6),
    ) {
        let eye = if half { eye + Vec2::new(0.5, 0.0) } else { eye };
        Twin::new(&grid, &objects).check(eye, &points)?;
    }
}

/// Coordinates of all sizes, with few digits or many.
fn wild() -> impl Strategy<Value = Vec2> + Clone {
    let coordinate = prop_oneof![
        4 => -10.0f32..10.0,
        2 => (-10..10i32).prop_map(|i| i as f32),
        1 => (-40..40i32).prop_map(|i| 2f32.powi(3 * i) * 1.3),
        1 => proptest::num::f32::NORMAL | proptest::num::f32::SUBNORMAL | proptest::num::f32::ZERO,
    ];
    (coordinate.clone(), coordinate).prop_map(|(x, y)| Vec2::new(x, y))
}

/// Half of the coordinates are whole: walls that touch, eyes on walls and on sides of cells.
fn plain() -> impl Strategy<Value = Vec2> + Clone {
    let coordinate = prop_oneof![-9.0f32..9.0, (-9..=9i32).prop_map(|i| i as f32)];
    (coordinate.clone(), coordinate).prop_map(Vec2::from)
}

/// Points on few rays from an eye, or a digit beside them: keys of directions do not tell them apart.
fn grazing(eye: Vec2) -> impl Strategy<Value = Vec2> + Clone {
    (-2..=2i32, -2..=2i32, 1..7i32, 0..5u8).prop_map(move |(x, y, times, beside)| {
        let p = eye + Vec2::new(x as f32, y as f32) * 0.37 * times as f32;
        match beside {
            0 => Vec2::new(p.x.next_up(), p.y),
            1 => Vec2::new(p.x, p.y.next_down()),
            _ => p,
        }
    })
}

proptest! {
    #![proptest_config(cases(30))]

    #[test]
    fn many_walls(
        walls in proptest::collection::vec((lattice(), lattice()), 4..20),
        others in proptest::collection::vec(shape(lattice(), false), 1..4),
        eye in lattice(),
    ) {
        let walls = walls.into_iter().map(|(a, b)| (Segment::new(a, b).into(), true));
        let objects: Vec<_> = walls.chain(others.into_iter().map(|shape| (shape, false))).collect();
        Twin::new(&spec(-1.0, 1.0, 10), &objects).check(eye + 0.25, &[])?;
        Twin::new(&spec(-1.0, 1.0, 10), &objects).check(eye, &[])?;
    }
}

proptest! {
    // Exact numbers of such sizes are long.
    #![proptest_config(cases(80))]

    #[test]
    fn coordinates_of_all_sizes(
        objects in proptest::collection::vec((shape(wild(), false), any::<bool>()), 1..6),
        eye in wild(),
        points in proptest::collection::vec(wild(), 4),
    ) {
        Twin::new(&spec(-8.0, 1.0, 16), &objects).check(eye, &points)?;
    }
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn walls_that_graze_rays(
        (eye, objects, points) in plain().prop_flat_map(|eye| (
            Just(eye),
            proptest::collection::vec((shape(grazing(eye), false), any::<bool>()), 1..8),
            proptest::collection::vec(grazing(eye), 6),
        )),
    ) {
        Twin::new(&spec(-10.0, 1.0, 20), &objects).check(eye, &points)?;
    }

    #[test]
    fn discs(
        objects in proptest::collection::vec((shape(plain(), true), any::<bool>()), 1..6),
        eye in plain(),
    ) {
        Twin::new(&spec(-10.0, 1.0, 20), &objects).check(eye, &[])?;
    }

    #[test]
    fn sectors_and_ranges(
        objects in proptest::collection::vec((shape(lattice(), false), any::<bool>()), 1..7),
        eye in lattice(),
        angle in 0.0f32..6.3,
        half in 0.0f32..3.2,
        range in proptest::option::of(0.5f32..9.0),
    ) {
        let twin = Twin::new(&spec(-1.0, 1.0, 10), &objects);
        let direction = Vec2::from_angle(angle);
        let half = half.min(std::f32::consts::PI);
        let mut view = View::sector(eye, direction, half).unwrap();
        if let Some(range) = range {
            view = view.with_range(range).unwrap();
        }
        let mut query = Query::new();
        query.run(&twin.scene, &view);
        let region = |more: f64| {
            let (angle, half) = (f64::from(direction.y).atan2(direction.x.into()), f64::from(half) + more);
            let side = |angle: f64| Point::new(angle.cos(), angle.sin());
            let between = (half < std::f64::consts::PI).then(|| [side(angle - half), side(angle + half)]);
            let look = Look { between, range: range.map(|range| number(range.into())) };
            (half > 0.0).then(|| Region::new(&Point::of(eye), &twin.blocking, &look))
        };
        let (least, most) = (region(-1e-9), region(1e-9));
        for (id, shape) in twin.ids.iter().zip(&twin.shapes) {
            let seen = query.pvs().contains(*id);
            let meets = |region: &Option<Region>, more: f64| {
                region.as_ref().is_some_and(|region| region.meets(&target(shape), &number(more)))
            };
            prop_assert!(seen || !meets(&least, 0.0), "{shape:?} is lost");
            prop_assert!(!seen || meets(&most, 1e-9), "{shape:?} is not visible");
        }
    }

    #[test]
    fn polygons_contain_the_points_that_are_seen(
        objects in proptest::collection::vec((shape(lattice(), false), any::<bool>()), 1..7),
        eye in lattice(),
        sector in proptest::option::of((0.0f32..6.3, 0.1f32..3.1)),
        range in proptest::option::of(0.5f32..9.0),
        points in proptest::collection::vec((-1.0f32..9.0, -1.0f32..9.0), 40),
    ) {
        let twin = Twin::new(&spec(-1.0, 1.0, 10), &objects);
        let mut view = match sector {
            Some((angle, half)) => View::sector(eye, Vec2::from_angle(angle), half).unwrap(),
            None => View::all_round(eye).unwrap(),
        };
        if let Some(range) = range {
            view = view.with_range(range).unwrap();
        }
        let mut query = Query::new();
        query.run(&twin.scene, &view);
        let polygon = query.polygon();
        prop_assert_eq!(polygon.is_empty(), !query.sees_point(eye));
        for (x, y) in points {
            let p = Vec2::new(x, y);
            let (winding, distance) = winding(&polygon, p);
            // Chords leave the circle by 0.13% of a range of 9 at most.
            let room = if range.is_some_and(|range| p.distance(eye) > range * 0.999) { 0.02 } else { 1e-5 };
            if distance > room {
                prop_assert_eq!(winding != 0, query.sees_point(p), "{} in {:?}", p, polygon);
                prop_assert!(winding == 0 || winding == 1, "{winding}");
            }
        }
    }
}

/// How often a polygon runs around a point, and the distance of the point from it.
fn winding(polygon: &[Vec2], p: Vec2) -> (i32, f32) {
    let next = polygon.iter().cycle().skip(1);
    let (mut angle, mut distance) = (0.0, f32::INFINITY);
    for (a, b) in polygon.iter().zip(next) {
        let (a, b) = (*a - p, *b - p);
        angle += a.angle_to(b);
        let u = b - a;
        let at = (-a.dot(u) / u.length_squared().max(1e-30)).clamp(0.0, 1.0);
        distance = distance.min((a + u * at).length());
    }
    ((angle / std::f32::consts::TAU).round() as i32, distance)
}

proptest! {
    #![proptest_config(cases(24))]

    /// The same objects on a grid that none of them is in are found without a walk.
    #[test]
    fn the_walk_loses_nothing(
        walls in proptest::collection::vec((plain(), plain()), 20..300),
        length in 0.05f32..1.0,
        others in proptest::collection::vec(shape(plain(), true), 10..60),
        cell in prop_oneof![Just(1.0f32), Just(0.31), Just(3.0)],
        eyes in proptest::collection::vec(plain(), 6),
        half in 0.1f32..4.0,
        range in proptest::option::of(1.0f32..20.0),
    ) {
        let walls = walls.into_iter().map(|(a, b)| (Segment::new(a, a.lerp(b, length)).into(), true));
        let small = |shape: &Shape| match shape {
            Shape::Disc(disc) => Disc::new(disc.center, disc.radius * 0.1).into(),
            shape => shape.clone(),
        };
        let others = others.iter().enumerate().map(|(i, shape)| (small(shape), i % 20 == 0));
        let objects: Vec<_> = walls.chain(others).collect();
        let walked = Twin::new(&spec(-9.5, cell, (19.0 / cell) as u32 + 1), &objects);
        let elsewhere = Twin::new(&spec(1e6, 1.0, 1), &objects);
        for (i, eye) in eyes.into_iter().enumerate() {
            let eye = eye * if i == 0 { 3.0 } else { 1.0 };
            let mut view = match half < std::f32::consts::PI && i % 2 == 0 {
                true => View::sector(eye, Vec2::from_angle(i as f32), half).unwrap(),
                false => View::all_round(eye).unwrap(),
            };
            if let Some(range) = range {
                view = view.with_range(range).unwrap();
            }
            let mut queries = [Query::new(), Query::new()];
            queries[0].run(&walked.scene, &view);
            queries[1].run(&elsewhere.scene, &view);
            for ((id, other), shape) in walked.ids.iter().zip(&elsewhere.ids).zip(&walked.shapes) {
                prop_assert_eq!(queries[0].pvs().contains(*id), queries[1].pvs().contains(*other), "{:?}", shape);
            }
        }
    }
}
