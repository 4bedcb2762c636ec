//! Rows of bits, read a word at a time, from the left or from the right.

use crate::bits::{BitGrid, first_set, last_set};

/// A row of bits as an octant sees it: column 0 is the first one, or the last one if `MIRROR`.
#[derive(Clone, Copy)]
pub(super) struct Row<'a, const MIRROR: bool> {
    /// Bits beyond the width are clear.
    words: &'a [u64],
    width: usize,
}

impl<'a, const MIRROR: bool> Row<'a, MIRROR> {
    /// A row of some tiles, counted from the last one if `flip_y`.
    pub fn new(tiles: &'a BitGrid, row: usize, flip_y: bool) -> Self {
        let y = if flip_y { tiles.height() - 1 - row as u32 } else { row as u32 };
        Self { words: tiles.row(y), width: tiles.width() as usize }
    }

    /// The first column in `from..end` whose bit is set; `end` if there is none. `from < end <=
    /// width`.
    #[inline(always)]
    pub fn next_set(self, from: usize, end: usize) -> usize {
        self.next(from, end, |at| self.words[at])
    }

    /// The first column in `from..end` whose bit is clear; `end` if there is none. `from < end <=
    /// width`.
    #[inline(always)]
    pub fn next_clear(self, from: usize, end: usize) -> usize {
        self.next(from, end, |at| !self.words[at])
    }

    /// The first column whose bit is set in the words of a function.
    #[inline(always)]
    fn next(self, from: usize, end: usize, word_at: impl Fn(usize) -> u64) -> usize {
        if MIRROR {
            let found = last_set(self.width - end, self.width - from, word_at);
            found.map_or(end, |found| self.width - 1 - found)
        } else {
            first_set(from, end, word_at)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both directions against single bits.
    #[test]
    fn words_agree_with_single_bits() {
        let words = [0x8000_0000_0000_0001_u64, 0, u64::MAX, 0x0ff0_0000_0000_0180];
        for width in [1, 63, 64, 65, 130, 200, 256_usize] {
            let mut words = words;
            for x in width..256 {
                words[x / 64] &= !(1 << (x % 64));
            }
            let bit = |x: usize| words[x / 64] >> (x % 64) & 1 == 1;
            for from in 0..width {
                for end in from + 1..=width {
                    let plain = Row::<false> { words: &words, width };
                    let turned = Row::<true> { words: &words, width };
                    let first = |wanted: bool, at: &dyn Fn(usize) -> usize| {
                        (from..end).find(|&t| bit(at(t)) == wanted).unwrap_or(end)
                    };
                    let mirror = |t: usize| width - 1 - t;
                    assert_eq!(plain.next_set(from, end), first(true, &|t| t));
                    assert_eq!(plain.next_clear(from, end), first(false, &|t| t));
                    assert_eq!(turned.next_set(from, end), first(true, &mirror));
                    assert_eq!(turned.next_clear(from, end), first(false, &mirror));
                }
            }
        }
    }
}
