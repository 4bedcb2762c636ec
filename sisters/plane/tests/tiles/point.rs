//! Fields of view on tiles against the exact method of scenes, on the same map.

use casca_plane::{FieldOfView, FovOptions, GridSpec, Query, Rect, Scene, TileLayer, View};
use glam::{UVec2, Vec2};
use proptest::prelude::*;

use crate::cases::cases;
use crate::maps::{map_and_eye, point};
use crate::oracle::UNIT;

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn scenes_and_tiles_agree((map, eye) in map_and_eye()) {
        /// The part of a tile that certainly lies in its inside.
        const INSIDE: f32 = 1.0 / 4096.0;
        let at = Vec2::from(eye.map(|at| at as f32 / UNIT as f32));
        let exact = eye.map(|at| at as f64 / UNIT as f64) == [f64::from(at.x), f64::from(at.y)];
        let layer = TileLayer::new(Vec2::ZERO, 1.0, map).unwrap();
        let bits = layer.opaque().bits();
        // For eyes in and on walls, each method has its own rule.
        let near = |axis: usize| {
            let tile = eye[axis].div_euclid(UNIT);
            [tile - i128::from(eye[axis].rem_euclid(UNIT) == 0), tile]
        };
        let touches = near(0).into_iter().any(|x| {
            near(1).into_iter().any(|y| x >= 0 && y >= 0 && bits.get(x as u32, y as u32))
        });
        if touches || !exact {
            return Ok(());
        }

        let dims = UVec2::new(bits.width(), bits.height());
        let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims }).unwrap();
        scene.insert_tiles(&layer).unwrap();
        let mut query = Query::new();
        query.run(&scene, &View::all_round(at).unwrap());
        let mut fov = FieldOfView::new();
        let seen = fov.run(layer.opaque(), point(eye), &FovOptions::default());
        for (x, y) in (0..dims.y).flat_map(|y| (0..dims.x).map(move |x| (x, y))) {
            if bits.get(x, y) {
                continue;
            }
            let min = Vec2::new(x as f32, y as f32);
            let sees = |margin: f32| query.sees(Rect::new(min + margin, min + 1.0 - margin)).unwrap();
            prop_assert!(sees(0.0) || !seen.get(x, y), "only the tiles see ({}, {})", x, y);
            prop_assert!(seen.get(x, y) || !sees(INSIDE), "only the scene sees ({}, {})", x, y);
        }
    }
}
