//! Marks of pixels, in tiles of 8x8.

use crate::occlusion::pixels::PixelRect;
use crate::occlusion::tiles::TILE;

/// A rectangle of whole tiles.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Area {
    /// First pixel.
    pub(crate) x: i64,
    pub(crate) y: i64,
    /// Number of tiles.
    pub(crate) nx: i64,
    pub(crate) ny: i64,
}

impl Area {
    /// The tiles around a rectangle of pixels that is not empty.
    pub(crate) fn around(pixels: &PixelRect) -> Self {
        let (x, y) = (pixels.x.0 / TILE * TILE, pixels.y.0 / TILE * TILE);
        Self { x, y, nx: (pixels.x.1 - 1 - x) / TILE + 1, ny: (pixels.y.1 - 1 - y) / TILE + 1 }
    }

    pub(crate) fn tile_count(&self) -> usize {
        (self.nx * self.ny) as usize
    }

    /// Pixels in a row.
    #[inline]
    pub(crate) fn width(&self) -> i32 {
        (self.nx * TILE) as i32
    }

    /// Rows of pixels.
    #[inline]
    pub(crate) fn height(&self) -> i32 {
        (self.ny * TILE) as i32
    }
}

/// The pixels of a tile by layer: touched by open edges; touched by seams; with a positive winding
/// number around the middle; with a negative one.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Marks([u64; 4]);

impl Marks {
    pub(crate) const OPEN: usize = 0;
    pub(crate) const SEAM: usize = 1;
    pub(crate) const PLUS: usize = 2;
    pub(crate) const MINUS: usize = 3;

    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        let [open, seam, plus, minus] = self.0;
        open | seam | plus | minus == 0
    }

    /// The pixels that the outline covers as a whole.
    #[inline]
    pub(crate) fn covered(&self) -> u64 {
        let [open, seam, plus, minus] = self.0;
        (plus | minus) & !(open | seam)
    }

    /// Of the marks of several patches: the pixels touched by seams only that the patches cover together. Their
    /// winding numbers do not sum to zero, because they do not have both signs.
    #[inline]
    pub(crate) fn covered_seams(&self) -> u64 {
        let [open, seam, plus, minus] = self.0;
        seam & (plus ^ minus) & !open
    }

    /// Adds the marks of another patch.
    #[inline]
    pub(crate) fn add(&mut self, other: &Self) {
        for (all, own) in self.0.iter_mut().zip(other.0) {
            *all |= own;
        }
    }

    #[cfg(test)]
    pub(super) fn has(&self, layer: usize, bit: u32) -> bool {
        self.0[layer] >> bit & 1 == 1
    }
}

/// The marks of all tiles of an area.
#[derive(Debug, Clone, Default)]
pub(super) struct TileMarks {
    across: i32,
    marks: Vec<Marks>,
}

impl TileMarks {
    pub(super) fn clear(&mut self, area: &Area) {
        self.across = area.nx as i32;
        self.marks.clear();
        self.marks.resize(area.tile_count(), Marks::default());
    }

    #[inline]
    pub(super) fn get(&self, tile: usize) -> Marks {
        self.marks[tile]
    }

    /// Marks pixels of a row; both ends are included and inside the area.
    #[inline]
    pub(super) fn mark(&mut self, row: i32, first: i32, last: i32, layer: usize) {
        let at = (row >> 3) * self.across;
        let shift = (row & 7) << 3;
        let (a, b) = (first >> 3, last >> 3);
        let (low, high) = (0xffu64 << (first & 7) & 0xff, 0xffu64 >> (7 - (last & 7)));
        if a == b {
            self.marks[(at + a) as usize].0[layer] |= (low & high) << shift;
            return;
        }
        self.marks[(at + a) as usize].0[layer] |= low << shift;
        for tx in a + 1..b {
            self.marks[(at + tx) as usize].0[layer] |= 0xff << shift;
        }
        self.marks[(at + b) as usize].0[layer] |= high << shift;
    }
}
