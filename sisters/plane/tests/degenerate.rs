//! Walls that touch, cross and overlap, and eyes on walls, corners and borders: the cases that
//! `Query::run` defines.

use casca_plane::{
    ConvexPolygon, Disc, Error, GridSpec, ObjectDesc, Polyline, Query, Rect, Scene, Segment, Shape, View,
};
use glam::{UVec2, Vec2};

fn at(x: f32, y: f32) -> Vec2 {
    Vec2::new(x, y)
}

fn wall(a: (f32, f32), b: (f32, f32)) -> Shape {
    Segment::new(a.into(), b.into()).into()
}

fn rect(min: (f32, f32), max: (f32, f32)) -> Shape {
    Rect::new(min.into(), max.into()).into()
}

/// A query that has run among occluders, on a grid from -10 to 10.
fn look(occluders: &[Shape], eye: (f32, f32)) -> Query {
    let spec = GridSpec { min: Vec2::splat(-10.0), cell: 1.0, dims: UVec2::splat(20) };
    let mut scene = Scene::new(&spec).unwrap();
    for shape in occluders {
        scene.insert(ObjectDesc::new(shape.clone()).occluder(shape.clone())).unwrap();
    }
    let mut query = Query::new();
    query.run(&scene, &View::all_round(eye.into()).unwrap());
    query
}

fn sees(query: &Query, x: f32, y: f32) -> bool {
    query.sees_point(at(x, y))
}

#[test]
fn walls_that_touch_in_a_point_let_nothing_through() {
    // They meet in (0, 2), in a line, at an angle, as a T, and as a cross.
    for pair in [
        [wall((-8.0, 2.0), (0.0, 2.0)), wall((0.0, 2.0), (8.0, 2.0))],
        [wall((-8.0, 0.0), (0.0, 2.0)), wall((0.0, 2.0), (8.0, 0.0))],
        [wall((-8.0, 2.0), (8.0, 2.0)), wall((0.0, 2.0), (0.0, 8.0))],
        [wall((-8.0, 2.0), (8.0, 2.0)), wall((-1.0, 1.0), (1.0, 3.0))],
    ] {
        let query = look(&pair, (0.0, 0.0));
        assert!(sees(&query, 0.0, 2.0) && !sees(&query, 0.0, 2.0f32.next_up()), "{pair:?}");
        assert!(!sees(&query, 0.0, 9.0) && !query.sees(Disc::new(at(0.0, 9.0), 0.5)).unwrap(), "{pair:?}");
    }
    // Corners of solids that touch.
    let solids = [rect((-8.0, 2.0), (0.0, 4.0)), rect((0.0, 4.0), (8.0, 6.0)), rect((0.0, 2.0), (8.0, 2.0))];
    assert!(!sees(&look(&solids[..2], (0.0, 0.0)), -1.0, 9.0));
    assert!(sees(&look(&solids[..2], (0.0, 0.0)), 0.0, 4.0));
    assert!(!sees(&look(&solids, (0.0, 0.0)), 0.0, 4.0));
    assert!(!sees(&look(&solids[..2], (1.0, 0.0)), -1.5, 9.0), "through the corners that touch");
}

#[test]
fn a_gap_of_the_least_width_lets_something_through() {
    let walls = [wall((-8.0, 2.0), (0.0, 2.0)), wall((f32::from_bits(1), 2.0), (8.0, 2.0))];
    let query = look(&walls, (0.0, 0.0));
    assert!(sees(&query, 0.0, 9.0) && !sees(&query, 1e-30, 9.0));
    assert!(query.sees(Disc::new(at(0.0, 9.0), 0.5)).unwrap());
}

#[test]
fn no_ray_between_walls_one_behind_the_other() {
    // Both end in the direction of +y: the ray between them grazes both.
    let walls = [wall((-8.0, 2.0), (0.0, 2.0)), wall((0.0, 4.0), (9.0, 4.0))];
    let query = look(&walls, (0.0, 0.0));
    // The upper wall is seen down to its end, and the ray to it; nothing beyond.
    assert!(sees(&query, 0.0, 4.0) && sees(&query, 0.0, 3.0) && !sees(&query, 0.0, 5.0));
}

#[test]
fn collinear_walls_that_overlap_are_as_one() {
    let walls = [wall((-6.0, 2.0), (1.0, 2.0)), wall((-1.0, 2.0), (6.0, 2.0)), wall((-2.0, 2.0), (2.0, 2.0))];
    let query = look(&walls, (0.0, 0.0));
    assert_eq!(query.pvs().len(), 3, "all share points in sight");
    assert!(!sees(&query, 0.0, 3.0) && sees(&query, 6.0, 2.0) && sees(&query, 7.0, 2.0));
}

