//! Fields of view of all eyes in a tile: against single eyes, and against all lines in whole numbers.

#[path = "../common/exact.rs"]
mod exact;

use std::collections::BTreeSet;

use casca_plane::{BitGrid, Error, FieldOfView, FovOptions, OpaqueTiles};
use glam::IVec2;
use proptest::prelude::*;

use crate::cases::cases;
use crate::maps::{drawn, map};
use crate::oracle::{Oracle, UNIT};
use exact::is_visible;

type Tile = (u32, u32);

fn seen(map: &BitGrid, tile: Tile, options: &FovOptions) -> BTreeSet<Tile> {
    let mut fov = FieldOfView::new();
    let opaque = OpaqueTiles::new(map.clone());
    fov.run_from_tile(&opaque, tile.0, tile.1, options).unwrap().cells().collect()
}

/// A map, and a tile of it.
fn map_and_tile() -> impl Strategy<Value = (BitGrid, Tile)> {
    map().prop_flat_map(|map| {
        let tile = (0..map.width(), 0..map.height());
        (Just(map), tile)
    })
}

proptest! {
    #![proptest_config(cases(250))]

    #[test]
    fn nothing_that_an_eye_sees_is_missing(
        (map, tile) in map_and_tile(),
        eyes in proptest::collection::vec(proptest::array::uniform2(prop_oneof![Just(0), Just(UNIT), 0..=UNIT]), 6),
        eighths in 1..90_i128,
        circle: bool,
    ) {
        let all = seen(&map, tile, &FovOptions::default());
        let options = FovOptions::default();
        let radius = eighths as f32 / 8.0;
        let options = if circle { options.in_circle(radius) } else { options.in_square(radius) }.unwrap();
        let near = seen(&map, tile, &options);
        prop_assert!(near.is_subset(&all));
        for part in eyes {
            let eye = [i128::from(tile.0) * UNIT + part[0], i128::from(tile.1) * UNIT + part[1]];
            let oracle = Oracle { opaque: &map, eye };
            let truth = oracle.seen();
            // On the border, an eye also sees the tiles beyond that it touches.
            prop_assert!(truth.is_subset(&all), "misses {:?}", truth.difference(&all));
            let in_range: BTreeSet<_> =
                truth.into_iter().filter(|&tile| oracle.in_range(tile, eighths * UNIT / 8, circle)).collect();
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

/// Small maps: lines through all pairs of corners are looked at for each pair of tiles.
fn small_map_and_tile() -> impl Strategy<Value = (BitGrid, Tile)> {
    map_and_tile().prop_map(|(map, tile)| {
        let (width, height) = (map.width().min(7), map.height().min(7));
        let mut small = BitGrid::new(width, height);
        map.cells().filter(|&(x, y)| x < width && y < height).for_each(|(x, y)| small.set(x, y, true));
        (small, (tile.0 % width, tile.1 % height))
    })
}

proptest! {
    #![proptest_config(cases(150))]

    #[test]
    fn exactly_the_tiles_that_some_eye_sees((map, tile) in small_map_and_tile()) {
        let at = |(x, y): Tile| IVec2::new(x as i32, y as i32);
        let opaque: Vec<IVec2> = map.cells().map(at).collect();
        let tiles = (0..map.height()).flat_map(|y| (0..map.width()).map(move |x| (x, y)));
        let mut truth: BTreeSet<Tile> =
            tiles.filter(|&other| other == tile || is_visible(&opaque, at(tile), at(other))).collect();
        truth.extend(seen_from_corners(&map, tile));
        prop_assert_eq!(seen(&map, tile, &FovOptions::default()), truth);
    }
}

/// A map with few walls, on which lines pass many of them.
fn open_map() -> impl Strategy<Value = BitGrid> {
    (14..=22_u32, 4..20_u32).prop_flat_map(|(size, density)| {
        let tile = (0..100_u32).prop_map(move |roll| roll < density);
        proptest::collection::vec(tile, (size * size) as usize).prop_map(move |tiles| {
            let mut map = BitGrid::new(size, size);
            (0..).zip(tiles).for_each(|(at, opaque)| map.set(at % size, at / size, opaque));
            map
        })
    })
}

proptest! {
    #![proptest_config(cases(150))]

    #[test]
    fn exactly_the_far_tiles_that_some_eye_sees(
        map in open_map(),
        tile in (0..6_u32, 0..6_u32),
        others in proptest::collection::vec((0..14_u32, 0..14_u32), 24),
    ) {
        let at = |(x, y): Tile| IVec2::new(x as i32, y as i32);
        let opaque: Vec<IVec2> = map.cells().map(at).collect();
        let seen = seen(&map, tile, &FovOptions::default());
        let (corners, last) = (seen_from_corners(&map, tile), map.width() - 1);
        for other in others.into_iter().map(|(x, y)| (last - x, last - y)).filter(|&(x, y)| x.max(y) > 7) {
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
    assert_eq!(outside, Err(Error::Outside { x: 7, y: 0, width: 7, height: 6 }));
}
