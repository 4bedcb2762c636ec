//! Direction masks: the lattice rule at the cost of a look-up.
//!
//! All cells are relative to the viewer's cell V. Let c = (m, y, z) be a cell of
//! side +x of shell m, and k < m. If the 1 to 4 cells around (y, z) * k/m on side
//! +x of shell k are blocked (opaque, or themselves hidden), then no point of c can
//! be seen from any point of V: the segment from v in V to p in c passes, at k/m of
//! its way, within half a cell of depth k and within half a cell of (y, z) * k/m
//! across, so through one of those cells.
//!
//! A side's mask holds one bit for each square of directions (y/x, z/x). A set bit
//! says: for *every* direction of the square, corners and edges included,
//! the rule holds at some shell already walked. Cells are looked up by the direction of
//! their centre; blocked cells of a shell are stamped as the polygon through their
//! centres, rounded inwards. Look-ups and stamps without an uncertain eye are
//! integer arithmetic, or divisions whose rounding provably cannot change their floor.

/// How the cells of one shell map to the pixels of a mask with 2^log pixels
/// along each side.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ShellScale {
    m: i64,
    log: u32,
    /// 1 / 2m.
    inverse: f64,
    /// How far the eye may lie outside V, in cells across, doubled for the way in depth.
    slack: f64,
}

impl ShellScale {
    pub(crate) fn new(m: i32, log: u32, slack: f64) -> Self {
        Self { m: i64::from(m), log, inverse: 0.5 / f64::from(m), slack }
    }

    pub(crate) fn shell(&self) -> i64 {
        self.m
    }

    fn size(&self) -> i64 {
        1 << self.log
    }

    /// floor(n / 2m) for n >= 0. (n + 1/2) / 2m is at least 1/4m away from every
    /// integer, far more than the rounding of the product.
    #[inline]
    fn divide(&self, n: i64) -> i64 {
        ((n as f64 + 0.5) * self.inverse) as i64
    }

    /// The pixel that holds the direction of the centre of lattice line `c`.
    #[inline]
    pub(crate) fn pixel(&self, c: i32) -> i64 {
        self.divide((i64::from(c) + self.m) << self.log).min(self.size() - 1)
    }

    /// The first pixel wholly at or beyond lattice line `c`.
    #[inline]
    fn pixel_from(&self, c: i64) -> i64 {
        if self.slack > 0.0 {
            let at = ((c + self.m) as f64 + self.slack) * self.size() as f64 * self.inverse;
            return (at + 1e-9).ceil() as i64;
        }
        self.divide(((c + self.m) << self.log) + 2 * self.m - 1)
    }

    /// One past the last pixel wholly at or before lattice line `c`.
    #[inline]
    fn pixel_to(&self, c: i64) -> i64 {
        if self.slack > 0.0 {
            let at = ((c + self.m) as f64 - self.slack) * self.size() as f64 * self.inverse;
            return (at - 1e-9).floor() as i64;
        }
        self.divide((c + self.m) << self.log)
    }

    /// The first lattice line whose centre lies in pixel `p` or later.
    #[inline]
    fn line_from(&self, p: i64) -> i64 {
        ((2 * self.m * p + self.size() - 1) >> self.log) - self.m
    }

    /// The last lattice line whose centre lies before pixel `p`.
    #[inline]
    fn line_before(&self, p: i64) -> i64 {
        if p >= self.size() { self.m } else { self.line_from(p) - 1 }
    }

    /// No pixel has lattice lines around it that are farther apart.
    pub(crate) fn reach(&self) -> usize {
        ((2 * self.m) >> self.log) as usize + 2 * self.slack.ceil() as usize + 4
    }

    /// The lattice lines around the directions of pixel `p`: of floor and ceiling.
    #[inline]
    fn lines_around(&self, p: i64) -> (i64, i64) {
        if self.slack > 0.0 {
            let (a, b) = ((2 * self.m * p) as f64, (2 * self.m * (p + 1)) as f64);
            let size = self.size() as f64;
            let lo = (a / size - self.slack - 1e-9).floor() as i64;
            return (lo - self.m, (b / size + self.slack + 1e-9).ceil() as i64 - self.m);
        }
        let lo = (2 * self.m * p) >> self.log;
        let hi = (2 * self.m * (p + 1) + self.size() - 1) >> self.log;
        (lo - self.m, hi - self.m)
    }
}

/// The cells in sight of one side of a shell: what [`DirectionMasks::stamp`] needs.
#[derive(Debug, Clone, Default)]
pub(crate) struct SideCells {
    /// First row and column of the grid's part of the side, relative to V.
    pub(crate) row0: i32,
    pub(crate) col0: i32,
    pub(crate) rows: i32,
    pub(crate) cols: i32,
    /// Words a row.
    pub(crate) words: usize,
    /// Cells that do not block: inside the frustum, not hidden and not opaque. Bit
    /// `col - col0 + offset` of a row. Eight rows a band, of the bands that are there.
    pub(crate) open: Vec<u64>,
    pub(crate) offset: usize,
    /// Rows of the first band that come before `row0`.
    pub(crate) before: usize,
    /// Where each band is in `open`, counted in bands, or [`PASSED_OVER`].
    pub(crate) bands: Vec<u32>,
    /// Rows with opaque cells that are not hidden.
    pub(crate) fresh: Vec<bool>,
}