#[test]
fn walls_that_cross_show_their_nearer_parts() {
    let query = look(&[wall((-4.0, 1.0), (4.0, 5.0)), wall((-4.0, 5.0), (4.0, 1.0))], (0.0, 0.0));
    // They cross in (0, 3).
    assert!(sees(&query, 0.0, 3.0) && sees(&query, -2.0, 2.0) && sees(&query, 2.0, 2.0));
    assert!(!sees(&query, -2.0, 4.0) && !sees(&query, 2.0, 4.0) && !sees(&query, 0.0, 3.5));
    let polygon = query.polygon();
    assert!(polygon.contains(&at(0.0, 3.0)), "{polygon:?}");
}

#[test]
fn a_wall_through_the_eye_hides_nothing() {
    for eye in [(0.0, 0.0), (-3.0, 0.0), (3.0, 0.0)] {
        let query = look(&[wall((-3.0, 0.0), (3.0, 0.0))], eye);
        assert!([(0.0, 5.0), (0.0, -5.0), (9.0, 0.0), (-9.0, 0.0)].iter().all(|p| sees(&query, p.0, p.1)));
    }
    // Along a wall that does not reach the eye, too.
    assert!(sees(&look(&[wall((1.0, 0.0), (3.0, 0.0))], (0.0, 0.0)), 9.0, 0.0));
    // A corner of a chain.
    let chain = Polyline::new(&[at(-3.0, 0.0), at(0.0, 0.0), at(0.0, 3.0)]).unwrap().into();
    let query = look(&[chain], (0.0, 0.0));
    assert!(sees(&query, -2.0, 2.0) && sees(&query, 2.0, -2.0) && sees(&query, 0.0, 9.0));
}

#[test]
fn from_the_border_of_a_solid_one_sees_away_from_it() {
    let square = rect((0.0, 0.0), (4.0, 4.0));
    let hull = ConvexPolygon::new(&[at(0.0, 0.0), at(4.0, 0.0), at(4.0, 4.0), at(0.0, 4.0)]).unwrap().into();
    for solid in [square, hull] {
        let solid = [solid];
        let side = look(&solid, (2.0, 0.0));
        assert!(
            sees(&side, 2.0, -3.0)
                && sees(&side, 9.0, 0.0)
                && !sees(&side, 2.0, 1.0)
                && !sees(&side, 2.0, 6.0)
        );
        let corner = look(&solid, (4.0, 4.0));
        assert!(sees(&corner, 9.0, 0.0) && sees(&corner, 4.0, 0.0) && !sees(&corner, 3.0, 3.0));
        assert!(!side.pvs().stats().eye_in_occluder && side.pvs().len() == 1);
    }
    // On the seam between two, nothing is seen.
    let seam = look(&[rect((0.0, 0.0), (4.0, 2.0)), rect((0.0, 2.0), (4.0, 4.0))], (2.0, 2.0));
    assert!(!sees(&seam, 2.0, 2.0) && seam.polygon().is_empty() && seam.pvs().is_empty());
    let end = look(&[rect((0.0, 0.0), (4.0, 2.0)), rect((0.0, 2.0), (4.0, 4.0))], (4.0, 2.0));
    assert!(sees(&end, 9.0, 2.0) && sees(&end, 4.0, 9.0) && !sees(&end, 3.0, 2.0));
}

#[test]
fn a_solid_around_the_eye_hides_nothing() {
    let query = look(&[rect((0.0, 0.0), (4.0, 4.0)), wall((6.0, -3.0), (6.0, 7.0))], (2.0, 2.0));
    assert!(query.pvs().stats().eye_in_occluder);
    assert!(sees(&query, 2.0, 9.0) && sees(&query, 6.0, 2.0) && !sees(&query, 7.0, 2.0));
    assert_eq!(query.pvs().len(), 2);
}

#[test]
fn polygons_of_simple_rooms() {
    let room =
        Polyline::new(&[at(0.0, 0.0), at(4.0, 0.0), at(4.0, 4.0), at(0.0, 4.0), at(0.0, 0.0)]).unwrap();
    let query = look(&[room.into()], (1.0, 1.0));
    assert_eq!(query.polygon(), [at(4.0, 4.0), at(0.0, 4.0), at(0.0, 0.0), at(4.0, 0.0)]);
    // In the open it ends a cell beyond the grid.
    let open = look(&[], (1.0, 1.0)).polygon();
    assert_eq!(open, [at(11.0, 11.0), at(-11.0, 11.0), at(-11.0, -11.0), at(11.0, -11.0)]);
}

