//! Eight edges at a time, in single precision.

use crate::numeric::occlusion::{ACROSS_AREA, FAR_PIXEL, FLAT, NEAREST_INTEGER_SINGLE};
use crate::numeric::{greater, lesser};
use crate::occlusion::surface::raster::{Marks, Raster};

/// Edges that are set up together.
pub(crate) const LANES: usize = 8;

/// Eight numbers.
pub(crate) type Lanes = [f32; LANES];

/// Edges of an outline, in pixels. No coordinate of those that are drawn is greater than
/// [`FAR_PIXEL`].
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Edges {
    pub(crate) x0: Lanes,
    pub(crate) y0: Lanes,
    pub(crate) x1: Lanes,
    pub(crate) y1: Lanes,
    /// How far the outline may be from each edge.
    pub(crate) wide: Lanes,
    /// How far an edge may be from where its ends say, for rounding alone. At most half of `wide`.
    pub(crate) unsure: Lanes,
    /// The edges to be drawn, one bit each.
    pub(crate) plain: u8,
    /// Those that are shared by two patches which are drawn together.
    pub(crate) seams: u8,
}

impl Edges {
    /// Sets an edge to one of others; `seam` tells whether it is shared.
    #[inline(always)]
    pub(crate) fn take(&mut self, at: usize, from: &Self, lane: usize, seam: bool) {
        self.x0[at] = from.x0[lane];
        self.y0[at] = from.y0[lane];
        self.x1[at] = from.x1[lane];
        self.y1[at] = from.y1[lane];
        self.wide[at] = from.wide[lane];
        self.unsure[at] = from.unsure[lane];
        self.plain |= 1 << at;
        self.seams |= u8::from(seam) << at;
    }
}

/// A value for each lane. The compiler makes vectors of it where all that `f` does is arithmetic.
#[inline(always)]
pub(crate) fn each<T: Copy + Default>(mut f: impl FnMut(usize) -> T) -> [T; LANES] {
    let mut lanes = [T::default(); LANES];
    for (i, lane) in lanes.iter_mut().enumerate() {
        *lane = f(i);
    }
    lanes
}

/// Edges ready to be drawn, from their lower to their upper ends.
pub(super) struct Lines {
    /// Column and row of the lower end.
    x: Lanes,
    y: Lanes,
    /// Columns for each row.
    slope: Lanes,
    /// How far left of the column where it passes the middle of a row the columns begin that it
    /// touches there, and how far right they end: half a column more and less than the same.
    before: Lanes,
    after: Lanes,
    /// Half a column left of the columns between which it stays.
    left: Lanes,
    right: Lanes,
    /// How far the column may be off where it passes a row.
    unsure: Lanes,
    /// The first and last row that it touches.
    first: [i32; LANES],
    last: [i32; LANES],
    /// It passes the middles of the rows from one up to before the other.
    from: [i32; LANES],
    to: [i32; LANES],
    /// The first and last column that it touches.
    low: [i32; LANES],
    high: [i32; LANES],
    /// Those that were given from the upper to the lower end, one bit each.
    down: u8,
    /// Those nearly parallel to the rows, one bit each.
    is_flat: u8,
}

impl Lines {
    /// The first and last row that an edge touches.
    #[inline(always)]
    pub(super) fn rows(&self, i: usize) -> (i32, i32) {
        (self.first[i], self.last[i])
    }

