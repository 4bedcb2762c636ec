//! Fields of view of all eyes in a tile: against single eyes, and against all lines in whole numbers.

use std::collections::BTreeSet;

use casca_plane::{BitGrid, Error, FieldOfView, FovOptions, OpaqueTiles};
use glam::{IVec2, UVec2};
use proptest::prelude::*;

use crate::cases::cases;
use crate::exact::is_visible;
use crate::maps::{drawn, maps_of};
use crate::oracle::{Oracle, UNIT};

type Tile = (u32, u32);

fn seen(map: &BitGrid, tile: Tile, options: &FovOptions) -> BTreeSet<Tile> {
    let (mut fov, opaque) = (FieldOfView::new(), OpaqueTiles::new(map.clone()));
    fov.run_from_tile(&opaque, tile.0, tile.1, options).unwrap().cells().collect()
}

/// A map of some sizes, and a tile of it.
fn map_and_tile(most: u32) -> impl Strategy<Value = (BitGrid, Tile)> {
    maps_of(1..=most, 0..90).prop_flat_map(|map| {
        let tile = (0..map.width(), 0..map.height());
        (Just(map), tile)
    })
}

proptest! {
    #![proptest_config(cases(250))]

    #[test]
    fn nothing_that_an_eye_sees_is_missing(
        (map, tile) in map_and_tile(12),
        eyes in proptest::collection::vec(proptest::array::uniform2(prop_oneof![Just(0), Just(UNIT), 0..=UNIT]), 6),
        eighths in 1..90_i128,
    ) {
        let all = seen(&map, tile, &FovOptions::default());
        let near = seen(&map, tile, &FovOptions::default().in_circle(eighths as f32 / 8.0).unwrap());
        prop_assert!(near.is_subset(&all));
        for part in eyes {
            let eye = [i128::from(tile.0) * UNIT + part[0], i128::from(tile.1) * UNIT + part[1]];
            let oracle = Oracle { opaque: &map, eye };
            let truth = oracle.seen();
            // On the border, an eye also sees the tiles beyond that it touches.
            prop_assert!(truth.is_subset(&all), "misses {:?}", truth.difference(&all));
            let in_range: BTreeSet<_> =
                truth.into_iter().filter(|&tile| oracle.in_range(tile, eighths * UNIT / 8)).collect();
            prop_assert!(in_range.is_subset(&near), "misses {:?}", in_range.difference(&near));
        }
    }
}

/// What eyes in the corners of a tile see. No line passes between two opaque tiles that touch
/// there, but these eyes look out.
fn seen_from_corners(map: &BitGrid, tile: Tile) -> BTreeSet<Tile> {
    let corners = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(x, y)| [tile.0 + x, tile.1 + y]);
    let eyes = corners.map(|corner| corner.map(|at| i128::from(at) * UNIT));
    eyes.into_iter().flat_map(|eye| Oracle { opaque: map, eye }.seen()).collect()
}

proptest! {
    #![proptest_config(cases(150))]

    #[test]
    // Small maps: lines through all pairs of corners are looked at for each pair of tiles.
    fn exactly_the_tiles_that_some_eye_sees((map, tile) in map_and_tile(7)) {
        let at = |(x, y): Tile| IVec2::new(x as i32, y as i32);
        let opaque: Vec<IVec2> = map.cells().map(at).collect();
        let tiles = (0..map.height()).flat_map(|y| (0..map.width()).map(move |x| (x, y)));
        let mut truth: BTreeSet<Tile> =
            tiles.filter(|&other| other == tile || is_visible(&opaque, at(tile), at(other))).collect();
        let mut fov = FieldOfView::new();
        let inner = fov.run_symmetric(&OpaqueTiles::new(map.clone()), tile.0, tile.1, &FovOptions::default());
        prop_assert_eq!(inner.unwrap().cells().collect::<BTreeSet<_>>(), truth.clone(), "from within");
        truth.extend(seen_from_corners(&map, tile));
        prop_assert_eq!(seen(&map, tile, &FovOptions::default()), truth);
    }

    #[test]
    fn exactly_the_far_tiles_that_some_eye_sees(
        // Few walls: lines pass many of them.
        map in maps_of(14..=22, 4..20),
        tile in (0..6_u32, 0..6_u32),
        others in proptest::collection::vec((0..14_u32, 0..14_u32), 24),
    ) {
        let at = |(x, y): Tile| IVec2::new(x as i32, y as i32);
        let opaque: Vec<IVec2> = map.cells().map(at).collect();
        let seen = seen(&map, tile, &FovOptions::default());
        let (corners, last) = (seen_from_corners(&map, tile), (map.width() - 1, map.height() - 1));
        for other in others.into_iter().map(|(x, y)| (last.0 - x, last.1 - y)).filter(|&(x, y)| x.max(y) > 7) {
            let truth = corners.contains(&other) || is_visible(&opaque, at(tile), at(other));
            prop_assert_eq!(seen.contains(&other), truth, "{:?}", other);
        }
    }
}

#[test]
fn long_walls_and_single_tiles_hide() {
    let map = drawn(&[".......", ".......", "#######", ".......", ".#...#.", "......."]);
    let seen = seen(&map, (3, 0), &FovOptions::default());
    assert!((0..7).all(|x| !seen.contains(&(x, 4)) && seen.contains(&(x, 3))));
    assert!(seen.contains(&(0, 2)) && seen.contains(&(6, 2)));
    let mut fov = FieldOfView::new();
    let outside = fov.run_from_tile(&OpaqueTiles::new(map), 7, 0, &FovOptions::default());
    assert_eq!(outside, Err(Error::Outside { tile: UVec2::new(7, 0), size: UVec2::new(7, 6) }));
}
