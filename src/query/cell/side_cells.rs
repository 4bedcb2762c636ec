//! The cells of one side of a shell, in bands of eight rows: bands where the grid contains nothing
//! are passed over, and written later if cells around them block.

use crate::grid::cell_box::CellBox;
use crate::grid::side::Side;
use crate::walk::{Shells, SideFrustum};

/// The cells of one side of a shell, by whether they block.
#[derive(Debug, Clone, Default)]
pub(crate) struct SideCells {
    /// First row and column of the part of the side where there is anything, relative to V.
    pub(super) row0: i32,
    pub(super) col0: i32,
    pub(super) rows: i32,
    pub(super) cols: i32,
    /// Words in a row.
    pub(super) words: usize,
    /// The bit of column `col0` in a row.
    pub(super) offset: usize,
    /// For each row, whether it has opaque cells that are not hidden.
    pub(super) fresh: Vec<bool>,
    /// Cells that do not block: inside the frustum, not hidden and not opaque. Bit
    /// `col - col0 + offset` of a row. Eight rows for each band that was not passed over.
    open: Vec<u64>,
    /// Rows of the first band that come before `row0`.
    before: usize,
    /// Where each band is in `open`, counted in bands, or [`PASSED_OVER`].
    bands: Vec<u32>,
    /// The place of a band in which all cells block, which hidden ones share.
    hidden: Option<u32>,
    /// About where a band that was passed over was last seen: a share of the rows.
    pub(super) seen_at: f64,
}

/// A band that was passed over, because the grid contains nothing there.
const PASSED_OVER: u32 = u32::MAX;

impl SideCells {
    /// Leaves no cells.
    pub(super) fn clear(&mut self) {
        self.rows = 0;
        self.fresh.clear();
        self.hidden = None;
    }

    /// Prepares the cells of a side; `None` if the frustum reaches no cell of it.
    pub(super) fn begin(&mut self, side: &Side, depth: i32, shells: &Shells) -> Option<SideFrustum> {
        self.clear();
        let (axes, v, m) = (side.axes, shells.cell, depth.abs());
        let CellBox { lo, hi } = shells.extent;
        let span = |axis: usize| ((lo[axis] - v[axis]).max(-m), (hi[axis] - v[axis]).min(m));
        let (rows, cols) = (span(axes.row), span(axes.col));
        if !(lo[axes.normal]..=hi[axes.normal]).contains(&(v[axes.normal] + depth))
            || rows.0 > rows.1
            || cols.0 > cols.1
            || !shells.frustum.meets(side.cell(depth, rows.0, cols.0), side.cell(depth, rows.1, cols.1))
        {
            return None;
        }
        self.set_part(rows, cols, (v[axes.row] + rows.0, v[axes.col] + cols.0));
        Some(shells.frustum.on_side(side, depth))
    }

    /// Sets the rows and columns, relative to V, and the place of the first ones. All
    /// bands are passed over.
    pub(super) fn set_part(&mut self, rows: (i32, i32), cols: (i32, i32), place: (i32, i32)) {
        (self.row0, self.rows) = (rows.0, rows.1 - rows.0 + 1);
        (self.col0, self.cols) = (cols.0, cols.1 - cols.0 + 1);
        // Columns are addressed by their place in the grid, so that tiles fall on bytes.
        self.words = (((place.1 + cols.1 - cols.0) >> 6) - (place.1 >> 6)) as usize + 1;
        self.offset = (place.1 & 63) as usize;
        self.before = (place.0 & 7) as usize;
        self.open.clear();
        self.bands.clear();
        self.bands.resize((self.before + self.rows as usize).div_ceil(8), PASSED_OVER);
    }

    /// The first and the last column, relative to V.
    pub(super) fn columns(&self) -> (i32, i32) {
        (self.col0, self.col0 + self.cols - 1)
    }

    /// The bit of column 0 in a row.
    pub(super) fn base(&self) -> i32 {
        self.offset as i32 - self.col0
    }

    /// Number of bands.
    pub(super) fn bands(&self) -> usize {
        self.bands.len()
    }

    /// The rows of a band, relative to V.
    pub(super) fn rows_of_band(&self, band: usize) -> (i32, i32) {
        let top = self.row0 - self.before as i32 + 8 * band as i32;
        (top.max(self.row0), (top + 7).min(self.row0 + self.rows - 1))
    }