/// A band that nobody has looked at.
pub(crate) const PASSED_OVER: u32 = u32::MAX;

impl SideCells {
    /// Makes room for a band of rows and gives it.
    pub(crate) fn make_band(&mut self, band: usize) -> &mut [u64] {
        let size = 8 * self.words;
        let at = self.open.len();
        self.bands[band] = (at / size) as u32;
        self.open.resize(at + size, 0);
        &mut self.open[at..]
    }

    /// The cells of row `row0 + r` that do not block; none if its band was passed over.
    pub(crate) fn line(&self, r: usize) -> Option<&[u64]> {
        let at = r + self.before;
        let band = self.bands[at >> 3];
        let first = (band as usize * 8 + (at & 7)) * self.words;
        (band != PASSED_OVER).then(|| &self.open[first..first + self.words])
    }
}

/// The six masks of a query.
#[derive(Debug, Clone)]
pub(crate) struct DirectionMasks {
    log: u32,
    words: usize,
    bits: [Vec<u64>; 6],
    used: [bool; 6],
    row: Vec<u64>,
    pattern: Vec<u64>,
}

impl DirectionMasks {
    /// Masks of 2^log pixels along each side.
    pub(crate) fn new(log: u32) -> Self {
        let words = (1usize << log).div_ceil(64);
        Self {
            log,
            words,
            bits: std::array::from_fn(|_| vec![0; words << log]),
            used: [false; 6],
            row: Vec::new(),
            pattern: vec![0; words],
        }
    }

    pub(crate) fn log(&self) -> u32 {
        self.log
    }

    /// Clears all masks.
    pub(crate) fn clear(&mut self) {
        for (bits, used) in self.bits.iter_mut().zip(&mut self.used) {
            if std::mem::take(used) {
                bits.fill(0);
            }
        }
    }

    /// Whether a cell of a side of the scale's shell is hidden.
    #[inline]
    pub(crate) fn is_hidden(&self, side: usize, scale: &ShellScale, row: i32, col: i32) -> bool {
        if !self.used[side] {
            return false;
        }
        let (r, c) = (scale.pixel(row) as usize, scale.pixel(col) as usize);
        self.bits[side][r * self.words + c / 64] >> (c % 64) & 1 != 0
    }

    /// Calls `hidden` with the runs of hidden cells between two columns of a row.
    #[inline]
    pub(crate) fn hidden_runs(
        &self,
        side: usize,
        scale: &ShellScale,
        row: i32,
        (lo, hi): (i32, i32),
        mut hidden: impl FnMut(i32, i32),
    ) {
        if !self.used[side] {
            return;
        }
        let at = scale.pixel(row) as usize * self.words;
        let bits = &self.bits[side][at..at + self.words];
        let (first, last) = (scale.pixel(lo), scale.pixel(hi));
        let mut p = first as usize;
        let end = last as usize + 1;
        while p < end {
            p = next_set(bits, p, end);
            if p >= end {
                break;
            }
            let q = next_clear(bits, p, end);
            let a = (scale.line_from(p as i64) as i32).max(lo);
            let b = (scale.line_before(q as i64) as i32).min(hi);
            if a <= b {
                hidden(a, b);
            }
            p = q;
        }
    }

    /// Draws the blocked cells of one side of the scale's shell.
    ///
    /// Cells of the side outside the frustum count as blocked, since no segment
    /// between points of the convex frustum passes through them; where `closed`,
    /// so do cells outside the grid, for the same reason.
    pub(crate) fn stamp(&mut self, side: usize, scale: &ShellScale, cells: &SideCells, closed: bool) {
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
            let reach = scale.slack.ceil() as i64 + 1;
            let from = ((start - reach + scale.m).max(0) << scale.log) / (2 * scale.m);
            let to = ((end + reach + scale.m) << scale.log) / (2 * scale.m) + 1;
            ((from - 1).max(0), to.min(size - 1))
        };
        self.used[side] = true;
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
            for (mask, pattern) in self.bits[side][at..at + self.words].iter_mut().zip(&self.pattern) {
                *mask |= pattern;
            }
            j += 1;
        }
    }

    /// The pixels of a pixel row between whose lattice rows all cells block.
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
            // Bands around opaque cells are there; of others nothing is known to block.
            let Some(line) = cells.line(r) else { return self.pattern.fill(0) };
            for (sum, open) in self.row.iter_mut().zip(line) {
                *sum |= open;
            }
        }
        self.pattern.fill(0);
        let end = cells.offset + cells.cols as usize;
        let size = scale.size();
        let column = |bit: usize| i64::from(cells.col0) + bit as i64 - cells.offset as i64;
        let mut x = cells.offset;
        while x < end {
            let stop = next_set(&self.row, x, end);
            if stop > x {
                // Blocked from x to stop - 1.
                let from = if closed && x == cells.offset { 0 } else { scale.pixel_from(column(x)).max(0) };
                let to =
                    if closed && stop == end { size } else { scale.pixel_to(column(stop - 1)).min(size) };
                if from < to {
                    set_span(&mut self.pattern, from as usize, to as usize);
                }
            }
            x = next_clear(&self.row, stop, end);
        }
    }
}

