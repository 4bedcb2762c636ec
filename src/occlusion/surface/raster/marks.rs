//! Marks of pixels, in blocks of 32x8.

use fearless_simd::prelude::*;
use fearless_simd::u32x8;

use crate::occlusion::surface::raster::area::TILES;
use crate::occlusion::surface::raster::edges::{LANES, each};
use crate::occlusion::tiles::TILE;

/// Eight rows of pixels, a word for each; bit i is column i.
pub(crate) type PixelRows = [u32; LANES];

const _: () = assert!(LANES as i64 == TILE, "a block is one row of tiles");

/// The pixels of a row from a column on: none from column 32 on.
#[inline(always)]
pub(crate) fn from_column(column: i32) -> u32 {
    // A shift by 32 is two by half as much.
    (u32::MAX << (column >> 1)) << ((column + 1) >> 1)
}

/// The pixels of a tile's eight rows, tile by tile.
#[inline(always)]
pub(crate) fn tiles(rows: &PixelRows) -> [u64; TILES] {
    let bytes = rows.map(u32::to_le_bytes);
    std::array::from_fn(|tile| u64::from_le_bytes(std::array::from_fn(|row| bytes[row][tile])))
}

/// A winding number modulo four for each bit of a word: its two digits.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Windings {
    pub(crate) ones: u32,
    pub(crate) twos: u32,
}

impl Windings {
    #[inline(always)]
    pub(crate) fn is_zero(&self) -> bool {
        self.ones | self.twos == 0
    }

    /// The numbers of eight bits from one on.
    #[inline(always)]
    pub(crate) fn rows(&self, first: usize) -> Head {
        Head(self.ones >> first & 0xff | (self.twos >> first & 0xff) << 8)
    }

    /// Adds other numbers.
    #[inline(always)]
    pub(crate) fn add(&mut self, other: Self) {
        self.twos ^= other.twos ^ (self.ones & other.ones);
        self.ones ^= other.ones;
    }

    /// Adds one to the numbers of some bits, or takes it off.
    #[inline(always)]
    pub(crate) fn step(&mut self, bits: u32, falls: bool) {
        self.add(Self { ones: bits, twos: if falls { bits } else { 0 } });
    }
}

/// What is known of a block beside its marks: kept apart, so that blocks that nothing touches cost
/// no more than this. The winding numbers to add to it and to all blocks right of it, by row: a
/// byte of ones, and one of twos; above them, whether the block has marks.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Head(u32);

impl Head {
    const MARKED: u32 = 1 << 16;

    /// One in some of eight rows, or minus one if all bits of `falls` are set.
    #[inline(always)]
    pub(super) fn step(rows: u32, falls: u32) -> Self {
        Self(rows | (rows & falls) << 8)
    }

    #[inline(always)]
    pub(crate) fn is_marked(self) -> bool {
        self.0 & Self::MARKED != 0
    }

    #[inline(always)]
    pub(super) fn mark(&mut self) {
        self.0 |= Self::MARKED;
    }

    /// Whether no row has a number.
    #[inline(always)]
    pub(crate) fn is_zero(self) -> bool {
        self.0 & 0xffff == 0
    }

    /// Whether all rows have one.
    #[inline(always)]
    pub(crate) fn is_full(self) -> bool {
        (self.0 | self.0 >> 8) & 0xff == 0xff
    }

    /// Adds the numbers of another one.
    #[inline(always)]
    pub(crate) fn add(&mut self, other: Self) {
        let numbers = other.0 & 0xffff;
        self.0 ^= numbers ^ (self.0 & numbers & 0xff) << 8;
    }
}

/// The pixels of a block by layer: touched by open edges; touched by seams; and the two digits of
/// the winding number around the middle, modulo four.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PixelMarks([PixelRows; 4]);

impl PixelMarks {
    pub(crate) const OPEN: usize = 0;
    #[cfg(test)]
    pub(crate) const SEAM: usize = 1;
    /// No marks.
    pub(crate) const NONE: Self = Self([[0; LANES]; 4]);

    /// Marks pixels of all rows in a layer.
    #[inline(always)]
    pub(super) fn mark<S: Simd>(&mut self, layer: usize, rows: u32x8<S>) {
        let own = &mut self.0[layer & 1];
        (u32x8::from_slice(rows.simd, own) | rows).store_slice(own);
    }

    /// Marks pixels of one row in a layer.
    #[inline(always)]
    pub(super) fn mark_row(&mut self, layer: usize, row: usize, pixels: u32) {
        self.0[layer & 1][row % LANES] |= pixels;
    }

    /// Adds one to the winding numbers of some pixels, or takes it off if all bits of `falls` are
    /// set.
    #[inline(always)]
    pub(super) fn wind<S: Simd>(&mut self, rows: u32x8<S>, falls: u32x8<S>) {
        let [_, _, ones, twos] = &mut self.0;
        let (one, two) = (u32x8::from_slice(rows.simd, ones), u32x8::from_slice(rows.simd, twos));
        (two ^ (rows & (one ^ falls))).store_slice(twos);
        (one ^ rows).store_slice(ones);
    }

