//! Direction masks: the lattice rule by table look-up.
//!
//! All cells are relative to the viewer's cell V. Let c = (m, y, z) be a cell of
//! side +x of shell m, and k < m. If the 1 to 4 cells around (y, z) * k/m on side
//! +x of shell k are blocked (opaque, or themselves hidden), then no point of c can
//! be seen from any point of V: the segment from v in V to p in c passes, at k/m of
//! its way, within half a cell of depth k and within half a cell of (y, z) * k/m
//! across, so through one of those cells.
//!
//! A side's mask has one bit for each square of directions (y/x, z/x). A set bit
//! says: for *every* direction of the square, corners and edges included,
//! the rule applies at some shell already walked. Cells are looked up by the direction of
//! their centre; blocked cells of a shell are stamped as the polygon through their
//! centres, rounded inwards. Look-ups and stamps without an uncertain eye are
//! integer arithmetic, or divisions whose rounding provably cannot change their floor.

use crate::query::cell::shell_scale::ShellScale;
use crate::query::cell::side_cells::SideCells;
use crate::query::cell::spans::{clear_span, for_runs, next_clear, set_span};

/// Bands with more rows of pixels than this are looked at row by row.
const MOST_PIXELS: i64 = 8;

/// The mask of one side.
#[derive(Debug, Clone)]
pub(super) struct DirectionMask {
    log: u32,
    /// Words in a row of pixels.
    words: usize,
    bits: Vec<u64>,
    /// Whether some bit may be set.
    used: bool,
    /// What blocks in the rows of cells around a row of pixels, and the pixels that hides.
    row: Vec<u64>,
    pattern: Vec<u64>,
}

impl DirectionMask {
    /// A mask of 2^log pixels along each side.
    pub(super) fn new(log: u32) -> Self {
        let words = (1usize << log).div_ceil(64);
        Self {
            log,
            words,
            bits: vec![0; words << log],
            used: false,
            row: Vec::new(),
            pattern: vec![0; words],
        }
    }

    pub(super) fn log(&self) -> u32 {
        self.log
    }

    /// Clears all bits.
    pub(super) fn clear(&mut self) {
        if std::mem::take(&mut self.used) {
            self.bits.fill(0);
        }
    }

    /// Whether a cell of the side of the scale's shell is hidden.
    #[inline]
    pub(super) fn is_hidden(&self, scale: &ShellScale, row: i32, col: i32) -> bool {
        if !self.used {
            return false;
        }
        let (r, c) = (scale.pixel(row) as usize, scale.pixel(col) as usize);
        self.bits[r * self.words + c / 64] >> (c % 64) & 1 != 0
    }

    /// Whether a pixel is not set.
    #[inline]
    pub(super) fn is_open(&self, row: i64, col: i64) -> bool {
        !self.used || self.bits[row as usize * self.words + col as usize / 64] >> (col % 64) & 1 == 0
    }

    /// The first pixel between two rows and two columns, all included, that is not set, and how
    /// many words were read.
    pub(super) fn first_open(&self, rows: (i64, i64), cols: (i64, i64)) -> (Option<(i64, i64)>, i64) {
        if !self.used {
            return (Some((rows.0, cols.0)), 0);
        }
        let (from, end) = (cols.0 as usize, cols.1 as usize + 1);
        let words = (end / 64 - from / 64) as i64 + 1;
        for row in rows.0..=rows.1 {
            let at = row as usize * self.words;
            let col = next_clear(&self.bits[at..at + self.words], from, end);
            if col < end {
                return (Some((row, col as i64)), words * (row - rows.0 + 1));
            }
        }
        (None, words * (rows.1 - rows.0 + 1))
    }

    /// The columns between which rows of the side have cells that are not hidden, as far as the
    /// pixels around all of the rows tell; `None` if they are hidden. Near shells are not looked
    /// at: their rows have many pixels each.
    pub(super) fn open_part(
        &self,
        scale: &ShellScale,
        rows: (i32, i32),
        cols: (i32, i32),
    ) -> Option<(i32, i32)> {
        let pixels = (scale.pixel(rows.0), scale.pixel(rows.1));
        if pixels.1 - pixels.0 > MOST_PIXELS {
            return Some(cols);
        }
        let (first, last) = self.open_columns(pixels, (scale.pixel(cols.0), scale.pixel(cols.1)))?;
        let part =
            ((scale.line_from(first) as i32).max(cols.0), (scale.line_before(last + 1) as i32).min(cols.1));
        (part.0 <= part.1).then_some(part)
    }

    /// The columns, of some, from the first to the last in which a pixel of some rows is not set;
    /// `None` if all are set.
    fn open_columns(&self, rows: (i64, i64), cols: (i64, i64)) -> Option<(i64, i64)> {
        if !self.used {
            return Some(cols);
        }
        let (from, end) = (cols.0 as usize, cols.1 as usize + 1);
        let (first, last) = (from / 64, (end - 1) / 64);
        let open = |word: usize| {
            let set = (rows.0..=rows.1)
                .fold(u64::MAX, |all, row| all & self.bits[row as usize * self.words + word]);
            let head = if word == first { u64::MAX << (from % 64) } else { u64::MAX };
            let tail = if word == last { u64::MAX >> (63 - (end - 1) % 64) } else { u64::MAX };
            !set & head & tail
        };
        let a = (first..=last).find_map(|word| {
            let open = open(word);
            (open != 0).then(|| word as i64 * 64 + i64::from(open.trailing_zeros()))
        })?;
        let b = (first..=last).rev().find_map(|word| {
            let open = open(word);
            (open != 0).then(|| word as i64 * 64 + 63 - i64::from(open.leading_zeros()))
        })?;
        Some((a, b))
    }

