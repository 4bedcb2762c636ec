//! Rows of bits, read a word at a time, from the left or from the right.

/// The number of bits of a word.
const WORD: usize = u64::BITS as usize;

/// A row of bits as an octant sees it: column 0 is the first one, or the last one if `MIRROR`.
#[derive(Clone, Copy)]
pub(super) struct Row<'a, const MIRROR: bool> {
    /// Bits beyond the width are clear.
    pub words: &'a [u64],
    pub width: usize,
}

impl<const MIRROR: bool> Row<'_, MIRROR> {
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
            let (first, last) = (self.width - end, self.width - 1 - from);
            let mut at = last / WORD;
            let mut word = word_at(at) & (u64::MAX >> (WORD - 1 - last % WORD));
            loop {
                if word != 0 {
                    let found = at * WORD + (WORD - 1 - word.leading_zeros() as usize);
                    return (self.width - 1 - found).min(end);
                }
                if at * WORD <= first {
                    return end;
                }
                at -= 1;
                word = word_at(at);
            }
        } else {
            let mut at = from / WORD;
            let mut word = word_at(at) & (u64::MAX << (from % WORD));
            loop {
                if word != 0 {
                    return (at * WORD + word.trailing_zeros() as usize).min(end);
                }
                at += 1;
                if at * WORD >= end {
                    return end;
                }
                word = word_at(at);
            }
        }
    }
}

/// Sets the bits `first..end` of a row. `first < end`, and the row has that many bits.
#[inline(always)]
pub(super) fn fill(words: &mut [u64], first: usize, end: usize) {
    let (low, high) = (first / WORD, (end - 1) / WORD);
    let from = u64::MAX << (first % WORD);
    let to = u64::MAX >> (WORD - 1 - (end - 1) % WORD);
    if low == high {
        words[low] |= from & to;
        return;
    }
    words[low] |= from;
    words[low + 1..high].fill(u64::MAX);
    words[high] |= to;
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
                words[x / WORD] &= !(1 << (x % WORD));
            }
            let bit = |x: usize| words[x / WORD] >> (x % WORD) & 1 == 1;
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