    /// As [`PixelMarks::wind`], in one row.
    #[inline(always)]
    pub(super) fn wind_row(&mut self, row: usize, pixels: u32, falls: u32) {
        let [_, _, ones, twos] = &mut self.0;
        let (one, two) = (&mut ones[row % LANES], &mut twos[row % LANES]);
        *two ^= pixels & (*one ^ falls);
        *one ^= pixels;
    }

    /// These with the winding numbers of edges left of the block.
    #[inline(always)]
    pub(crate) fn passed(mut self, Head(passed): Head) -> Self {
        let [_, _, ones, twos] = &mut self.0;
        let spread = |word: u32| -> PixelRows { each(|k| 0u32.wrapping_sub(word >> k & 1)) };
        let (one, two) = (spread(passed), spread(passed >> 8));
        *twos = each(|k| twos[k] ^ two[k] ^ (ones[k] & one[k]));
        *ones = each(|k| ones[k] ^ one[k]);
        self
    }

    /// Adds the marks of another patch.
    #[inline(always)]
    pub(crate) fn add(&mut self, other: &Self) {
        let ([open, seam, ones, twos], [more_open, more_seam, one, two]) = (&mut self.0, &other.0);
        *open = each(|k| open[k] | more_open[k]);
        *seam = each(|k| seam[k] | more_seam[k]);
        *twos = each(|k| twos[k] ^ two[k] ^ (ones[k] & one[k]));
        *ones = each(|k| ones[k] ^ one[k]);
    }

    /// The pixels touched by open edges.
    #[inline(always)]
    pub(crate) fn open(&self) -> &PixelRows {
        &self.0[Self::OPEN]
    }

    /// The pixels that the outline covers as a whole.
    #[inline(always)]
    pub(crate) fn covered(&self) -> PixelRows {
        let [open, seam, ones, twos] = &self.0;
        each(|k| (ones[k] | twos[k]) & !(open[k] | seam[k]))
    }

    /// Of the marks of several patches: the pixels touched by seams only that the patches cover
    /// together. Their winding numbers do not sum to zero.
    #[inline(always)]
    pub(crate) fn covered_seams(&self) -> PixelRows {
        let [open, seam, ones, twos] = &self.0;
        each(|k| seam[k] & (ones[k] | twos[k]) & !open[k])
    }

    /// The columns in which any row has marks.
    #[inline(always)]
    pub(crate) fn marked_columns(&self) -> u32 {
        let [open, seam, ones, twos] = &self.0;
        let any: PixelRows = each(|k| (open[k] | seam[k]) | (ones[k] | twos[k]));
        any.iter().fold(0, |all, row| all | row)
    }

    /// Whether a pixel is marked in a layer, and its winding number modulo four.
    #[cfg(test)]
    pub(crate) fn pixel(&self, layer: usize, row: usize, column: usize) -> (bool, i32) {
        let bit = |layer: usize| self.0[layer][row] >> column & 1;
        (bit(layer) == 1, (bit(2) + 2 * bit(3)) as i32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::simd::vectorized;

    #[test]
    fn tiles_are_columns_of_bytes() {
        let rows: PixelRows = each(|k| 0x0403_0201 * (k as u32 + 1));
        let words = tiles(&rows);
        for (tile, word) in words.into_iter().enumerate() {
            for (row, byte) in word.to_le_bytes().into_iter().enumerate() {
                assert_eq!(usize::from(byte), (tile + 1) * (row + 1));
            }
        }
        assert_eq!((from_column(0), from_column(31), from_column(32)), (u32::MAX, 1 << 31, 0));
    }

    #[test]
    fn numbers_are_sums_of_steps() {
        let mut random = Random::new(3);
        for _ in 0..200 {
            let (mut marks, mut other, mut expected) =
                (PixelMarks::default(), PixelMarks::default(), [[0i32; 32]; 8]);
            for _ in 0..30 {
                let mut upto = |n: f64| random.within(0.0, n) as usize;
                let (row, column, falls) = (upto(8.0), upto(32.0), upto(2.0) == 0);
                let (by, all) = if falls { (-1, u32::MAX) } else { (1, 0) };
                let whole = from_column(column as i32);
                let target = if upto(2.0) == 0 { &mut marks } else { &mut other };
                let rows = match upto(3.0) {
                    0 => {
                        target.wind_row(row, whole, all);
                        expected[row][column..].iter_mut().for_each(|w| *w += by);
                        continue;
                    }
                    1 => {
                        let rows: PixelRows = each(|k| if k >= row { whole } else { 0 });
                        vectorized!(simd => {
                            target.wind(u32x8::from_slice(simd, &rows), u32x8::splat(simd, all));
                        });
                        &mut expected[row..]
                    }
                    _ => {
                        let mut passed = Windings::default();
                        passed.step(1 << (row + 5), falls);
                        *target = target.passed(passed.rows(5));
                        expected[row].iter_mut().for_each(|w| *w += by);
                        continue;
                    }
                };
                rows.iter_mut().for_each(|row| row[column..].iter_mut().for_each(|w| *w += by));
            }
            marks.add(&other);
            for (row, numbers) in expected.iter().enumerate() {
                for (column, number) in numbers.iter().enumerate() {
                    assert_eq!(marks.pixel(PixelMarks::OPEN, row, column), (false, number & 3));
                }
            }
        }
    }
}