    #[inline(always)]
    pub(super) fn new(e: &Edges) -> Self {
        let select = |first: bool, a: f32, b: f32| if first { a } else { b };
        let up: [bool; LANES] = each(|i| e.y0[i] <= e.y1[i]);
        let (x, to_x) =
            (each(|i| select(up[i], e.x0[i], e.x1[i])), each(|i| select(up[i], e.x1[i], e.x0[i])));
        let (y, to_y) =
            (each(|i| select(up[i], e.y0[i], e.y1[i])), each(|i| select(up[i], e.y1[i], e.y0[i])));
        let slope: Lanes = each(|i| (to_x[i] - x[i]) / (to_y[i] - y[i]));
        // Not if it is not a number.
        let is_slanted: [bool; LANES] = each(|i| slope[i].abs() < FLAT);
        let half: Lanes = each(|i| {
            let steep = slope[i].abs();
            select(is_slanted[i], 0.5 * steep + (e.wide[i] * steep + e.wide[i]), ACROSS_AREA)
        });
        let unsure: Lanes = each(|i| {
            let steep = slope[i].abs();
            select(is_slanted[i], e.unsure[i] * steep + e.unsure[i], ACROSS_AREA)
        });
        let left: Lanes = each(|i| select(x[i] < to_x[i], x[i], to_x[i]) - e.wide[i] - 0.5);
        let right: Lanes = each(|i| select(x[i] < to_x[i], to_x[i], x[i]) + e.wide[i] - 0.5);
        Self {
            slope: each(|i| select(is_slanted[i], slope[i], 0.0)),
            first: each(|i| nearest(y[i] - e.wide[i] - 0.5)),
            last: each(|i| nearest(to_y[i] + e.wide[i] - 0.5)),
            from: each(|i| nearest(y[i])),
            to: each(|i| nearest(to_y[i])),
            low: each(|i| nearest(left[i])),
            high: each(|i| nearest(right[i])),
            down: (0..LANES).fold(0, |bits, i| bits | u8::from(!up[i]) << i),
            x,
            y,
            before: each(|i| half[i] + 0.5),
            after: each(|i| half[i] - 0.5),
            is_flat: (0..LANES).fold(0, |bits, i| bits | u8::from(!is_slanted[i]) << i),
            left,
            right,
            unsure,
        }
    }
}

/// One edge, in columns and rows of the face.
pub(super) struct Line {
    /// Column and row of the lower end.
    x: f32,
    y: f32,
    slope: f32,
    before: f32,
    after: f32,
    is_flat: bool,
    left: f32,
    right: f32,
    unsure: f32,
    /// Where it is farther than this from the middle between two columns, it is known on which side
    /// of the middle of a pixel it passes a row.
    sure: f32,
    /// It passes the middles of the rows of the area from one up to before the other.
    pub(super) from: i32,
    pub(super) to: i32,
    pub(super) layer: usize,
    /// Whether winding numbers to its right fall.
    pub(super) falls: bool,
}

impl Line {
    #[inline(always)]
    pub(super) fn new(l: &Lines, i: usize, seam: bool, falls: bool, corner: (i32, i32)) -> Self {
        let (from, to) = (l.from[i] - corner.1, l.to[i] - corner.1);
        let is_flat = l.is_flat >> i & 1 == 1;
        Self {
            x: l.x[i],
            y: l.y[i],
            slope: l.slope[i],
            before: l.before[i],
            after: l.after[i],
            is_flat,
            left: l.left[i],
            right: l.right[i],
            unsure: l.unsure[i],
            sure: if seam && !is_flat { 0.5 - l.unsure[i] } else { f32::INFINITY },
            from,
            to,
            // Two patches may not agree where a flat edge passes a row.
            layer: if seam && !(is_flat && from < to) { Marks::SEAM } else { Marks::OPEN },
            falls: (l.down >> i & 1 == 1) != falls,
        }
    }

    /// The column where it passes the middle of a row, which is given in rows of the face.
    #[inline(always)]
    pub(super) fn at(&self, middle: f32) -> f32 {
        self.x + (middle - self.y) * self.slope
    }

    /// The first and last column that it touches in rows where it passes the middles between two
    /// columns.
    #[inline(always)]
    fn touched(&self, least: f32, most: f32) -> (i32, i32) {
        let (lo, hi) = (least - self.before, most + self.after);
        let lo = if lo > self.left { lo } else { self.left };
        let hi = if hi < self.right { hi } else { self.right };
        (nearest(lo), nearest(hi))
    }

    /// As [`Line::touched`], for a row where it passes the middle at a column, and not rounded.
    #[inline(always)]
    pub(super) fn span(&self, at: f32) -> (f32, f32) {
        (greater(at - self.before, self.left), lesser(at + self.after, self.right))
    }