    /// Whether some band was passed over whose rows are seen.
    pub(super) fn sees_passed_over(&mut self, sees: impl Fn((i32, i32)) -> bool) -> bool {
        if self.rows == 0 || !self.bands.contains(&PASSED_OVER) {
            return false;
        }
        let bands = self.bands.len();
        let band_sees = |&band: &usize| self.bands[band] == PASSED_OVER && sees(self.rows_of_band(band));
        // First near the place where one was seen before.
        let likely = ((self.seen_at * bands as f64) as usize).min(bands - 1);
        let found = std::iter::once(likely).chain(0..bands).find(band_sees);
        self.seen_at = found.map_or(self.seen_at, |band| (band as f64 + 0.5) / bands as f64);
        found.is_some()
    }

    /// Makes a band of cells that all block.
    pub(super) fn hide_band(&mut self, band: usize) {
        match self.hidden {
            Some(shared) => self.bands[band] = shared,
            None => {
                self.make_band(band);
                self.hidden = Some(self.bands[band]);
            }
        }
    }

    /// Appends a band of eight rows, and returns it.
    pub(super) fn make_band(&mut self, band: usize) -> &mut [u64] {
        let size = 8 * self.words;
        let at = self.open.len();
        self.bands[band] = (at / size) as u32;
        self.open.resize(at + size, 0);
        &mut self.open[at..]
    }

    /// Sets which of the eight rows of a band have opaque cells that are not hidden.
    pub(super) fn set_fresh(&mut self, band: usize, fresh: u8) {
        self.fresh.resize(self.rows as usize, false);
        let first = (8 * band).saturating_sub(self.before);
        let skip = if band == 0 { self.before } else { 0 };
        self.fresh[first..].iter_mut().zip(skip..8).for_each(|(row, i)| *row = fresh >> i & 1 != 0);
    }

    /// Makes the bands that were passed over around rows with fresh occluders, no more than
    /// `spread` rows away. `write` is called with each of their rows, to set bits of it.
    pub(super) fn complete(&mut self, spread: usize, mut write: impl FnMut(i32, &mut [u64])) {
        let rows = self.rows as usize;
        // The rows before this one are complete.
        let mut done = 0;
        for r in 0..rows {
            if !self.fresh[r] {
                continue;
            }
            let first = r.saturating_sub(spread).max(done);
            done = (r + spread + 1).min(rows);
            if first >= done {
                continue;
            }
            for band in (first + self.before) >> 3..=(done - 1 + self.before) >> 3 {
                if self.bands[band] != PASSED_OVER {
                    continue;
                }
                let (top, last) = self.rows_of_band(band);
                let (words, skip) = (self.words, if band == 0 { self.before } else { 0 });
                let open = self.make_band(band);
                (top..=last)
                    .zip(open[skip * words..].chunks_mut(words))
                    .for_each(|(row, line)| write(row, line));
            }
        }
    }

    /// The cells of row `row0 + r` that do not block; `None` if its band was passed over.
    pub(super) fn line(&self, r: usize) -> Option<&[u64]> {
        let at = r + self.before;
        let band = self.bands[at >> 3];
        let first = (band as usize * 8 + (at & 7)) * self.words;
        (band != PASSED_OVER).then(|| &self.open[first..first + self.words])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_found_in_the_bands_that_were_made() {
        let mut cells = SideCells::default();
        // Two words in a row, and three rows of the first band before the first.
        cells.set_part((0, 19), (0, 69), (3, 0));
        assert_eq!((cells.bands(), cells.words), (3, 2));
        cells.make_band(2)[0] = 5;
        let band = cells.make_band(0);
        assert_eq!(band.len(), 16);
        // Row 1 is the fifth of the first band.
        band[4 * 2 + 1] = 9;
        assert_eq!(cells.line(1), Some(&[0, 9][..]));
        assert_eq!(cells.line(13), Some(&[5, 0][..]));
        assert_eq!(cells.line(7), None);
        cells.hide_band(1);
        assert_eq!((cells.line(7), cells.open.len()), (Some(&[0, 0][..]), 48));
    }
}
