//! Which blocks of an area are in use: those around a long, slanted patch mostly are not.

use std::ops::Range;

use crate::occlusion::surface::raster::Area;

/// Areas of no more blocks are in use as a whole: to ask for each edge would cost more.
pub(crate) const FEW: usize = 8;

/// No block of a row.
const NONE: (usize, usize) = (usize::MAX, 0);

/// The blocks in use, row by row: those from one up to before another.
#[derive(Debug, Clone, Default)]
pub(crate) struct Spans {
    rows: Vec<(usize, usize)>,
    across: usize,
}

impl Spans {
    /// Begins with another area. Returns the blocks to be cleared.
    #[inline(always)]
    pub(crate) fn begin(&mut self, area: &Area) -> Range<usize> {
        let count = area.block_count();
        self.across = area.nx as usize;
        let (row, clear) = if count <= FEW { ((0, self.across), 0..count) } else { (NONE, 0..0) };
        self.rows.clear();
        self.rows.resize(area.ny as usize, row);
        clear
    }

    /// Takes blocks of a row into use, and those between them and others. Returns the blocks to be
    /// cleared: two ranges, which are empty mostly.
    #[inline(always)]
    pub(crate) fn take(&mut self, row: usize, from: usize, to: usize) -> [Range<usize>; 2] {
        match self.rows.get(row) {
            Some(&(first, end)) if from < first || to > end => self.grow(row, from, to.min(self.across)),
            _ => [0..0, 0..0],
        }
    }

    #[cold]
    fn grow(&mut self, row: usize, from: usize, to: usize) -> [Range<usize>; 2] {
        let (first, end) = self.rows[row];
        let all = (from.min(first), to.max(end));
        self.rows[row] = all;
        let start = row * self.across;
        if (first, end) == NONE {
            return [start + all.0..start + all.1, 0..0];
        }
        [start + all.0..start + first, start + end..start + all.1]
    }

    /// The blocks in use of a row, as columns.
    #[inline(always)]
    pub(crate) fn columns(&self, row: usize) -> Range<usize> {
        let (first, end) = self.rows[row];
        first..end
    }

    /// The blocks in use by row and column, row by row.
    #[inline(always)]
    pub(crate) fn blocks(&self) -> impl Iterator<Item = (usize, usize)> {
        let rows = self.rows.iter().enumerate();
        rows.flat_map(|(row, &(first, end))| (first..end).map(move |column| (row, column)))
    }

    /// Whether a block is in use, by its place in the area.
    #[inline(always)]
    pub(crate) fn has(&self, block: usize) -> bool {
        let across = self.across.max(1);
        self.rows.get(block / across).is_some_and(|&(first, end)| (first..end).contains(&(block % across)))
    }

    /// How many blocks are in use.
    #[inline(always)]
    pub(crate) fn count(&self) -> usize {
        self.rows.iter().map(|&(first, end)| end.saturating_sub(first)).sum()
    }
}
