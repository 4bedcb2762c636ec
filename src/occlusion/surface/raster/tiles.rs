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

    /// The place of a tile, counted in rows and columns from the first one of another area that
    /// lies inside this one.
    #[inline]
    pub(crate) fn tile(&self, inside: &Self, row: i64, column: i64) -> usize {
        (((inside.y - self.y) / TILE + row) * self.nx + (inside.x - self.x) / TILE + column) as usize
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

/// The pixels of a tile by layer: touched by open edges; touched by seams; and the two digits of
/// the winding number around the middle, modulo four.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Marks([u64; 4]);

impl Marks {
    pub(crate) const OPEN: usize = 0;
    pub(crate) const SEAM: usize = 1;
    const ONES: usize = 2;
    const TWOS: usize = 3;

    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        let [open, seam, ones, twos] = self.0;
        open | seam | ones | twos == 0
    }

    /// The pixels touched by open edges.
    #[inline]
    pub(crate) fn open(&self) -> u64 {
        self.0[Self::OPEN]
    }

    /// All layers: touched by open edges, touched by seams, ones and twos of the winding numbers.
    #[inline]
    pub(super) fn layers(&self) -> [u64; 4] {
        self.0
    }

    /// The pixels that the outline covers as a whole.
    #[inline]
    pub(crate) fn covered(&self) -> u64 {
        let [open, seam, ones, twos] = self.0;
        (ones | twos) & !(open | seam)
    }

    /// Of the marks of several patches: the pixels touched by seams only that the patches cover
    /// together. Their winding numbers do not sum to zero.
    #[inline]
    pub(crate) fn covered_seams(&self) -> u64 {
        let [open, seam, ones, twos] = self.0;
        seam & (ones | twos) & !open
    }

    /// Adds the marks of another patch.
    #[inline]
    pub(crate) fn add(&mut self, other: &Self) {
        self.0[Self::OPEN] |= other.0[Self::OPEN];
        self.0[Self::SEAM] |= other.0[Self::SEAM];
        self.wind(other.0[Self::ONES], other.0[Self::TWOS]);
    }

    /// Adds winding numbers, modulo four.
    #[inline(always)]
    fn wind(&mut self, ones: u64, twos: u64) {
        self.0[Self::TWOS] ^= twos ^ (self.0[Self::ONES] & ones);
        self.0[Self::ONES] ^= ones;
    }

    /// Replaces the numbers in each row by their sums up to each pixel, those before the tile
    /// included.
    #[inline(always)]
    fn sum_rows(&mut self, before: (u64, u64)) {
        for (shift, mask) in
            [(1, 0xfefe_fefe_fefe_fefe), (2, 0xfcfc_fcfc_fcfc_fcfc), (4, 0xf0f0_f0f0_f0f0_f0f0)]
        {
            self.wind(self.0[Self::ONES] << shift & mask, self.0[Self::TWOS] << shift & mask);
        }
        self.wind(before.0, before.1);
    }

    /// The numbers of the last pixels of all rows, in all pixels of the rows.
    #[inline(always)]
    fn last(&self) -> (u64, u64) {
        let spread = |word: u64| (word >> 7 & 0x0101_0101_0101_0101) * 0xff;
        (spread(self.0[Self::ONES]), spread(self.0[Self::TWOS]))
    }

    #[cfg(test)]
    pub(super) fn has(&self, layer: usize, bit: u32) -> bool {
        self.0[layer] >> bit & 1 == 1
    }

    /// The winding number around the middle of a pixel, modulo four.
    #[cfg(test)]
    pub(super) fn winding(&self, bit: u32) -> i32 {
        i32::from(self.has(Self::ONES, bit)) + 2 * i32::from(self.has(Self::TWOS, bit))
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
        // Short runs of pixels are marked in two tiles, the second of which may follow the last.
        self.marks.resize(area.tile_count() + 1, Marks::default());
    }

    #[inline]
    pub(super) fn get(&self, tile: usize) -> Marks {
        self.marks[tile]
    }

    /// Marks pixels of a row; both ends are included and inside the area.
    #[inline(always)]
    pub(super) fn mark(&mut self, row: i32, first: i32, last: i32, layer: usize) {
        let at = ((row >> 3) * self.across + (first >> 3)) as usize;
        let shift = (row & 7) << 3;
        let more = last - first;
        if more <= 8 {
            let run = ((2u64 << more) - 1) << (first & 7);
            let [low, high] = &mut self.marks[at..at + 2] else { return };
            low.0[layer] |= (run & 0xff) << shift;
            high.0[layer] |= run >> 8 << shift;
        } else {
            self.mark_long(at, shift, (first, last), layer);
        }
    }

    /// Whether all pixels of the tiles with some rows and columns are marked, ends included and
    /// inside the area.
    pub(super) fn are_marked(&self, rows: (i32, i32), columns: (i32, i32), layer: usize) -> bool {
        let row = |ty: i32| {
            let first = ty * self.across;
            &self.marks[(first + (columns.0 >> 3)) as usize..=(first + (columns.1 >> 3)) as usize]
        };
        (rows.0 >> 3..=rows.1 >> 3).all(|ty| row(ty).iter().all(|tile| tile.0[layer] == u64::MAX))
    }

    /// Marks pixels of a tile and of the next one, and lets an outline pass rows left of the
    /// middles of some of their pixels.
    #[inline(always)]
    pub(super) fn mark_two(
        &mut self,
        (ty, tx): (i32, i32),
        touched: [u64; 2],
        layer: usize,
        passed: [u64; 2],
        falls: bool,
    ) {
        let at = (ty * self.across + tx) as usize;
        let Some(tiles) = self.marks.get_mut(at..at + 2) else { return };
        for ((tile, touched), passed) in tiles.iter_mut().zip(touched).zip(passed) {
            tile.0[layer & 1] |= touched;
            tile.wind(passed, if falls { passed } else { 0 });
        }
    }

    /// Marks a run of pixels that may reach over more than two tiles; the first is given.
    fn mark_long(&mut self, at: usize, shift: i32, (first, last): (i32, i32), layer: usize) {
        let tiles = &mut self.marks[at..=at + ((last >> 3) - (first >> 3)) as usize];
        let (low, high) = (0xffu64 << (first & 7) & 0xff, 0xffu64 >> (7 - (last & 7)));
        if let [only] = tiles {
            only.0[layer] |= (low & high) << shift;
        } else if let [begin, between @ .., end] = tiles {
            begin.0[layer] |= low << shift;
            between.iter_mut().for_each(|tile| tile.0[layer] |= 0xff << shift);
            end.0[layer] |= high << shift;
        }
    }

    /// Lets an outline pass the middle of a row left of the middle of a column: the winding numbers
    /// from there on grow by one, or fall.
    #[inline(always)]
    pub(super) fn pass(&mut self, row: i32, column: i32, falls: bool) {
        let at = ((row >> 3) * self.across + (column >> 3)) as usize;
        let one = 1 << (((row & 7) << 3) + (column & 7));
        self.marks[at].wind(one, if falls { one } else { 0 });
    }

    /// Turns the places where outlines pass into winding numbers.
    pub(super) fn finish(&mut self) {
        let across = (self.across as usize).max(1);
        let tiles = self.marks.len().saturating_sub(1);
        for row in self.marks[..tiles].chunks_exact_mut(across) {
            let mut before = (0, 0);
            for tile in row {
                let [_, _, ones, twos] = &mut tile.0;
                if *ones | *twos == 0 {
                    // No outline passes.
                    (*ones, *twos) = before;
                } else {
                    tile.sum_rows(before);
                    before = tile.last();
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_the_sums_of_the_steps_before_them() {
        let mut state = 3u32;
        let mut next = |n: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % n
        };
        let area = Area { x: 8, y: 16, nx: 3, ny: 2 };
        let mut tiles = TileMarks::default();
        for _ in 0..200 {
            tiles.clear(&area);
            let mut expected = [[0; 24]; 16];
            for _ in 0..next(90) {
                let (row, column, falls) = (next(16), next(24), next(2) == 0);
                tiles.pass(row as i32, column as i32, falls);
                let right = &mut expected[row as usize][column as usize..];
                right.iter_mut().for_each(|w| *w += if falls { -1 } else { 1 });
            }
            tiles.finish();
            for (row, pixels) in expected.iter().enumerate() {
                for (column, winding) in pixels.iter().enumerate() {
                    let tile = tiles.get(row / 8 * 3 + column / 8);
                    assert_eq!(tile.winding((row % 8 * 8 + column % 8) as u32), winding & 3);
                }
            }
        }
    }

    #[test]
    fn runs_of_pixels_are_marked() {
        let area = Area { x: 0, y: 0, nx: 4, ny: 1 };
        let mut tiles = TileMarks::default();
        for first in 0..32 {
            for last in first..32 {
                tiles.clear(&area);
                tiles.mark(5, first, last, Marks::SEAM);
                for row in 0..8 {
                    for column in 0..32 {
                        let marked =
                            tiles.get(column as usize / 8).has(Marks::SEAM, (row * 8 + column % 8) as u32);
                        assert_eq!(marked, row == 5 && (first..=last).contains(&column), "{first} {last}");
                    }
                }
            }
        }
    }
}
