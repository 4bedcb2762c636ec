//! Fields of view of all eyes in a tile: against single eyes, and against rays past shrunk walls.

use std::collections::BTreeSet;

use casca_plane::{BitGrid, FieldOfView, FovOptions, OpaqueTiles, TileError};
use proptest::prelude::*;

use crate::cases::cases;
use crate::maps::{drawn, map};
use crate::oracle::{Direction, Oracle, UNIT};

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

/// The tiles that a ray from the centre of a tile crosses before it meets a segment between the
/// centres of opaque neighbours. It must meet no centre and no corner. Lengths are halves of a
/// tile.
fn tiles_past_shrunk_walls(map: &BitGrid, eye: Tile, direction: Direction) -> Vec<Tile> {
    let center = [i128::from(eye.0) * 2 + 1, i128::from(eye.1) * 2 + 1];
    let size = [i128::from(map.width()) * 2, i128::from(map.height()) * 2];
    let step = direction.map(i128::signum);
    // The half tile that the ray is in, from its least corner.
    let mut half = [0, 1].map(|axis| center[axis] - i128::from(step[axis] < 0));
    let mut found = Vec::new();
    while (0..2).all(|axis| (0..size[axis]).contains(&half[axis])) {
        found.push(((half[0] / 2) as u32, (half[1] / 2) as u32));
        let to = [0, 1].map(|axis| (half[axis] + i128::from(step[axis] > 0) - center[axis]).abs());
        let axis = usize::from(to[1] * direction[0].abs() < to[0] * direction[1].abs());
        let line = half[axis] + i128::from(step[axis] > 0);
        if line % 2 == 1 {
            // A line of centres: the ray crosses it between those of two tiles.
            let across = half[1 - axis];
            let ends = [(across - 1).div_euclid(2), (across - 1).div_euclid(2) + 1].map(|along| {
                let tile = if axis == 0 { [line / 2, along] } else { [along, line / 2] };
                tile.iter().all(|&at| at >= 0) && map.get(tile[0] as u32, tile[1] as u32)
            });
            if ends == [true, true] {
                break;
            }
        }
        half[axis] += step[axis];
    }
    found
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

    #[test]
    fn exactly_the_tiles_past_shrunk_walls((map, tile) in map_and_tile()) {
        // Between the directions of corners and centres of tiles, rays cross the same tiles.
        let center = [tile.0, tile.1].map(|at| i128::from(at) * UNIT + UNIT / 2);
        let oracle = Oracle { opaque: &map, eye: center };
        let (width, height) = (i128::from(map.width()), i128::from(map.height()));
        let halves = |size: i128| (0..=2 * size).map(|at| at * UNIT / 2);
        let centers: Vec<_> = halves(width)
            .flat_map(|x| halves(height).map(move |y| [x - center[0], y - center[1]]))
            .filter(|&corner| corner != [0, 0])
            .collect();
        let truth: BTreeSet<_> = oracle
            .directions(&centers)
            .into_iter()
            .flat_map(|ray| tiles_past_shrunk_walls(&map, tile, ray))
            .collect();
        prop_assert_eq!(seen(&map, tile, &FovOptions::default()), truth);
    }
}

#[test]
fn long_walls_hide_and_single_tiles_do_not() {
    let map = drawn(&[".......", ".......", "#######", ".......", ".#...#.", "......."]);
    let seen = seen(&map, (3, 0), &FovOptions::default());
    assert!((0..7).all(|x| !seen.contains(&(x, 4)) && seen.contains(&(x, 3))));
    assert!(seen.contains(&(0, 2)) && seen.contains(&(6, 2)));
    let mut fov = FieldOfView::new();
    let outside = fov.run_from_tile(&OpaqueTiles::new(map), 7, 0, &FovOptions::default());
    assert_eq!(outside, Err(TileError::Outside { x: 7, y: 0, width: 7, height: 6 }));
}
