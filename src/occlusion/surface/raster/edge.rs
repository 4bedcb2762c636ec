//! Edges: the pixels that they touch, and the rows whose middles they pass.

use crate::numeric::occlusion::{EDGE, EDGE_FLAT, EDGE_ROUNDING, RASTER_BORDER};
use crate::occlusion::surface::raster::{Marks, Raster};

/// An edge from its lower to its upper row, in pixels from the corner of the area.
struct Line {
    a: (f64, f64),
    b: (f64, f64),
    /// Columns for each row.
    slope: f64,
    /// The least and greatest column that it touches.
    columns: (f64, f64),
    by: i16,
    /// By how much it is widened on each side.
    wide: f64,
    seam: bool,
}

impl Line {
    #[inline]
    fn layer(&self) -> usize {
        if self.seam { Marks::SEAM } else { Marks::OPEN }
    }
}

impl Raster {
    /// Draws an edge of the outline between two points, in pixels of the face.
    ///
    /// `by`, 1 or -1, is the change of the winding number from its left to its right, if it goes up; `wide` is how far
    /// it may be from where its ends say, in pixels; `seam` tells whether it is shared by two patches that are drawn
    /// together.
    #[inline]
    pub(crate) fn edge(&mut self, from: (f64, f64), to: (f64, f64), by: i16, wide: f64, seam: bool) {
        let (a, b) =
            ((from.0 - self.corner.0, from.1 - self.corner.1), (to.0 - self.corner.0, to.1 - self.corner.1));
        let wide = wide + EDGE_ROUNDING * (a.0.abs() + a.1.abs() + b.0.abs() + b.1.abs());
        // From the lower to the upper row.
        let (a, b, by) = if a.1 <= b.1 { (a, b, by) } else { (b, a, -by) };
        let (x0, x1) = if a.0 <= b.0 { (a.0, b.0) } else { (b.0, a.0) };
        let (left, x1) = (x0 - wide, x1 + wide);
        let (right, bottom) = (f64::from(self.area.width()), f64::from(self.area.height()));
        if b.1 + wide < 0.0 || a.1 - wide >= bottom || left >= right {
            return;
        }
        let slope = (b.0 - a.0) / (b.1 - a.1);
        let line = Line { a, b, slope, columns: (left, x1), by, wide, seam };
        // Edges well inside the area need no clipping.
        let inside = left >= 0.0
            && x1 < right - RASTER_BORDER
            && a.1 - wide >= 0.0
            && b.1 + wide < bottom - RASTER_BORDER;
        if inside && slope.abs() < EDGE_FLAT { self.edge_inside(&line) } else { self.edge_clipped(&line) }
    }

    /// Draws an edge that may leave the area or be flat.
    #[inline(always)]
    fn edge_clipped(&mut self, line: &Line) {
        let &Line { a, b, slope, columns: (left, x1), by, wide, seam } = line;
        let (width, height) = (self.area.width(), self.area.height());
        let (right, bottom) = (f64::from(width), f64::from(height));
        let first = nearest(within(a.1 - wide, bottom) - 0.5).max(0);
        let last = nearest(within(b.1 + wide, bottom) - 0.5).min(height - 1);
        // Rows whose middles the edge passes. Neighbours share their ends, and so agree about the rows.
        let (from, to) = (nearest(within(a.1, bottom)).max(0), nearest(within(b.1, bottom)).min(height));
        if x1 < 0.0 {
            for row in from..to {
                self.steps.push(row, 0, by);
            }
            return;
        }
        if slope.is_nan() || slope.abs() >= EDGE_FLAT {
            let layer = if from < to { Marks::OPEN } else { line.layer() };
            return self.edge_flat((left, x1), by, layer, (first, last), (from, to));
        }
        let reach = wide * slope.abs() + wide;
        // The column where the edge passes the lower border of a row.
        let mut x = a.0 + (f64::from(first) - a.1) * slope;
        for row in first..=last {
            let next = x + slope;
            let (lo, hi) = if x <= next { (x - reach, next + reach) } else { (next - reach, x + reach) };
            let lo = nearest(within(if lo > left { lo } else { left }, right) - 0.5).max(0);
            let hi = nearest(within(if hi < x1 { hi } else { x1 }, right) - 0.5).min(width - 1);
            if lo <= hi {
                self.tiles.mark(row, lo, hi, line.layer());
            }
            if from <= row && row < to {
                self.pass(row, within(x + 0.5 * slope, right), by, seam);
            }
            x = next;
        }
    }

