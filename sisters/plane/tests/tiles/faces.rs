//! The sides of opaque tiles that are seen, and layers in a scene.

use std::collections::BTreeSet;

use casca_plane::{BitGrid, FovOptions, OpaqueTiles, Side, TileError, TileFace, TileLayer, VisibleFaces};
use glam::{DVec2, UVec2, Vec2};
use proptest::prelude::*;

use crate::cases::cases;
use crate::maps::{drawn, map_and_eye, point};
use crate::oracle::Oracle;

/// The side that a ray enters a tile at, as a face of one tile.
fn side(tile: (u32, u32), axis: usize, upward: bool) -> TileFace {
    let (x, y) = tile;
    let (side, line, from) = match (axis, upward) {
        (0, true) => (Side::West, x, y),
        (0, false) => (Side::East, x + 1, y),
        (_, true) => (Side::South, y, x),
        (_, false) => (Side::North, y + 1, x),
    };
    TileFace { side, line, from, to: from + 1 }
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn exactly_the_sides_that_rays_end_at((map, eye) in map_and_eye()) {
        let oracle = Oracle { opaque: &map, eye };
        let mut truth = BTreeSet::new();
        for ray in oracle.directions(&[]) {
            let path = oracle.path(ray);
            match (path.end, path.tiles.last()) {
                (Some(Some(axis)), Some(&tile)) => {
                    truth.insert(side(tile, axis, ray[axis] > 0));
                }
                (Some(None), Some(&tile)) => {
                    truth.extend((0..4).map(|at| side(tile, at % 2, at < 2)));
                }
                _ => {}
            }
        }
        let mut faces = VisibleFaces::new();
        let found = faces.run(&OpaqueTiles::new(map.clone()), point(eye), &FovOptions::default());
        for pair in found.windows(2) {
            let one_line = (pair[0].side, pair[0].line) == (pair[1].side, pair[1].line);
            prop_assert!(pair[0] < pair[1] && !(one_line && pair[1].from <= pair[0].to));
        }
        let sides: BTreeSet<_> = found
            .iter()
            .flat_map(|face| (face.from..face.to).map(|from| TileFace { from, to: from + 1, ..*face }))
            .collect();
        prop_assert_eq!(sides, truth);
    }
}

#[test]
fn faces_lie_in_the_scene() {
    let mut layer = TileLayer::new(Vec2::new(-2.0, 10.0), 0.5, drawn(&["....", ".##.", "...."])).unwrap();
    let eye = layer.point(Vec2::new(-1.25, 10.25)).unwrap();
    assert_eq!((eye.x(), eye.y()), (1.5, 0.5));
    let mut faces = VisibleFaces::new();
    let ends = |faces: &[TileFace]| faces.iter().map(|&face| layer.ends(face)).collect::<Vec<_>>();
    let seen = ends(faces.run(layer.opaque(), eye, &FovOptions::default()));
    assert_eq!(seen, [[DVec2::new(-1.5, 10.5), DVec2::new(-0.5, 10.5)]]);
    assert_eq!(faces.faces()[0].ends(), [UVec2::new(1, 1), UVec2::new(3, 1)]);
    layer.set_tile(2, 1, false).unwrap();
    assert_eq!(faces.run(layer.opaque(), eye, &FovOptions::default()).len(), 1);
    assert_eq!(faces.faces()[0].to, 2);
    let outside = TileError::Outside { x: 4, y: 0, width: 4, height: 3 };
    assert_eq!(layer.set_tile(4, 0, true), Err(outside));
    assert_eq!((layer.origin(), layer.tile_size()), (Vec2::new(-2.0, 10.0), 0.5));
}

#[test]
fn layers_are_checked() {
    let layer = |origin, size| TileLayer::new(origin, size, BitGrid::new(4, 4));
    for size in [0.0, -1.0, f32::NAN, f32::INFINITY, f32::MAX] {
        assert!(layer(Vec2::ZERO, size).is_err(), "{size}");
    }
    assert!(
        layer(Vec2::new(f32::NAN, 0.0), 1.0).is_err() && layer(Vec2::new(0.0, f32::INFINITY), 1.0).is_err()
    );
    let tiny = layer(Vec2::ZERO, 1e-30).unwrap();
    assert!(
        tiny.point(Vec2::ONE).is_err() && tiny.point(Vec2::NAN).is_err() && tiny.point(Vec2::ZERO).is_ok()
    );
}
