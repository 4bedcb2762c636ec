//! A bit for each cell of a grid, in packed rows.

use std::ops::Range;

use glam::UVec2;

/// The number of bits of a word.
const WORD: u32 = u64::BITS;
const BITS: usize = u64::BITS as usize;

/// A bit for each cell of a grid: rows of 64-bit words, each of which begins with a new word.
///
/// Cells are `(x, y)`, from `(0, 0)`. Cells outside of the grid are clear and stay so.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct BitGrid {
    width: u32,
    height: u32,
    /// Words of a row.
    stride: usize,
    words: Vec<u64>,
}

impl BitGrid {
    /// A grid of clear bits. Costs `width * height / 8` bytes, at least 8 a row.
    pub fn new(width: u32, height: u32) -> Self {
        let stride = width.div_ceil(WORD) as usize;
        Self { width, height, stride, words: vec![0; stride * height as usize] }
    }

    /// The number of cells of a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// The number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Whether the bit of a cell is set.
    pub fn get(&self, x: u32, y: u32) -> bool {
        x < self.width && y < self.height && self.row(y)[(x / WORD) as usize] >> (x % WORD) & 1 == 1
    }

    /// Sets or clears the bit of a cell.
    pub fn set(&mut self, x: u32, y: u32, value: bool) {
        if x < self.width && y < self.height {
            let word = &mut self.words[y as usize * self.stride + (x / WORD) as usize];
            *word = *word & !(1 << (x % WORD)) | u64::from(value) << (x % WORD);
        }
    }

    /// Sets the bits of some cells of a row.
    pub fn fill(&mut self, y: u32, cells: Range<u32>) {
        let (first, end) = (cells.start, cells.end.min(self.width));
        if y >= self.height || first >= end {
            return;
        }
        fill(self.row_mut(y), first as usize, end as usize);
    }

    /// The words of a row: cell `x` is bit `x % 64` of word `x / 64`. Bits beyond the width are
    /// clear.
    pub fn row(&self, y: u32) -> &[u64] {
        let first = y as usize * self.stride;
        self.words.get(first..first + self.stride).unwrap_or(&[])
    }

    /// The words of a row, to be changed. Bits beyond the width must stay clear.
    pub(crate) fn row_mut(&mut self, y: u32) -> &mut [u64] {
        let first = y as usize * self.stride;
        self.words.get_mut(first..first + self.stride).unwrap_or(&mut [])
    }

    /// The first cell of a row, from `x` on, whose bit is set; the width if there is none.
    pub fn next_set(&self, x: u32, y: u32) -> u32 {
        self.next(x, y, 0)
    }

    /// The first cell of a row, from `x` on, whose bit is clear; the width if there is none.
    pub fn next_clear(&self, x: u32, y: u32) -> u32 {
        self.next(x, y, u64::MAX)
    }

    /// The first cell whose bit differs from those of `flip`.
    fn next(&self, x: u32, y: u32, flip: u64) -> u32 {
        if x >= self.width || y >= self.height {
            return self.width;
        }
        let row = self.row(y);
        first_set(x as usize, self.width as usize, |at| row[at] ^ flip) as u32
    }

    /// The number of bits that are set.
    pub fn count(&self) -> u64 {
        self.words.iter().map(|word| u64::from(word.count_ones())).sum()
    }

    /// The cells whose bits are set, row by row.
    pub fn cells(&self) -> impl Iterator<Item = (u32, u32)> {
        let rows = if self.width == 0 { 0 } else { self.height };
        (0..rows).flat_map(move |y| {
            let first = Some(self.next_set(0, y)).filter(|&x| x < self.width);
            let next = move |&x: &u32| Some(self.next_set(x + 1, y)).filter(|&x| x < self.width);
            std::iter::successors(first, next).map(move |x| (x, y))
        })
    }
}