    /// Draws an edge that is nearly parallel to the rows: it touches rows `first` to `last`, and passes the
    /// middles of `from` to before `to`.
    ///
    /// Where it passes them is not known well enough: all of its pixels count as touched, and if it passes any
    /// middle, as touched by an open edge, since two patches would not agree.
    fn edge_flat(
        &mut self,
        (left, x1): (f64, f64),
        by: i16,
        layer: usize,
        (first, last): (i32, i32),
        (from, to): (i32, i32),
    ) {
        let width = self.area.width();
        let right = f64::from(width);
        let lo = nearest(within(left, right) - 0.5).max(0);
        let hi = nearest(within(x1, right) - 0.5).min(width - 1);
        for row in first..=last {
            if lo <= hi {
                self.tiles.mark(row, lo, hi, layer);
            }
        }
        for row in from..to {
            if lo < width {
                self.steps.push(row, lo, by);
            }
        }
    }

    /// Draws an edge that lies inside the area with its width, and is not flat.
    #[inline(always)]
    fn edge_inside(&mut self, line: &Line) {
        let &Line { a, b, slope, columns: (left, right), by, wide, seam } = line;
        let layer = line.layer();
        let (first, last) = (nearest(a.1 - wide - 0.5), nearest(b.1 + wide - 0.5));
        let (from, to) = (nearest(a.1), nearest(b.1));
        let reach = wide * slope.abs() + wide;
        // The column where the edge passes the middle of a row, and how far to both sides it touches the row.
        let mut x = a.0 + (f64::from(first) - a.1) * slope + 0.5 * slope;
        let half = 0.5 * slope.abs() + reach;
        for row in first..=last {
            let (lo, hi) = (x - half, x + half);
            let lo = nearest(if lo > left { lo } else { left } - 0.5);
            let hi = nearest(if hi < right { hi } else { right } - 0.5);
            if lo <= hi {
                self.tiles.mark(row, lo, hi, layer);
            }
            if from <= row && row < to {
                self.pass(row, x, by, seam);
            }
            x += slope;
        }
    }

    /// Records that an edge passes the middle of a row at a place from -1 to the width of the area.
    #[inline]
    fn pass(&mut self, row: i32, at: f64, by: i16, seam: bool) {
        let (width, column) = (self.area.width(), nearest(at));
        // Where a seam passes the very middle of a pixel, its two patches may both count the pixel, or neither.
        if seam && (at - f64::from(column)).abs() > 0.5 - EDGE {
            let (lo, hi) = ((column - 1).max(0), column.min(width - 1));
            if lo <= hi {
                self.tiles.mark(row, lo, hi, Marks::OPEN);
            }
        }
        if column < width {
            self.steps.push(row, column.max(0), by);
        }
    }
}

/// A number clamped between -1 and a greatest one; -1 if it is not a number.
#[inline]
fn within(v: f64, most: f64) -> f64 {
    let v = if v > -1.0 { v } else { -1.0 };
    if v < most { v } else { most }
}

/// The integer nearest to a number below 2^31, halves to even. `nearest(v - 0.5)` is the floor of `v`, except
/// that odd integers go down by one.
///
/// Adding 1.5 * 2^52 leaves no digits after the point: the integer is in the low bits. That is quicker than a
/// conversion, which rounds towards zero.
#[inline]
fn nearest(v: f64) -> i32 {
    (v + 6_755_399_441_055_744.0).to_bits() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_integers() {
        for v in [-7.6, -0.5, -0.2, 0.0, 0.49, 0.5, 1.5, 2.5, 1e6 + 0.4] {
            assert_eq!(f64::from(nearest(v)), f64::round_ties_even(v));
        }
        assert_eq!((nearest(3.999 - 0.5), nearest(4.0 - 0.5), nearest(5.0 - 0.5)), (3, 4, 4));
        assert_eq!((within(f64::NAN, 5.0), within(9.0, 5.0), within(2.0, 5.0)), (-1.0, 5.0, 2.0));
    }
}
