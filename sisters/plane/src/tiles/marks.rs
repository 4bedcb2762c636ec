//! Bits that are few, and cleared in as little time.

use std::ops::Range;

use crate::bits::BitGrid;

/// Tiles that are marked, and the columns and rows that hold them.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Marks {
    pub bits: BitGrid,
    pub columns: Range<u32>,
    pub rows: Range<u32>,
}

impl Marks {
    /// Clears all marks. There is one for each bit of `like` then.
    pub fn clear(&mut self, like: &BitGrid) {
        if (self.bits.width(), self.bits.height()) != (like.width(), like.height()) {
            self.bits = BitGrid::new(like.width(), like.height());
        } else if !self.columns.is_empty() {
            let words = self.columns.start as usize / 64..(self.columns.end as usize).div_ceil(64);
            for y in self.rows.clone() {
                self.bits.row_mut(y)[words.clone()].fill(0);
            }
        }
        (self.columns, self.rows) = (0..0, 0..0);
    }

    /// Marks lie in these columns and rows, too.
    pub fn widen(&mut self, columns: Range<u32>, rows: Range<u32>) {
        let union = |a: &Range<u32>, b: Range<u32>| match a.is_empty() {
            true => b,
            false => a.start.min(b.start)..a.end.max(b.end),
        };
        if !columns.is_empty() && !rows.is_empty() {
            self.columns = union(&self.columns, columns);
            self.rows = union(&self.rows, rows);
        }
    }
}