#[test]
fn many_solids_that_touch_the_eye_cost_no_square() {
    // Thin triangles with a corner at the eye, gaps between them, and walls beyond.
    let mut occluders = Vec::new();
    for i in 0..4000 {
        let direction = |k: f32| Vec2::from_angle((i as f32 + k) * std::f32::consts::TAU / 4000.0);
        let (a, b) = (direction(0.0), direction(0.5));
        occluders.push(ConvexPolygon::new(&[Vec2::ZERO, a, b]).unwrap().into());
        occluders.push(Segment::new(direction(0.2) * 5.0, direction(0.8) * 5.0).into());
    }
    let query = look(&occluders, (0.0, 0.0));
    assert_eq!(query.pvs().len(), 8000);
    assert!(query.pvs().stats().pieces < 20_000);
}

#[test]
fn extreme_input_is_refused_or_answered() {
    let spec = GridSpec { min: Vec2::splat(-10.0), cell: 1.0, dims: UVec2::splat(20) };
    let mut scene = Scene::new(&spec).unwrap();
    let numbers = [f32::NAN, f32::INFINITY, -f32::INFINITY, f32::MAX, f32::MIN, 1e-45, 0.0, -0.0, 3.0];
    let points: Vec<Vec2> = numbers.iter().flat_map(|&x| numbers.map(|y| at(x, y))).collect();
    for (i, &a) in points.iter().enumerate() {
        let b = points[(i * 7 + 3) % points.len()];
        let shapes: [Shape; 3] =
            [Segment::new(a, b).into(), Rect::new(a, b).into(), Disc::new(a, b.x).into()];
        for shape in shapes {
            let finite = scene.insert(ObjectDesc::new(shape.clone()).occluder(shape.clone()));
            let whole = a.is_finite() && (b.is_finite() || matches!(shape, Shape::Disc(_)));
            assert!(whole || matches!(finite, Err(Error::NotFinite { .. })), "{shape:?}");
        }
        let _ = ConvexPolygon::new(&[a, b, Vec2::ONE])
            .map(|p| scene.insert(ObjectDesc::new(p.clone()).occluder(p)));
        let _ =
            Polyline::new(&[a, b, Vec2::ONE]).map(|p| scene.insert(ObjectDesc::new(p.clone()).occluder(p)));
    }
    assert!(scene.len() > 50);
    for &eye in &points {
        let Ok(view) = View::all_round(eye) else {
            assert!(!eye.is_finite());
            continue;
        };
        let sector = View::sector(eye, at(1.0, 0.5), 0.7).unwrap();
        for view in [view, sector, view.with_range(2.0).unwrap(), sector.with_range(f32::MAX).unwrap()] {
            let mut query = Query::new();
            query.run(&scene, &view);
            assert!(query.polygon().iter().all(|p| p.is_finite()));
            assert!(!points.iter().any(|&p| query.sees_point(p) && !p.is_finite()));
        }
    }
}

#[test]
fn ids_of_other_scenes_are_refused() {
    let spec = GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(4) };
    let (mut a, mut b) = (Scene::new(&spec).unwrap(), Scene::new(&spec).unwrap());
    let disc = Disc::new(at(1.0, 1.0), 0.5);
    let id = a.insert(ObjectDesc::new(disc).occluder(disc)).unwrap();
    assert_eq!(b.update(id, disc, None), Err(Error::UnknownObject(id)));
    assert_eq!(b.remove(id), Err(Error::UnknownObject(id)));
    assert_eq!(a.update(id, disc, None), Err(Error::OccluderMissing(id)));
    let (mut query, view) = (Query::new(), View::all_round(Vec2::ZERO).unwrap());
    assert!(query.run(&a, &view).contains(id));
    a.remove(id).unwrap();
    assert!(query.run(&a, &view).is_empty() && !query.pvs().contains(id));
}

/// Comparing each hidden wall with each piece of the fence would take minutes.
#[test]
fn walls_behind_a_long_fence_cost_no_square() {
    let x = |i: u16| -9.0 + 18.0 * f32::from(i) / 16384.0;
    let fence = (0..16384).map(|i| wall((x(i), 2.25), (x(i + 1), 2.25)));
    let behind = (0..16384u16).map(|i| 2.3 + 0.6 * f32::from(i) / 16384.0);
    let occluders: Vec<Shape> = fence.chain(behind.map(|y| wall((-6.9, y), (6.9, y)))).collect();
    let query = look(&occluders, (0.0, 0.0));
    assert_eq!(query.pvs().len(), 16384);
    assert_eq!(query.pvs().stats().objects_tested, 32768);
}