    /// Where winding numbers change in a row whose middle it passes at a column.
    #[inline(always)]
    pub(super) fn passes(&self, at: f32) -> f32 {
        if self.is_flat { self.left + 0.5 } else { at }
    }

    /// The first and last column of whose middles it is not known on which side of them it passes.
    #[inline(always)]
    pub(super) fn doubted(&self, at: f32) -> (i32, i32) {
        (nearest(at - self.unsure - 0.5), nearest(at + self.unsure - 0.5))
    }

    /// Whether it is known on which side of the middles of pixels it passes a row at a column.
    #[inline(always)]
    pub(super) fn is_sure(&self, at: f32) -> bool {
        (at - rounded(at)).abs() <= self.sure
    }
}

impl Raster {
    /// Draws edges of an outline. Going up, they make the winding numbers to their right grow by
    /// one, or fall.
    #[inline(never)]
    pub(crate) fn edges(&mut self, edges: &Edges, fall: bool) {
        let l = Lines::new(edges);
        let (corner, width, height) = (self.corner, self.area.width(), self.area.height());
        let mut lanes = edges.plain;
        while lanes != 0 {
            let i = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            let (first, last) = (l.first[i] - corner.1, l.last[i] - corner.1);
            let columns = (l.low[i] - corner.0, l.high[i] - corner.0);
            if last >= 0 && first < height && columns.0 < width {
                let line = Line::new(&l, i, edges.seams >> i & 1 == 1, fall, corner);
                self.line(&line, (first.max(0), last.min(height - 1)), columns);
            }
        }
    }

    /// Draws one edge in rows of the area, in which it touches the columns given.
    #[inline(always)]
    fn line(&mut self, line: &Line, (first, last): (i32, i32), columns: (i32, i32)) {
        let mut row = first;
        while row <= last {
            // Rows of one row of tiles.
            let end = last.min(row | 7);
            let (low, high) =
                if row == first && end == last { columns } else { self.columns(line, row, end) };
            // One column more: the edge may pass rows there.
            let two_tiles = ((high + 1) >> 3) - (low >> 3) <= 1;
            if two_tiles && low >= 0 && high + 1 < self.area.width() && !line.is_flat {
                self.line_in_tiles(line, (row, end), low >> 3);
            } else {
                (row..end + 1).for_each(|row| self.line_in_row(line, row));
            }
            row = end + 1;
        }
    }

    /// The row of the face on which the middle of a row of the area lies.
    #[inline(always)]
    fn middle(&self, row: i32) -> f32 {
        (row + self.corner.1) as f32 + 0.5
    }

    /// The first and last column of the area that an edge touches in some rows.
    #[inline(always)]
    fn columns(&self, line: &Line, first: i32, last: i32) -> (i32, i32) {
        let (a, b) = (line.at(self.middle(first)), line.at(self.middle(last)));
        let (low, high) = line.touched(if a < b { a } else { b }, if a < b { b } else { a });
        (low - self.corner.0, high - self.corner.0)
    }

    /// Draws an edge in rows of one row of tiles, in which it stays in the tile in a column of
    /// tiles and the next one.
    #[inline(always)]
    fn line_in_tiles(&mut self, line: &Line, (first, last): (i32, i32), column: i32) {
        let left = self.corner.0 + (column << 3);
        let (mut touched, mut passed) = ([0u64; 2], [0u64; 2]);
        let mut middle = self.middle(first);
        for row in first..last + 1 {
            let shift = (row & 7) << 3;
            let at = line.at(middle);
            middle += 1.0;
            let (lo, hi) = line.touched(at, at);
            let (lo, hi) = (lo - left, hi - left);
            // Both are below 16.
            let run = 2u32.wrapping_shl(hi as u32).wrapping_sub(1u32.wrapping_shl(lo as u32));
            let run = if lo <= hi { u64::from(run) } else { 0 };
            touched[0] |= (run & 0xff) << shift;
            touched[1] |= run >> 8 << shift;
            let bit = u64::from(1u32.wrapping_shl((nearest(at) - left) as u32));
            passed[0] |= (bit & 0xff) << shift;
            passed[1] |= (bit >> 8 & 0xff) << shift;
            if !line.is_sure(at) && line.from <= row && row < line.to {
                self.doubt(row, at, line.unsure);
            }
        }
        let (from, to) = (line.from.max(first), line.to.min(last + 1));
        let rows = if from < to { u64::MAX << ((from & 7) << 3) & u64::MAX >> ((-to & 7) << 3) } else { 0 };
        let passed = passed.map(|passed| passed & rows);
        self.tiles.mark_two((first >> 3, column), touched, line.layer, passed, line.falls);
    }

