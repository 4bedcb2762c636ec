//! Exact positions on a map.

use crate::error::{Error, within};
use crate::numeric::tiles::{FARTHEST, TILE};

/// A position on a map, in tiles: tile `(x, y)` is the square from `(x, y)` to `(x + 1, y + 1)`.
///
/// A whole multiple of `2^-28` of a tile: numbers of single precision from 1/16 on are held
/// exactly, others are rounded to the nearest multiple. All that follows from a position is exact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct TilePoint {
    /// In units of 1 / [`TILE`], at most 2^60.
    units: [i64; 2],
}

impl TilePoint {
    /// A position. May lie outside of the map, on borders and corners of tiles, and in opaque
    /// tiles.
    ///
    /// # Errors
    /// A coordinate that is not finite, or whose magnitude exceeds `2^32` tiles.
    pub fn new(x: f64, y: f64) -> Result<Self, Error> {
        let units = |what, value| {
            within(what, value, [-FARTHEST, FARTHEST]).map(|v| (v * TILE as f64).round_ties_even() as i64)
        };
        Ok(Self { units: [units("the x of a position", x)?, units("the y of a position", y)?] })
    }

    /// The centre of a tile.
    pub fn center_of(x: u32, y: u32) -> Self {
        Self { units: [x, y].map(|at| i64::from(at) * TILE + TILE / 2) }
    }

    /// The x of the position, rounded to double precision.
    pub fn x(self) -> f64 {
        self.units[0] as f64 / TILE as f64
    }

    /// The y of the position, rounded to double precision.
    pub fn y(self) -> f64 {
        self.units[1] as f64 / TILE as f64
    }

    /// The coordinates in units of 1 / [`TILE`].
    pub(super) fn units(self) -> [i64; 2] {
        self.units
    }
}
