//! Eight edges at a time, in single precision; each in eight rows at a time.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, i32x8, u32x8};

use crate::numeric::occlusion::{ACROSS_AREA, FAR_PIXEL, FLAT, NEAREST_INTEGER_SINGLE};
use crate::numeric::{greater, lesser};
use crate::occlusion::surface::raster::Raster;
use crate::occlusion::surface::raster::marks::{Marks, Windings, from_column};

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
struct Lines {
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
    #[inline(always)]
    fn new(e: &Edges) -> Self {
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
struct Line {
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
    from: i32,
    to: i32,
    layer: usize,
    /// Whether two patches share it, and must agree where it passes rows.
    is_seam: bool,
    /// Whether winding numbers to its right fall.
    falls: bool,
}

impl Line {
    #[inline(always)]
    fn new(l: &Lines, i: usize, seam: bool, falls: bool, corner: (i32, i32)) -> Self {
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
            sure: 0.5 - l.unsure[i],
            is_seam: seam && !is_flat,
            from,
            to,
            // Two patches may not agree where a flat edge passes a row.
            layer: if seam && !(is_flat && from < to) { Marks::SEAM } else { Marks::OPEN },
            falls: (l.down >> i & 1 == 1) != falls,
        }
    }

    /// The columns where it passes the middles of rows, which are given in rows of the face.
    #[inline(always)]
    fn at<S: Simd>(&self, middles: f32x8<S>) -> f32x8<S> {
        (middles - self.y) * self.slope + self.x
    }
}

impl Raster {
    /// Draws edges of an outline. Going up, they make the winding numbers to their right grow by
    /// one, or fall.
    #[inline(always)]
    pub(crate) fn edges<S: Simd>(&mut self, simd: S, edges: &Edges, fall: bool) {
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
                let rows = (first.max(0), last.min(height - 1));
                for block in rows.0 as usize / LANES..=rows.1 as usize / LANES {
                    self.line(simd, &line, rows, columns, block);
                }
            }
        }
    }

    /// Draws one edge in those of some rows that belong to one row of blocks. The columns are given
    /// that it touches.
    #[inline(always)]
    fn line<S: Simd>(
        &mut self,
        simd: S,
        line: &Line,
        (first, last): (i32, i32),
        columns: (i32, i32),
        block: usize,
    ) {
        let (top, left) = ((block * LANES) as i32, self.corner.0);
        let rows = i32x8::from_slice(simd, &ROWS) + top;
        let at = line.at(f32x8::from_slice(simd, &MIDDLES) + (top + self.corner.1) as f32);
        // The first column that it touches, the one beyond the last, and where it passes the row.
        let begin = nearest_lanes((at - line.before).max(f32x8::splat(simd, line.left))) - left;
        let end = nearest_lanes((at + line.after).min(f32x8::splat(simd, line.right))) + (1 - left);
        let column =
            nearest_lanes(if line.is_flat { f32x8::splat(simd, line.left + 0.5) } else { at }) - left;
        let is_touched = rows.simd_ge(first) & rows.simd_le(last);
        let is_passed = rows.simd_ge(line.from) & rows.simd_lt(line.to);
        // One column more: it may pass rows there.
        let columns = if (columns.0 ^ columns.1) >> 5 == 0 { columns } else { self.columns(line, top) };
        let most = self.area.width() - 1;
        let (low, high) = (columns.0.max(0) >> 5, (columns.1 + 1).clamp(-1, most) >> 5);
        let start = block * self.across;
        let none = u32x8::splat(simd, 0);
        for x in low..=high {
            let Some(marks) = self.blocks.get_mut(start + x as usize) else { break };
            let touched = from_columns(simd, begin - (x << 5)) & !from_columns(simd, end - (x << 5));
            marks.mark(line.layer, is_touched.select(touched, none));
            marks.wind(is_passed.select(from_columns(simd, column - (x << 5)), none), line.falls);
        }
        if high + 1 < self.across as i32 && line.from < top + LANES as i32 && line.to > top {
            let (from, to) = ((line.from - top).max(0), (line.to - top).min(LANES as i32));
            self.carried[start + (high + 1) as usize].step((1u32 << to) - (1 << from), line.falls);
        }
        if line.is_seam {
            let rounded = (at + NEAREST_INTEGER_SINGLE) - NEAREST_INTEGER_SINGLE;
            let is_sure = (at - rounded).abs().simd_le(line.sure);
            let doubted = (is_passed & !is_sure).to_bitmask();
            if doubted != 0 {
                self.doubt(line, doubted, top);
            }
        }
    }

    /// The first and last column that an edge touches in eight rows from one on.
    #[inline(always)]
    fn columns(&self, line: &Line, top: i32) -> (i32, i32) {
        let at = |row: usize| line.x + (MIDDLES[row] + (top + self.corner.1) as f32 - line.y) * line.slope;
        let (a, b) = (at(0), at(LANES - 1));
        let (low, high) = (lesser(a, b) - line.before, greater(a, b) + line.after);
        let (low, high) = (greater(low, line.left), lesser(high, line.right));
        (nearest(low) - self.corner.0, nearest(high) - self.corner.0)
    }

    /// Marks the pixels of which it is not known on which side of their middles a seam passes: its
    /// two patches may both count them, or neither. The rows are bits, from the row `top` on.
    #[cold]
    fn doubt(&mut self, line: &Line, rows: u64, top: i32) {
        for k in (0..LANES).filter(|&k| rows >> k & 1 == 1) {
            let at = line.x + (MIDDLES[k] + (top + self.corner.1) as f32 - line.y) * line.slope;
            let lo = (nearest(at - line.unsure - 0.5) - self.corner.0).max(0);
            let hi = (nearest(at + line.unsure - 0.5) - self.corner.0).min(self.area.width() - 1);
            if lo <= hi {
                self.mark(top + k as i32, lo, hi, Marks::OPEN);
            }
        }
    }
}

