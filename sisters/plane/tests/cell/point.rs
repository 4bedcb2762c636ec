//! Sets of the cell method against exact sets from points of the cell, on scenes of all shapes.

use casca_plane::{
    BitGrid, ConvexPolygon, Disc, Fusion, GridSpec, Method, ObjectDesc, Polyline, Query, Rect, Scene,
    Segment, Shape, TileLayer, View,
};
use glam::{UVec2, Vec2};
use proptest::prelude::*;

use crate::cases::cases;
use crate::scenes::Random;

/// A shape of some kind, up to `size` cells large.
fn shape(random: &mut Random, cells: f32, size: f32) -> Shape {
    let center = random.point(-1.0, cells + 1.0);
    let by = |random: &mut Random| random.point(-size, size);
    match random.below(5) {
        0 => Disc::new(center, random.between(0.0, size)).into(),
        // Sides on lines of the grid are common.
        1 => Rect::new(center.floor(), center.floor() + by(random).abs().ceil()).into(),
        2 => {
            let corners = [(); 4].map(|()| center + by(random));
            ConvexPolygon::new(&corners).map_or(Disc::new(center, 0.5).into(), Shape::from)
        }
        3 => Segment::new(center, center + by(random)).into(),
        _ => Polyline::new(&[center, center + by(random), center + by(random)]).unwrap().into(),
    }
}

fn scene(random: &mut Random) -> Scene {
    let cells = 8 + random.below(24) as u32;
    let spec = GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(cells) };
    let mut scene = Scene::new(&spec).unwrap();
    let mut tiles = BitGrid::new(cells + 4, cells);
    for _ in 0..random.below(60) {
        tiles.set(random.below(u64::from(cells) + 4) as u32, random.below(u64::from(cells)) as u32, true);
    }
    let origin = Vec2::splat([0.0, -1.0, 0.5][random.below(3) as usize]);
    let tile = [1.0, 0.75, 2.0][random.below(3) as usize];
    scene.insert_tiles(&TileLayer::new(origin, tile, tiles).unwrap()).unwrap();
    for _ in 0..random.below(8) {
        let occluder = shape(random, cells as f32, 5.0);
        let desc = ObjectDesc::fixed(occluder.clone()).occluder(occluder);
        scene.insert(desc).unwrap();
    }
    for _ in 0..30 {
        let small = shape(random, cells as f32, 0.6);
        scene.insert(ObjectDesc::fixed(small)).unwrap();
    }
    scene
}

proptest! {
    #![proptest_config(cases(80))]

    #[test]
    fn what_a_point_of_the_cell_sees_the_cell_sees(seed: u64) {
        let mut random = Random(seed);
        let scene = scene(&mut random);
        let size = scene.grid().max().x as f32;
        let mut point = Query::with_method(Method::Point).unwrap();
        for _ in 0..4 {
            let corner = random.point(-2.0, size + 2.0).floor();
            let direction = Vec2::from_angle(random.between(0.0, 6.25));
            let half_angle = [std::f32::consts::PI, 0.5, 1.2, 2.5][random.below(4) as usize];
            // All eyes in the cell: its middle, corners, points on its sides and inside.
            let shares = [(0.5, 0.5), (0.0, 0.0), (0.999, 0.0), (0.999, 0.999), (0.25, 0.0), (0.3, 0.8)];
            for share in shares.map(Vec2::from) {
                let eye = corner + share;
                let range = random.between(1.0, 30.0);
                let view = View::sector(eye, direction, half_angle).unwrap();
                let view = if random.below(3) == 0 { view.with_range(range).unwrap() } else { view };
                let exact = point.run(&scene, &view);
                for fusion in [Fusion::Masks, Fusion::LShaped] {
                    let mut cell = Query::with_method(Method::Cell).unwrap();
                    cell.set_cell_options(cell.cell_options().fusion(fusion)).unwrap();
                    // The same view, and one all round from another eye of the cell.
                    let other = View::all_round(corner + Vec2::new(0.7, 0.4)).unwrap();
                    for view in [view, other] {
                        let set = cell.run(&scene, &view);
                        // Eyes in an occluder do not count, but for the view's own.
                        if view == other && exact.stats().eye_in_occluder {
                            continue;
                        }
                        for id in exact {
                            prop_assert!(set.contains(id), "{eye} {view:?} {:?}", scene.bounds(id));
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn absurd_views_and_scenes() {
    let spec = GridSpec { min: Vec2::splat(-4.0), cell: 1.0, dims: UVec2::new(8, 3) };
    let mut scene = Scene::new(&spec).unwrap();
    let far = 3e38;
    let everything = Rect::new(Vec2::splat(-far), Vec2::splat(far));
    let id = scene.insert(ObjectDesc::fixed(everything).occluder(everything)).unwrap();
    let mover = scene.insert(ObjectDesc::dynamic(Disc::new(Vec2::splat(-3.0), 0.1)).max_speed(far)).unwrap();
    let mut query = Query::with_method(Method::Cell).unwrap();
    for (frame, x) in [0.0, -far, far, 1e-45, 7e4, -1e9].into_iter().enumerate() {
        scene.begin_frame(frame as f64 * 1e300).unwrap();
        let view = View::all_round(Vec2::new(x, -x)).unwrap();
        for view in [view, view.with_range(far).unwrap(), View::sector(Vec2::splat(x), Vec2::X, 0.0).unwrap()]
        {
            query.run(&scene, &view);
            // Eyes inside of a rock see past it, at least as far as itself.
            assert!(query.pvs().contains(id) || x.abs() == far, "{x}");
            scene.end_frame([query.pvs()]).unwrap();
        }
        scene.update(mover, Disc::new(Vec2::splat(x), 1e30), None).unwrap();
        assert!(query.seen_cells(&scene).unwrap().count() <= 24);
    }
    assert!(query.seen_cells(&scene.clone()).is_none());
    for angle in [-0.1, 4.0, f32::NAN, f32::INFINITY] {
        assert!(query.set_cell_options(query.cell_options().min_angle(angle)).is_err());
    }
}
