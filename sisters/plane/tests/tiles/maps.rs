//! Small maps and eyes for tests.

use std::ops::{Range, RangeInclusive};

use casca_plane::{BitGrid, TilePoint};
use proptest::prelude::*;

use crate::oracle::UNIT;

/// A map from its drawing: `#` blocks. The first line is the row of the greatest y.
pub fn drawn(rows: &[&str]) -> BitGrid {
    let mut tiles = BitGrid::new(rows[0].len() as u32, rows.len() as u32);
    for (y, row) in rows.iter().rev().enumerate() {
        for (x, _) in row.bytes().enumerate().filter(|&(_, tile)| tile == b'#') {
            tiles.set(x as u32, y as u32, true);
        }
    }
    tiles
}

/// Maps of some sizes and densities, in percent.
pub fn maps_of(sizes: RangeInclusive<u32>, density: Range<u32>) -> impl Strategy<Value = BitGrid> {
    (sizes.clone(), sizes, density).prop_flat_map(|(width, height, density)| {
        let tile = (0..100_u32).prop_map(move |roll| roll < density);
        proptest::collection::vec(tile, (width * height) as usize).prop_map(move |tiles| {
            let mut map = BitGrid::new(width, height);
            for (at, opaque) in (0..).zip(tiles) {
                map.set(at % width, at / width, opaque);
            }
            map
        })
    })
}

/// Maps of all densities up to 12 by 12 tiles.
pub fn map() -> impl Strategy<Value = BitGrid> {
    maps_of(1..=12, 0..90)
}

/// A coordinate of an eye, in units, up to two tiles outside of a map: often on borders, in the
/// middle of tiles, or next to borders.
pub fn coordinate(size: u32) -> impl Strategy<Value = i128> {
    let tile = -2..i128::from(size) + 2;
    let part = prop_oneof![
        Just(0),
        Just(UNIT / 2),
        (0..8_i128).prop_map(|part| part * UNIT / 8),
        0..UNIT,
        Just(1),
        Just(UNIT - 1)
    ];
    (tile, part).prop_map(|(tile, part)| tile * UNIT + part)
}

/// A map, and an eye in units.
pub fn map_and_eye() -> impl Strategy<Value = (BitGrid, [i128; 2])> {
    map().prop_flat_map(|map| {
        let eye = (coordinate(map.width()), coordinate(map.height()));
        (Just(map), eye.prop_map(|(x, y)| [x, y]))
    })
}

/// The position of an eye that is given in units.
pub fn point(eye: [i128; 2]) -> TilePoint {
    let [x, y] = eye.map(|at| at as f64 / UNIT as f64);
    TilePoint::new(x, y).expect("eyes are near their maps")
}
