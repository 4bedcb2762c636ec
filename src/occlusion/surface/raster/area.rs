//! Rectangles of whole blocks.

use crate::occlusion::pixels::PixelRect;
use crate::occlusion::tiles::TILE;

/// Columns of a block: the bits of a word.
pub(crate) const COLUMNS: i64 = u32::BITS as i64;

/// Tiles in a block, side by side.
pub(crate) const TILES: usize = (COLUMNS / TILE) as usize;

/// A rectangle of blocks of 32x8 pixels. Blocks of all areas of a face lie in one pattern.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Area {
    /// First pixel.
    pub(crate) x: i64,
    pub(crate) y: i64,
    /// Number of blocks.
    pub(crate) nx: i64,
    pub(crate) ny: i64,
}

impl Area {
    /// The blocks around a rectangle of pixels that is not empty.
    #[inline]
    pub(crate) fn around(pixels: &PixelRect) -> Self {
        let (x, y) = (pixels.x.0 / COLUMNS * COLUMNS, pixels.y.0 / TILE * TILE);
        Self { x, y, nx: (pixels.x.1 - 1 - x) / COLUMNS + 1, ny: (pixels.y.1 - 1 - y) / TILE + 1 }
    }

    /// The place of a block, counted in rows and columns from the first one of another area that
    /// lies inside this one.
    #[inline]
    pub(crate) fn block(&self, inside: &Self, row: i64, column: i64) -> usize {
        let (row, column) = ((inside.y - self.y) / TILE + row, (inside.x - self.x) / COLUMNS + column);
        (row * self.nx + column) as usize
    }

    pub(crate) fn block_count(&self) -> usize {
        (self.nx * self.ny) as usize
    }

    /// Pixels in a row.
    #[inline]
    pub(crate) fn width(&self) -> i32 {
        (self.nx * COLUMNS) as i32
    }

    /// Rows of pixels.
    #[inline]
    pub(crate) fn height(&self) -> i32 {
        (self.ny * TILE) as i32
    }
}
