//! The lattice lines of a shell and the pixels of a direction mask.

use crate::numeric::query::MASK;

/// How the cells of one shell map to the pixels of a mask with 2^log pixels
/// along each side.
#[derive(Debug, Clone, Copy)]
pub(super) struct ShellScale {
    m: i64,
    log: u32,
    /// 1 / 2m.
    inverse: f64,
    /// The eye may be this far outside V, in cells across, doubled for the way in depth.
    slack: f64,
}

impl ShellScale {
    pub(super) fn new(m: i32, log: u32, slack: f64) -> Self {
        Self { m: i64::from(m), log, inverse: 0.5 / f64::from(m), slack }
    }

    /// Pixels along each side of a mask, as the power of two.
    pub(super) fn log(&self) -> u32 {
        self.log
    }

    /// The number of the shell.
    pub(super) fn shell(&self) -> i32 {
        self.m as i32
    }

    pub(super) fn size(&self) -> i64 {
        1 << self.log
    }

    /// floor(n / 2m) for n >= 0. (n + 1/2) / 2m is at least 1/4m away from every
    /// integer, far more than the rounding of the product.
    #[inline]
    fn divide(&self, n: i64) -> i64 {
        ((n as f64 + 0.5) * self.inverse) as i64
    }

    /// The pixel that contains the direction of the centre of lattice line `c`.
    #[inline]
    pub(super) fn pixel(&self, c: i32) -> i64 {
        self.divide((i64::from(c) + self.m) << self.log).min(self.size() - 1)
    }

    /// The first pixel that is at or beyond lattice line `c` as a whole.
    #[inline]
    pub(super) fn pixel_from(&self, c: i64) -> i64 {
        if self.slack > 0.0 {
            let at = ((c + self.m) as f64 + self.slack) * self.size() as f64 * self.inverse;
            return (at + MASK).ceil() as i64;
        }
        self.divide(((c + self.m) << self.log) + 2 * self.m - 1)
    }

    /// One past the last pixel that is at or before lattice line `c` as a whole.
    #[inline]
    pub(super) fn pixel_to(&self, c: i64) -> i64 {
        if self.slack > 0.0 {
            let at = ((c + self.m) as f64 - self.slack) * self.size() as f64 * self.inverse;
            return (at - MASK).floor() as i64;
        }
        self.divide((c + self.m) << self.log)
    }

    /// The first lattice line whose centre is in pixel `p` or later.
    #[inline]
    pub(super) fn line_from(&self, p: i64) -> i64 {
        ((2 * self.m * p + self.size() - 1) >> self.log) - self.m
    }

    /// The last lattice line whose centre is before pixel `p`.
    #[inline]
    pub(super) fn line_before(&self, p: i64) -> i64 {
        if p >= self.size() { self.m } else { self.line_from(p) - 1 }
    }

    /// The eye may be this far outside V, in whole cells across.
    pub(super) fn whole_slack(&self) -> i64 {
        self.slack.ceil() as i64
    }

    /// How far apart the lattice lines around a pixel are, at most.
    pub(super) fn spread(&self) -> usize {
        ((2 * self.m) >> self.log) as usize + 2 * self.slack.ceil() as usize + 4
    }

    /// The lattice lines around the directions of pixel `p`: of floor and ceiling.
    #[inline]
    pub(super) fn lines_around(&self, p: i64) -> (i64, i64) {
        if self.slack > 0.0 {
            let (a, b) = ((2 * self.m * p) as f64, (2 * self.m * (p + 1)) as f64);
            let size = self.size() as f64;
            let lo = (a / size - self.slack - MASK).floor() as i64;
            return (lo - self.m, (b / size + self.slack + MASK).ceil() as i64 - self.m);
        }
        let lo = (2 * self.m * p) >> self.log;
        let hi = (2 * self.m * (p + 1) + self.size() - 1) >> self.log;
        (lo - self.m, hi - self.m)
    }
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
}