/// The first set bit in `from..end`, or `end`.
#[inline]
pub(crate) fn next_set(bits: &[u64], from: usize, end: usize) -> usize {
    scan(bits, from, end, 0)
}

/// The first clear bit in `from..end`, or `end`.
#[inline]
pub(crate) fn next_clear(bits: &[u64], from: usize, end: usize) -> usize {
    scan(bits, from, end, u64::MAX)
}

#[inline]
fn scan(bits: &[u64], from: usize, end: usize, flip: u64) -> usize {
    if from >= end {
        return end;
    }
    let mut i = from / 64;
    let mut word = (bits[i] ^ flip) & (u64::MAX << (from % 64));
    let last = (end - 1) / 64;
    while word == 0 {
        if i == last {
            return end;
        }
        i += 1;
        word = bits[i] ^ flip;
    }
    (i * 64 + word.trailing_zeros() as usize).min(end)
}

/// Sets the bits `from..to`.
#[inline]
pub(crate) fn set_span(bits: &mut [u64], from: usize, to: usize) {
    for_span(bits, from, to, |word, mask| *word |= mask);
}

/// Clears the bits `from..to`.
#[inline]
pub(crate) fn clear_span(bits: &mut [u64], from: usize, to: usize) {
    for_span(bits, from, to, |word, mask| *word &= !mask);
}

#[inline]
fn for_span(bits: &mut [u64], from: usize, to: usize, apply: impl Fn(&mut u64, u64)) {
    if from >= to {
        return;
    }
    let (a, b) = (from / 64, (to - 1) / 64);
    let (head, tail) = (u64::MAX << (from % 64), u64::MAX >> (63 - (to - 1) % 64));
    if a == b {
        apply(&mut bits[a], head & tail);
        return;
    }
    apply(&mut bits[a], head);
    bits[a + 1..b].iter_mut().for_each(|w| apply(w, u64::MAX));
    apply(&mut bits[b], tail);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_exact() {
        for log in [6, 8, 10] {
            let size = 1i64 << log;
            for m in [1, 2, 3, 7, 37, 64, 99, 1000, 8191] {
                let s = ShellScale::new(m, log, 0.0);
                let m = i64::from(m);
                for c in (-m..=m).step_by(1 + m as usize / 50).chain([m]) {
                    let n = (c + m) * size;
                    assert_eq!(s.pixel(c as i32), (n / (2 * m)).min(size - 1));
                    assert_eq!(s.pixel_to(c), n.div_euclid(2 * m));
                    assert_eq!(s.pixel_from(c), (n + 2 * m - 1).div_euclid(2 * m));
                }
                for p in 0..size {
                    let (lo, hi) = s.lines_around(p);
                    // lo + m <= 2m p / size < lo + m + 1, and the like above.
                    assert!((lo + m) * size <= 2 * m * p && 2 * m * p < (lo + m + 1) * size);
                    assert!((hi + m) * size >= 2 * m * (p + 1) && 2 * m * (p + 1) > (hi + m - 1) * size);
                    let first = s.line_from(p);
                    assert!(first > m || s.pixel(first as i32) >= p);
                    assert!(first <= -m || s.pixel(first as i32 - 1) < p || p == 0);
                }
                assert_eq!(s.line_before(size), m);
            }
        }
    }

    #[test]
    fn an_uncertain_eye_only_shrinks_what_is_stamped() {
        for m in [1, 5, 60] {
            let (exact, unsure) = (ShellScale::new(m, 8, 0.0), ShellScale::new(m, 8, 0.2));
            for c in -i64::from(m)..=i64::from(m) {
                assert!(unsure.pixel_from(c) >= exact.pixel_from(c));
                assert!(unsure.pixel_to(c) <= exact.pixel_to(c));
            }
            for p in 0..256 {
                let ((a, b), (c, d)) = (exact.lines_around(p), unsure.lines_around(p));
                assert!(c <= a && d >= b);
            }
        }
    }

    #[test]
    fn spans() {
        let mut bits = vec![0u64; 4];
        set_span(&mut bits, 3, 200);
        clear_span(&mut bits, 60, 130);
        assert_eq!(bits.iter().map(|w| w.count_ones()).sum::<u32>(), 197 - 70);
        assert_eq!(next_set(&bits, 0, 256), 3);
        assert_eq!(next_clear(&bits, 3, 256), 60);
        assert_eq!(next_set(&bits, 60, 256), 130);
        assert_eq!(next_set(&bits, 200, 256), 256);
        assert_eq!(next_clear(&bits, 130, 150), 150);
    }
}
