//! The cells of one side of a shell.

/// The cells of one side of a shell, by whether they block.
#[derive(Debug, Clone, Default)]
pub(crate) struct SideCells {
    /// First row and column of the grid's part of the side, relative to V.
    pub(crate) row0: i32,
    pub(crate) col0: i32,
    pub(crate) rows: i32,
    pub(crate) cols: i32,
    /// Words in a row.
    pub(crate) words: usize,
    /// Cells that do not block: inside the frustum, not hidden and not opaque. Bit
    /// `col - col0 + offset` of a row. Eight rows for each band that was not passed over.
    pub(crate) open: Vec<u64>,
    pub(crate) offset: usize,
    /// Rows of the first band that come before `row0`.
    pub(crate) before: usize,
    /// Where each band is in `open`, counted in bands, or [`PASSED_OVER`].
    pub(crate) bands: Vec<u32>,
    /// The place of a band in which all cells block, which hidden ones share.
    pub(crate) hidden: Option<u32>,
    /// For each row, whether it has opaque cells that are not hidden.
    pub(crate) fresh: Vec<bool>,
}

/// A band that was passed over, because the grid contains nothing there.
pub(crate) const PASSED_OVER: u32 = u32::MAX;

impl SideCells {
    /// Leaves no cells.
    pub(crate) fn clear(&mut self) {
        self.rows = 0;
        self.fresh.clear();
        self.hidden = None;
    }

    /// Makes a band of cells that all block.
    pub(crate) fn hide_band(&mut self, band: usize) {
        match self.hidden {
            Some(shared) => self.bands[band] = shared,
            None => {
                self.make_band(band);
                self.hidden = Some(self.bands[band]);
            }
        }
    }

    /// Appends a band of eight rows, and returns it.
    pub(crate) fn make_band(&mut self, band: usize) -> &mut [u64] {
        let size = 8 * self.words;
        let at = self.open.len();
        self.bands[band] = (at / size) as u32;
        self.open.resize(at + size, 0);
        &mut self.open[at..]
    }

    /// The cells of row `row0 + r` that do not block; `None` if its band was passed over.
    pub(crate) fn line(&self, r: usize) -> Option<&[u64]> {
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
        let mut cells = SideCells { rows: 20, words: 2, before: 3, ..SideCells::default() };
        cells.bands = vec![PASSED_OVER; 3];
        cells.make_band(2)[0] = 5;
        let band = cells.make_band(0);
        assert_eq!(band.len(), 16);
        // Row 1 is the fifth of the first band, since three rows come before the first.
        band[4 * 2 + 1] = 9;
        assert_eq!(cells.line(1), Some(&[0, 9][..]));
        assert_eq!(cells.line(13), Some(&[5, 0][..]));
        assert_eq!(cells.line(7), None);
        cells.hide_band(1);
        assert_eq!((cells.line(7), cells.open.len()), (Some(&[0, 0][..]), 48));
    }
}
