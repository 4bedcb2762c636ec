//! Single edges in double precision.

use crate::numeric::occlusion::{EDGE_FLAT, EDGE_ROUNDING};
use crate::occlusion::pixels::nearest_integer;
use crate::occlusion::surface::raster::{PixelMarks, Raster};

impl Raster {
    /// Draws an edge of the outline between two points, in pixels. Going up, it makes the winding
    /// numbers to its right grow by one, or fall.
    ///
    /// `wide` is how far the outline may be from it; `unsure` is how far it may be from where its
    /// ends say for rounding alone, both in pixels; `seam` tells whether it is shared by two
    /// patches that are drawn together.
    pub(crate) fn edge(
        &mut self,
        from: (f64, f64),
        to: (f64, f64),
        falls: bool,
        (wide, unsure): (f64, f64),
        seam: bool,
    ) {
        let corner = (f64::from(self.corner.0), f64::from(self.corner.1));
        let (a, b) = ((from.0 - corner.0, from.1 - corner.1), (to.0 - corner.0, to.1 - corner.1));
        let rounding = EDGE_ROUNDING * (a.0.abs() + a.1.abs() + b.0.abs() + b.1.abs());
        let (wide, unsure) = (wide + rounding, unsure + rounding);
        // From the lower to the upper row.
        let (a, b, falls) = if a.1 <= b.1 { (a, b, falls) } else { (b, a, !falls) };
        let (x0, x1) = if a.0 <= b.0 { (a.0, b.0) } else { (b.0, a.0) };
        let (left, x1) = (x0 - wide, x1 + wide);
        let (width, height) = (self.area.width(), self.area.height());
        let (right, bottom) = (f64::from(width), f64::from(height));
        if b.1 + wide < 0.0 || a.1 - wide >= bottom || left >= right {
            return;
        }
        let slope = (b.0 - a.0) / (b.1 - a.1);
        let first = nearest_integer(within(a.1 - wide, bottom) - 0.5).max(0);
        let last = nearest_integer(within(b.1 + wide, bottom) - 0.5).min(height - 1);
        // Rows whose middles the edge passes. Neighbours share their ends, and so agree about the
        // rows.
        let (from, to) =
            (nearest_integer(within(a.1, bottom)).max(0), nearest_integer(within(b.1, bottom)).min(height));
        if x1 < 0.0 {
            (from..to).for_each(|row| self.pass(row, 0, falls));
            return;
        }
        let layer = if seam { PixelMarks::SEAM } else { PixelMarks::OPEN };
        if slope.is_nan() || slope.abs() >= EDGE_FLAT {
            let layer = if from < to { PixelMarks::OPEN } else { layer };
            return self.edge_flat((left, x1), falls, layer, (first, last), (from, to));
        }
        let (reach, unsure) = (wide * slope.abs() + wide, unsure * slope.abs() + unsure);
        // The column where the edge passes the lower border of a row.
        let mut x = a.0 + (f64::from(first) - a.1) * slope;
        for row in first..=last {
            let next = x + slope;
            let (lo, hi) = if x <= next { (x - reach, next + reach) } else { (next - reach, x + reach) };
            let lo = nearest_integer(within(if lo > left { lo } else { left }, right) - 0.5).max(0);
            let hi = nearest_integer(within(if hi < x1 { hi } else { x1 }, right) - 0.5).min(width - 1);
            if lo <= hi {
                self.mark(row, lo, hi, layer);
            }
            if from <= row && row < to {
                let at = x + 0.5 * slope;
                // Where it is not known on which side of a middle a seam passes, its two patches
                // may both count the pixel, or neither.
                let lo = nearest_integer(within(at - unsure, right) - 0.5).max(0);
                let hi = nearest_integer(within(at + unsure, right) - 0.5).min(width - 1);
                let column = nearest_integer(within(at, right));
                if seam && lo <= hi && (at - f64::from(column)).abs() > 0.5 - unsure {
                    self.mark(row, lo, hi, PixelMarks::OPEN);
                }
                if column < width {
                    self.pass(row, column.max(0), falls);
                }
            }
            x = next;
        }
    }

    /// Draws an edge that is nearly parallel to the rows: it touches rows `first` to `last`, and
    /// passes the middles of `from` to before `to`.
    ///
    /// Where it passes them is not known well enough: all of its pixels count as touched, and if it
    /// passes any middle, as touched by an open edge, since two patches would not agree.
    fn edge_flat(
        &mut self,
        (left, x1): (f64, f64),
        falls: bool,
        layer: usize,
        (first, last): (i32, i32),
        (from, to): (i32, i32),
    ) {
        let width = self.area.width();
        let right = f64::from(width);
        let lo = nearest_integer(within(left, right) - 0.5).max(0);
        let hi = nearest_integer(within(x1, right) - 0.5).min(width - 1);
        for row in first..=last {
            if lo <= hi {
                self.mark(row, lo, hi, layer);
            }
        }
        if lo < width {
            (from..to).for_each(|row| self.pass(row, lo, falls));
        }
    }
}

/// A number clamped between -1 and a greatest one; -1 if it is not a number.
#[inline]
pub(super) fn within(v: f64, most: f64) -> f64 {
    let v = if v > -1.0 { v } else { -1.0 };
    if v < most { v } else { most }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_clamped() {
        assert_eq!((within(f64::NAN, 5.0), within(9.0, 5.0), within(2.0, 5.0)), (-1.0, 5.0, 2.0));
    }
}