/// The numbers of eight rows, and their middles.
const ROWS: [i32; LANES] = [0, 1, 2, 3, 4, 5, 6, 7];
const MIDDLES: Lanes = [0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5];

/// As [`nearest`], of eight numbers.
#[inline(always)]
fn nearest_lanes<S: Simd>(v: f32x8<S>) -> i32x8<S> {
    (v + NEAREST_INTEGER_SINGLE).bitcast::<i32x8<S>>() - NEAREST_INTEGER_SINGLE.to_bits() as i32
}

/// As [`from_column`], of eight columns, which may be less than zero or beyond the last.
#[inline(always)]
fn from_columns<S: Simd>(simd: S, columns: i32x8<S>) -> u32x8<S> {
    let within = columns.max(i32x8::splat(simd, 0)).min(i32x8::splat(simd, 31));
    let pixels = u32x8::splat(simd, u32::MAX) << within.bitcast::<u32x8<S>>();
    columns.simd_lt(32).select(pixels, u32x8::splat(simd, 0))
}

/// The rows whose middles some edges pass, up or down, with signs: bits from the row `first` on, of
/// which there are `count`.
#[inline(always)]
pub(crate) fn rows_passed(edges: &Edges, mut lanes: u8, (first, count): (i32, i32), fall: bool) -> Windings {
    let mut passed = Windings::default();
    let row = |y: f32| (nearest(y) - first).clamp(0, count);
    while lanes != 0 {
        let i = lanes.trailing_zeros() as usize % LANES;
        lanes &= lanes - 1;
        let (a, b) = (row(edges.y0[i]), row(edges.y1[i]));
        let rows = from_column(a.min(b)) & !from_column(a.max(b));
        passed.step(rows, (edges.y0[i] > edges.y1[i]) != fall);
    }
    passed
}

/// The integer nearest to a number below 2^22, halves to even: as its twin in double precision.
/// Other numbers, which lanes hold that are not drawn, give any integer.
#[inline(always)]
fn nearest(v: f32) -> i32 {
    ((v + NEAREST_INTEGER_SINGLE).to_bits() as i32).wrapping_sub(NEAREST_INTEGER_SINGLE.to_bits() as i32)
}

const _: () = assert!(FAR_PIXEL + ACROSS_AREA < 4_194_304.0, "all columns and rows fit `nearest`");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::occlusion::surface::raster::Area;
    use crate::simd::vectorized;

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
            vectorized!(simd => raster.edges(simd, &edges, false));
        }
        raster.finish();
        assert_eq!(raster.marks(0), &Marks::default());
    }

    #[test]
    fn nearest_integers() {
        for v in [-7.6, -0.5, -0.2, 0.0, 0.49, 0.5, 1.5, 2.5, 1e6 + 0.25] {
            let lanes = vectorized!(simd => nearest_lanes(f32x8::splat(simd, v)).as_slice()[3]);
            assert_eq!((nearest(v), lanes), (v.round_ties_even() as i32, v.round_ties_even() as i32));
        }
    }
}