    /// Draws an edge in one row.
    fn line_in_row(&mut self, line: &Line, row: i32) {
        let (left, width) = (self.corner.0, self.area.width());
        let at = line.at(self.middle(row));
        let (lo, hi) = line.touched(at, at);
        let (lo, hi) = ((lo - left).max(0), (hi - left).min(width - 1));
        if lo <= hi {
            self.tiles.mark(row, lo, hi, line.layer);
        }
        if line.from <= row && row < line.to {
            let at = if line.is_flat { line.left + 0.5 } else { at };
            if !line.is_sure(at) {
                self.doubt(row, at, line.unsure);
            }
            let column = (nearest(at) - left).max(0);
            if column < width {
                self.tiles.pass(row, column, line.falls);
            }
        }
    }

    /// Marks the pixels of a row of whose middles it is not known on which side of them a seam
    /// passes: its two patches may both count them, or neither.
    #[cold]
    fn doubt(&mut self, row: i32, at: f32, unsure: f32) {
        let lo = (nearest(at - unsure - 0.5) - self.corner.0).max(0);
        let hi = (nearest(at + unsure - 0.5) - self.corner.0).min(self.area.width() - 1);
        if lo <= hi {
            self.tiles.mark(row, lo, hi, Marks::OPEN);
        }
    }
}

/// The integer nearest to a number below 2^22, halves to even: as its twin in double precision.
/// Other numbers, which lanes hold that are not drawn, give any integer.
#[inline(always)]
pub(super) fn nearest(v: f32) -> i32 {
    ((v + NEAREST_INTEGER_SINGLE).to_bits() as i32).wrapping_sub(NEAREST_INTEGER_SINGLE.to_bits() as i32)
}

/// As [`nearest`], as a number.
#[inline(always)]
fn rounded(v: f32) -> f32 {
    (v + NEAREST_INTEGER_SINGLE) - NEAREST_INTEGER_SINGLE
}

const _: () = assert!(FAR_PIXEL + ACROSS_AREA < 4_194_304.0, "all columns and rows fit `nearest`");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::occlusion::surface::raster::Area;

    #[test]
    fn lanes_that_are_not_drawn_may_hold_anything() {
        let mut raster = Raster::default();
        raster.begin(Area { x: 0, y: 0, nx: 1, ny: 1 }, (0, 0));
        let any = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -3e9, 3e9, -0.0, 1e-45];
        for turn in 0..LANES {
            let lanes = |by: usize| std::array::from_fn(|i| any[(i * (by + turn) + by) % LANES]);
            let (wide, unsure) = (lanes(4), lanes(6));
            let edges = Edges {
                x0: lanes(1),
                y0: lanes(3),
                x1: lanes(5),
                y1: lanes(7),
                wide,
                unsure,
                plain: 0,
                seams: 255,
            };
            raster.edges(&edges, false);
        }
        raster.finish();
        assert!(raster.marks(0).is_empty());
    }

    #[test]
    fn nearest_integers() {
        for v in [-7.6, -0.5, -0.2, 0.0, 0.49, 0.5, 1.5, 2.5, 1e6 + 0.25] {
            assert_eq!((nearest(v), rounded(v)), (v.round_ties_even() as i32, v.round_ties_even()));
        }
    }
}
