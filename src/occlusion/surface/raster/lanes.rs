//! Eight edges at a time, in single precision.

use crate::numeric::occlusion::{FAR_PIXEL, FLAT};
use crate::occlusion::surface::raster::{Marks, Raster};

/// Edges that are set up together.
pub(crate) const LANES: usize = 8;

/// A half width that reaches across any area.
const ACROSS: f32 = 1e6;

/// Eight numbers.
pub(crate) type Lanes = [f32; LANES];

/// Edges of an outline, in pixels. No coordinate of those that are drawn is greater than [`FAR_PIXEL`].
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

/// Edges ready to be drawn, from their lower to their upper ends.
#[derive(Default)]
struct Lines {
    /// Column and row of the lower end.
    x: Lanes,
    y: Lanes,
    /// Columns for each row.
    slope: Lanes,
    /// Half of the columns that it touches in a row.
    half: Lanes,
    /// The columns between which it stays.
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
    /// Whether it was given from the upper to the lower end.
    is_down: [bool; LANES],
}

impl Lines {
    #[inline(always)]
    fn new(e: &Edges) -> Self {
        let mut l = Self::default();
        for i in 0..LANES {
            let (wide, up) = (e.wide[i], e.y0[i] <= e.y1[i]);
            let (x, to_x) = if up { (e.x0[i], e.x1[i]) } else { (e.x1[i], e.x0[i]) };
            let (y, to_y) = if up { (e.y0[i], e.y1[i]) } else { (e.y1[i], e.y0[i]) };
            let slope = (to_x - x) / (to_y - y);
            let steep = slope.abs();
            // Also if it is not a number.
            let is_slanted = steep < FLAT;
            let left = if x < to_x { x } else { to_x } - wide;
            let right = if x < to_x { to_x } else { x } + wide;
            l.x[i] = x;
            l.y[i] = y;
            l.slope[i] = if is_slanted { slope } else { 0.0 };
            l.half[i] = if is_slanted { 0.5 * steep + (wide * steep + wide) } else { ACROSS };
            l.unsure[i] = if is_slanted { e.unsure[i] * steep + e.unsure[i] } else { ACROSS };
            l.left[i] = left;
            l.right[i] = right;
            l.first[i] = nearest(y - wide - 0.5);
            l.last[i] = nearest(to_y + wide - 0.5);
            l.from[i] = nearest(y);
            l.to[i] = nearest(to_y);
            l.low[i] = nearest(left - 0.5);
            l.high[i] = nearest(right - 0.5);
            l.is_down[i] = !up;
        }
        l
    }
}

impl Raster {
    /// Draws edges of an outline. Going up, they make the winding numbers to their right grow by one, or fall.
    #[inline]
    pub(crate) fn edges(&mut self, edges: &Edges, fall: bool) {
        let l = Lines::new(edges);
        let (corner, width, height) = (self.corner, self.area.width(), self.area.height());
        let mut lanes = edges.plain;
        while lanes != 0 {
            let i = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            let seam = edges.seams >> i & 1 == 1;
            let (first, last) = (l.first[i] - corner.1, l.last[i] - corner.1);
            let (low, high) = (l.low[i] - corner.0, l.high[i] - corner.0);
            if first >= 0 && last < height && low >= 0 && high < width {
                self.line::<false>(&l, i, fall, seam);
            } else if last >= 0 && first < height && low < width {
                self.line::<true>(&l, i, fall, seam);
            }
        }
    }

    /// Draws one edge. It may leave the area if `CLIP` says so.
    #[inline(always)]
    fn line<const CLIP: bool>(&mut self, l: &Lines, i: usize, fall: bool, seam: bool) {
        let (corner, width, height) = (self.corner, self.area.width(), self.area.height());
        let (mut first, mut last) = (l.first[i] - corner.1, l.last[i] - corner.1);
        let (from, to) = (l.from[i] - corner.1, l.to[i] - corner.1);
        if CLIP {
            (first, last) = (first.max(0), last.min(height - 1));
        }
        let (x, y, slope, half) = (l.x[i], l.y[i], l.slope[i], l.half[i]);
        let (left, right, unsure) = (l.left[i], l.right[i], l.unsure[i]);
        let is_flat = half == ACROSS;
        // Two patches may not agree where a flat edge passes a row.
        let layer = if seam && !(is_flat && from < to) { Marks::SEAM } else { Marks::OPEN };
        for row in first..=last {
            // The column where the edge passes the middle of the row.
            let at = x + ((row + corner.1) as f32 + 0.5 - y) * slope;
            let (lo, hi) = (at - half, at + half);
            let mut lo = nearest(if lo > left { lo } else { left } - 0.5) - corner.0;
            let mut hi = nearest(if hi < right { hi } else { right } - 0.5) - corner.0;
            if CLIP {
                (lo, hi) = (lo.max(0), hi.min(width - 1));
            }
            if lo <= hi {
                self.tiles.mark(row, lo, hi, layer);
            }
            if from <= row && row < to {
                let at = if is_flat { left } else { at };
                let column = nearest(at);
                if seam && (at - column as f32).abs() > 0.5 - unsure && !is_flat {
                    self.doubt(row, at, unsure);
                }
                let column = (column - corner.0).max(0);
                if column < width {
                    self.tiles.pass(row, column, l.is_down[i] != fall);
                }
            }
        }
    }

    /// Marks the pixels of a row of whose middles it is not known on which side of them a seam passes: its two patches
    /// may both count them, or neither.
    #[cold]
    fn doubt(&mut self, row: i32, at: f32, unsure: f32) {
        let lo = (nearest(at - unsure - 0.5) - self.corner.0).max(0);
        let hi = (nearest(at + unsure - 0.5) - self.corner.0).min(self.area.width() - 1);
        if lo <= hi {
            self.tiles.mark(row, lo, hi, Marks::OPEN);
        }
    }
}

/// The integer nearest to a number below 2^22, halves to even: as its twin in double precision. Adding 1.5 * 2^23 leaves
/// no digits after the point. Other numbers, which lanes hold that are not drawn, give any integer.
#[inline(always)]
fn nearest(v: f32) -> i32 {
    const WHOLE: f32 = 12_582_912.0;
    ((v + WHOLE).to_bits() as i32).wrapping_sub(WHOLE.to_bits() as i32)
}

const _: () = assert!(FAR_PIXEL + ACROSS < 4_194_304.0, "all columns and rows fit `nearest`");

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
            assert_eq!(nearest(v), v.round_ties_even() as i32);
        }
    }
}