/// Sets the bits `first..end` of a row. `first < end`, and the row has that many bits.
#[inline(always)]
pub(crate) fn fill(words: &mut [u64], first: usize, end: usize) {
    let (low, high) = (first / BITS, (end - 1) / BITS);
    let from = u64::MAX << (first % BITS);
    let to = u64::MAX >> (BITS - 1 - (end - 1) % BITS);
    if low == high {
        words[low] |= from & to;
        return;
    }
    words[low] |= from;
    words[low + 1..high].fill(u64::MAX);
    words[high] |= to;
}

/// The first place in `from..end` whose bit is set in the words of a function; `end` if there is
/// none. `from < end`.
#[inline(always)]
pub(crate) fn first_set(from: usize, end: usize, word_at: impl Fn(usize) -> u64) -> usize {
    let mut at = from / BITS;
    let mut word = word_at(at) & (u64::MAX << (from % BITS));
    loop {
        if word != 0 {
            return (at * BITS + word.trailing_zeros() as usize).min(end);
        }
        at += 1;
        if at * BITS >= end {
            return end;
        }
        word = word_at(at);
    }
}

/// The last place in `from..end` whose bit is set in the words of a function. `from < end`.
#[inline(always)]
pub(crate) fn last_set(from: usize, end: usize, word_at: impl Fn(usize) -> u64) -> Option<usize> {
    let mut at = (end - 1) / BITS;
    let mut word = word_at(at) & (u64::MAX >> (BITS - 1 - (end - 1) % BITS));
    loop {
        if word != 0 {
            return Some(at * BITS + BITS - 1 - word.leading_zeros() as usize).filter(|&found| found >= from);
        }
        if at * BITS <= from {
            return None;
        }
        at -= 1;
        word = word_at(at);
    }
}

/// A bit for each cell, stored twice: the sides of a shell are rows and columns, and each is read
/// as packed words.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct CrossBits {
    /// `lines[0]` has the columns of the grid: the cells of equal x. `lines[1]` has its rows.
    lines: [BitGrid; 2],
}

impl CrossBits {
    /// Clear bits. Costs two bits a cell.
    pub(crate) fn new(dims: UVec2) -> Self {
        Self { lines: [BitGrid::new(dims.y, dims.x), BitGrid::new(dims.x, dims.y)] }
    }

    /// Cells outside of the grid stay clear.
    pub(crate) fn set(&mut self, x: u32, y: u32, value: bool) {
        self.lines[0].set(y, x, value);
        self.lines[1].set(x, y, value);
    }

    /// The cells at one place of an axis: the column at an x for axis 0, the row at a y for axis 1.
    pub(crate) fn line(&self, axis: usize, at: u32) -> &[u64] {
        self.lines[axis].row(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_agree_with_single_cells() {
        for width in [1, 63, 64, 65, 200] {
            for (first, end) in
                [(0, 1), (0, 64), (5, 6), (63, 65), (64, 128), (1, 199), (7, 7), (9, 3), (60, 500)]
            {
                let (mut filled, mut single) = (BitGrid::new(width, 3), BitGrid::new(width, 3));
                filled.fill(1, first..end);
                (first..end).for_each(|x| single.set(x, 1, true));
                assert_eq!(filled, single, "{width} {first} {end}");
                let cells: Vec<_> = (0..width).filter(|x| (first..end).contains(x)).map(|x| (x, 1)).collect();
                assert_eq!(filled.cells().collect::<Vec<_>>(), cells);
                assert_eq!(filled.count(), cells.len() as u64);
            }
        }
    }

    #[test]
    fn cells_outside_are_clear_and_stay_so() {
        let mut bits = BitGrid::new(10, 2);
        bits.set(10, 0, true);
        bits.set(0, 2, true);
        bits.fill(7, 0..10);
        bits.fill(0, 8..99);
        assert_eq!((bits.count(), bits.get(9, 0), bits.get(10, 0), bits.get(0, 7)), (2, true, false, false));
        assert_eq!((bits.row(5), bits.next_set(0, 5), BitGrid::new(0, 0).count()), (&[][..], 10, 0));
        assert_eq!((bits.next_set(10, 0), bits.next_clear(8, 0), bits.next_clear(99, 0)), (10, 10, 10));
    }
}
