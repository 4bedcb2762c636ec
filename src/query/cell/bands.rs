//! Bands of eight rows of a side: bands where the grid contains nothing are passed over, and
//! written later if cells around them block.

use glam::IVec3;

use crate::grid::bricks::Pages;
use crate::grid::side::Side;
use crate::query::cell::CellWalk;
use crate::query::cell::shell_scale::ShellScale;
use crate::query::cell::side_cells::{PASSED_OVER, SideCells};
use crate::query::cell::spans::{clear_span, set_span};
use crate::walk::SideFrustum;

/// Bands with more rows of pixels than this are looked at row by row.
const MOST_PIXELS: i64 = 8;

impl CellWalk<'_> {
    /// Prepares the cells of one side of shell `m`; `None` if the frustum reaches no cell of it.
    pub(crate) fn begin_side(&mut self, index: usize, m: i32) -> Option<SideFrustum> {
        let side = Side::ALL[index];
        let axes = side.axes;
        let dims = self.scene.grid().dims();
        let v = self.shells.cell;
        let cells = &mut self.scratch.sides[index];
        cells.clear();
        let depth = m * side.sign;
        let at = v[axes.normal] + depth;
        if !(0..dims[axes.normal]).contains(&at) {
            return None;
        }
        let span = |axis: usize| ((-v[axis]).max(-m), (dims[axis] - 1 - v[axis]).min(m));
        let ((r0, r1), (c0, c1)) = (span(axes.row), span(axes.col));
        if r0 > r1 || c0 > c1 {
            return None;
        }
        if !self.shells.frustum.meets(side.cell(depth, r0, c0), side.cell(depth, r1, c1)) {
            return None;
        }
        // Columns are addressed by their place in the grid, so that tiles fall on bytes.
        let first_word = (v[axes.col] + c0) >> 6;
        cells.row0 = r0;
        cells.col0 = c0;
        cells.rows = r1 - r0 + 1;
        cells.cols = c1 - c0 + 1;
        cells.words = (((v[axes.col] + c1) >> 6) - first_word) as usize + 1;
        cells.offset = (v[axes.col] + c0 - first_word * 64) as usize;
        cells.before = ((v[axes.row] + r0) & 7) as usize;
        cells.open.clear();
        cells.bands.clear();
        cells.bands.resize((cells.before + cells.rows as usize).div_ceil(8), PASSED_OVER);
        Some(self.shells.frustum.on_side(&side, depth))
    }

    /// The rows of a band, relative to V.
    pub(crate) fn rows_of_band(cells: &SideCells, band: usize) -> (i32, i32) {
        let top = cells.row0 - cells.before as i32 + 8 * band as i32;
        (top.max(cells.row0), (top + 7).min(cells.row0 + cells.rows - 1))
    }

    /// Whether a plane of pages contains nothing that a walk looks for.
    pub(crate) fn plane_is_empty(&self, axis: usize, page: IVec3) -> bool {
        let scene = self.scene;
        self.lists.none_in(|pages| pages.plane_is_empty(axis, page))
            && scene.tbv_matrix().pages().plane_is_empty(axis, page)
            && self.opaque.iter().all(|opaque| opaque.pages().plane_is_empty(axis, page))
    }

    /// Whether a row of pages contains nothing that a walk looks for.
    pub(crate) fn row_is_empty(&self, along: usize, page: IVec3) -> bool {
        let scene = self.scene;
        self.lists.none_in(|pages| pages.row_is_empty(along, page))
            && scene.tbv_matrix().pages().row_is_empty(along, page)
            && self.opaque.iter().all(|opaque| opaque.pages().row_is_empty(along, page))
    }

    /// The columns between which rows of a side have cells that are not hidden, as far as the
    /// pixels around all of the rows tell; `None` if they are hidden. Near shells are not looked
    /// at: their rows have many pixels each.
    pub(crate) fn open_part(
        &self,
        index: usize,
        scale: &ShellScale,
        rows: (i32, i32),
        cols: (i32, i32),
    ) -> Option<(i32, i32)> {
        let pixels = (scale.pixel(rows.0), scale.pixel(rows.1));
        if pixels.1 - pixels.0 > MOST_PIXELS {
            return Some(cols);
        }
        let (first, last) =
            self.scratch.masks.open_columns(index, pixels, (scale.pixel(cols.0), scale.pixel(cols.1)))?;
        let part =
            ((scale.line_from(first) as i32).max(cols.0), (scale.line_before(last + 1) as i32).min(cols.1));
        (part.0 <= part.1).then_some(part)
    }

    /// Whether the pages between two columns of a row of bricks contain nothing that a walk looks
    /// for.
    pub(crate) fn pages_are_empty(&self, axis: usize, brick: IVec3, cols: (i32, i32)) -> bool {
        (cols.0 >> 6..=cols.1 >> 6).all(|col| {
            let mut page = brick >> 3i32;
            page[axis] = col;
            self.page_is_empty(page)
        })
    }

    /// Whether a page contains nothing that a walk looks for.
    pub(crate) fn page_is_empty(&self, page: IVec3) -> bool {
        let scene = self.scene;
        self.lists.none_in(|pages| pages.page_is_empty(page))
            && scene.tbv_matrix().pages().page_is_empty(page)
            && self.opaque.iter().all(|opaque| opaque.pages().page_is_empty(page))
    }

    /// Whether some cell in sight is in a band of the side that was passed over.
    pub(crate) fn sees_passed_over(&mut self, index: usize, m: i32, scale: &ShellScale) -> bool {
        let side = Side::ALL[index];
        let cells = &self.scratch.sides[index];
        if cells.rows == 0 || !cells.bands.contains(&PASSED_OVER) {
            return false;
        }
        let depth = m * side.sign;
        let columns = (cells.col0, cells.col0 + cells.cols - 1);
        let on_side = self.shells.frustum.on_side(&side, depth);
        let sees = |row: i32| {
            let Some((lo, hi)) = on_side.row(row, columns) else { return false };
            let mut open = hi - lo + 1;
            self.scratch.masks.hidden_runs(index, scale, row, (lo, hi), |a, b| open -= b - a + 1);
            open > 0
        };
        let band_sees = |band: &usize| {
            let (first, last) = Self::rows_of_band(cells, *band);
            cells.bands[*band] == PASSED_OVER
                && self
                    .shells
                    .frustum
                    .meets(side.cell(depth, first, columns.0), side.cell(depth, last, columns.1))
                && (first..=last).any(sees)
        };
        // First near the place where one was in sight before.
        let likely = ((self.seen_at[index] * cells.bands.len() as f64) as usize).min(cells.bands.len() - 1);
        let found = std::iter::once(likely).chain(0..cells.bands.len()).find(band_sees);
        if let Some(band) = found {
            self.seen_at[index] = (band as f64 + 0.5) / cells.bands.len() as f64;
        }
        found.is_some()
    }

    /// Writes the open cells of bands that were passed over, around the rows with fresh occluders.
    pub(crate) fn complete(&mut self, index: usize, m: i32, scale: &ShellScale) {
        let side = Side::ALL[index];
        let cells = &mut self.scratch.sides[index];
        let (spread, rows) = (scale.spread(), cells.rows as usize);
        let base = cells.offset as i32 - cells.col0;
        let columns = (cells.col0, cells.col0 + cells.cols - 1);
        let on_side = self.shells.frustum.on_side(&side, m * side.sign);
        // The rows before this one are complete.
        let mut done = 0;
        for r in 0..rows {
            if !cells.fresh[r] {
                continue;
            }
            let first = r.saturating_sub(spread).max(done);
            done = (r + spread + 1).min(rows);
            if first >= done {
                continue;
            }
            for band in (first + cells.before) >> 3..=(done - 1 + cells.before) >> 3 {
                if cells.bands[band] != PASSED_OVER {
                    continue;
                }
                let (top, last) = Self::rows_of_band(cells, band);
                let words = cells.words;
                let skip = if band == 0 { cells.before } else { 0 };
                let open = cells.make_band(band);
                for (row, line) in (top..=last).zip(open[skip * words..].chunks_mut(words)) {
                    let Some((lo, hi)) = on_side.row(row, columns) else { continue };
                    set_span(line, (base + lo) as usize, (base + hi) as usize + 1);
                    self.scratch.masks.hidden_runs(index, scale, row, (lo, hi), |a, b| {
                        clear_span(line, (base + a) as usize, (base + b) as usize + 1);
                    });
                }
            }
        }
    }
}
