//! The slices of a column.

use crate::numeric::GROUP;
use crate::view::View;

/// The groups of the longest column.
pub(crate) const MOST_GROUPS: usize = (256 / GROUP) as usize;
// A group must not lie in two words.
const _: () = assert!(128 % GROUP == 0);

/// The number of slices of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Slices {
    /// 128, one word.
    #[default]
    S128,
    /// 256, two words.
    S256,
}

impl Slices {
    /// The number of slices.
    pub fn count(self) -> u32 {
        self.words() as u32 * 128
    }

    /// The words of a column.
    pub(crate) fn words(self) -> usize {
        if self == Self::S128 { 1 } else { 2 }
    }

    /// The groups of [`GROUP`] slices of a column.
    pub fn groups(self) -> usize {
        (self.count() / GROUP) as usize
    }
}

/// The words with the slices `first` to `last` set, both inclusive; `word` is the first or second
/// 128 of them.
pub(crate) fn mask(first: u32, last: u32, word: u32) -> u128 {
    let (base, top) = (word * 128, word * 128 + 127);
    if first > top || last < base || first > last {
        return 0;
    }
    let (first, last) = (first.max(base) - base, last.min(top) - base);
    (u128::MAX << first) & (u128::MAX >> (127 - last))
}

/// The slice of a depth, clamped to those that there are.
pub(crate) fn slice_of(view: &View, slices: Slices, depth: f64) -> u32 {
    let [near, far] = view.depths();
    let count = f64::from(slices.count());
    // Conversion saturates.
    (((depth - near) / (far - near) * count) as u32).min(slices.count() - 1)
}

/// Adds the length of a line between two depths, the lesser one first, to the groups of slices, by
/// their shares of the way.
pub(crate) fn spread(view: &View, slices: Slices, [from, to]: [f64; 2], length: f64, lengths: &mut [f32]) {
    // Absurd coordinates give places that are no numbers.
    if !length.is_finite() {
        return;
    }
    let [near, far] = view.depths();
    let [first, last] = [from, to].map(|d| slice_of(view, slices, d) / GROUP);
    let group = (far - near) / slices.groups() as f64;
    let mut left = length;
    for i in first..last {
        let end = near + group * f64::from(i + 1);
        let part = (length * (end - from.max(end - group)) / (to - from)).max(0.0).min(left);
        lengths[i as usize] += part as f32;
        left -= part;
    }
    lengths[last as usize] += left as f32;
}