    /// Calls `hidden` with the runs of hidden cells between two columns of a row.
    #[inline]
    pub(super) fn hidden_runs(
        &self,
        scale: &ShellScale,
        row: i32,
        (lo, hi): (i32, i32),
        mut hidden: impl FnMut(i32, i32),
    ) {
        if !self.used {
            return;
        }
        let at = scale.pixel(row) as usize * self.words;
        let bits = &self.bits[at..at + self.words];
        let (first, last) = (scale.pixel(lo), scale.pixel(hi));
        for_runs(bits, true, first as usize, last as usize + 1, |p, q| {
            let a = (scale.line_from(p as i64) as i32).max(lo);
            let b = (scale.line_before(q as i64) as i32).min(hi);
            if a <= b {
                hidden(a, b);
            }
        });
    }

    /// Sets the bits of the cells between two columns of a row that are not hidden, where `base` is
    /// the bit of column 0. Returns their number.
    #[inline]
    pub(super) fn open_cells(
        &self,
        scale: &ShellScale,
        row: i32,
        (lo, hi): (i32, i32),
        base: i32,
        line: &mut [u64],
    ) -> i32 {
        let mut open = hi - lo + 1;
        set_span(line, (base + lo) as usize, (base + hi) as usize + 1);
        self.hidden_runs(scale, row, (lo, hi), |a, b| {
            clear_span(line, (base + a) as usize, (base + b) as usize + 1);
            open -= b - a + 1;
        });
        open
    }

    /// Draws the blocked cells of the side of the scale's shell.
    ///
    /// Cells of the side outside the frustum count as blocked, since no segment
    /// between points of the convex frustum passes through them; where `closed`,
    /// so do cells beyond all that there is, for the same reason.
    pub(super) fn stamp(&mut self, scale: &ShellScale, cells: &SideCells, closed: bool) {
        if cells.rows <= 0 || cells.cols <= 0 {
            return;
        }
        let size = scale.size();
        let row_end = i64::from(cells.row0) + i64::from(cells.rows) - 1;
        let row_start = i64::from(cells.row0);
        let (mut j, last) = {
            let start = cells.fresh.iter().position(|&f| f);
            let end = cells.fresh.iter().rposition(|&f| f);
            let (Some(start), Some(end)) = (start, end) else { return };
            let (start, end) = (row_start + start as i64, row_start + end as i64);
            let (spread, m) = (scale.whole_slack() + 1, i64::from(scale.shell()));
            let from = ((start - spread + m).max(0) << scale.log()) / (2 * m);
            let to = ((end + spread + m) << scale.log()) / (2 * m) + 1;
            ((from - 1).max(0), to.min(size - 1))
        };
        self.used = true;
        let mut drawn = None;
        while j <= last {
            let (lo, hi) = scale.lines_around(j);
            let inside = closed || (lo >= row_start && hi <= row_end);
            let (lo, hi) = (lo.max(row_start), hi.min(row_end));
            let rows = (lo - row_start) as usize..=((hi - row_start).max(-1)) as usize;
            if !inside || lo > hi || !cells.fresh[rows.clone()].iter().any(|&f| f) {
                j += 1;
                continue;
            }
            if drawn != Some((lo, hi)) {
                drawn = Some((lo, hi));
                self.draw_pattern(scale, cells, rows, closed);
            }
            let at = j as usize * self.words;
            for (bits, pattern) in self.bits[at..at + self.words].iter_mut().zip(&self.pattern) {
                *bits |= pattern;
            }
            j += 1;
        }
    }

    /// Finds the pixels of a pixel row for which the cells of all lattice rows around them block.
    fn draw_pattern(
        &mut self,
        scale: &ShellScale,
        cells: &SideCells,
        rows: std::ops::RangeInclusive<usize>,
        closed: bool,
    ) {
        self.row.clear();
        self.row.resize(cells.words, 0);
        for r in rows {
            // Bands around opaque cells exist. In other ones no cell is known to block.
            let Some(line) = cells.line(r) else { return self.pattern.fill(0) };
            for (sum, open) in self.row.iter_mut().zip(line) {
                *sum |= open;
            }
        }
        self.pattern.fill(0);
        let end = cells.offset + cells.cols as usize;
        let size = scale.size();
        let column = |bit: usize| i64::from(cells.col0) + bit as i64 - cells.offset as i64;
        // Blocked from x to stop - 1.
        for_runs(&self.row, false, cells.offset, end, |x, stop| {
            let from = if closed && x == cells.offset { 0 } else { scale.pixel_from(column(x)).max(0) };
            let to = if closed && stop == end { size } else { scale.pixel_to(column(stop - 1)).min(size) };
            if from < to {
                set_span(&mut self.pattern, from as usize, to as usize);
            }
        });
    }
}
