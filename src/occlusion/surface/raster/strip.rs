//! Strips around edges, whose pixels are only marked.

use crate::numeric::occlusion::{EDGE_FLAT, EDGE_ROUNDING};
use crate::occlusion::pixels::nearest_integer;
use crate::occlusion::surface::raster::{PixelMarks, Raster};

impl Raster {
    /// Marks the pixels that come within `across` of the line through two points, given in pixels,
    /// and along each axis within `around` of the rectangle of the two.
    pub(crate) fn strip(&mut self, from: (f64, f64), to: (f64, f64), across: f64, around: f64) {
        let corner = (f64::from(self.corner.0), f64::from(self.corner.1));
        let (a, b) = ((from.0 - corner.0, from.1 - corner.1), (to.0 - corner.0, to.1 - corner.1));
        let rounding = EDGE_ROUNDING * (a.0.abs() + a.1.abs() + b.0.abs() + b.1.abs());
        let (across, around) = (across + 2.0 * rounding, around + rounding);
        let (a, b) = if a.1 <= b.1 { (a, b) } else { (b, a) };
        let (left, right) =
            if a.0 <= b.0 { (a.0 - around, b.0 + around) } else { (b.0 - around, a.0 + around) };
        let (width, height) = (self.area.width(), self.area.height());
        let (most_x, most_y) = (f64::from(width), f64::from(height));
        let first = nearest_integer(within(a.1 - around, most_y) - 0.5).max(0);
        let last = nearest_integer(within(b.1 + around, most_y) - 0.5).min(height - 1);
        // Numbers that overflowed say nothing of where the strip is.
        if (left + right + a.1 + b.1 + across + around).is_nan() {
            return self.open_all();
        }
        let slope = (b.0 - a.0) / (b.1 - a.1);
        let is_flat = slope.is_nan() || slope.abs() >= EDGE_FLAT;
        let column = |x: f64| nearest_integer(within(x, most_x) - 0.5);
        let (begin, end) = (column(left).max(0), column(right).min(width - 1));
        // Rims of one place have strips that lie over each other.
        if first > last || begin > end || self.are_open((first, last), (begin, end)) {
            return;
        }
        let reach = across * (1.0 + slope * slope).sqrt();
        for row in first..=last {
            let (mut lo, mut hi) = (left, right);
            if !is_flat {
                // Where the line passes the lower border of the row, and the upper one.
                let x = a.0 + (f64::from(row) - a.1) * slope;
                let (least, most) = if slope > 0.0 { (x, x + slope) } else { (x + slope, x) };
                (lo, hi) = (lo.max(least - reach), hi.min(most + reach));
            }
            let (lo, hi) = (column(lo).max(0), column(hi).min(width - 1));
            if lo <= hi {
                self.mark(row, lo, hi, PixelMarks::OPEN);
            }
        }
    }
}

/// A number clamped between -1 and a greatest one; -1 if it is not a number.
#[inline]
fn within(v: f64, most: f64) -> f64 {
    let v = if v > -1.0 { v } else { -1.0 };
    if v < most { v } else { most }
}
