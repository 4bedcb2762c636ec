//! Rays that advance row by row without rounding, and what takes the tiles between them.

use crate::numeric::tiles::TILE;
use crate::tiles::octant::Slope;

/// What takes the tiles that a sweep reaches. Rows and columns are those of the octant.
pub(super) trait Sink {
    /// The next calls are about this row.
    fn begin_row(&mut self, row: usize);
    /// The tiles `from..end` are seen. `from < end`.
    fn seen(&mut self, from: usize, end: usize);
}

/// A ray from the eye, where it crosses the lower border of a row: at `column + rest / whole`.
///
/// `0 <= rest < whole`, and `0 <= step <= whole`: slopes are at most 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    pub column: i64,
    rest: i64,
    whole: i64,
    /// How far it goes aside in a row, in parts of `whole`.
    step: i64,
}

impl Ray {
    /// The ray of a slope, `ahead` units before the eye. The slope is at most 1.
    pub fn new(slope: Slope, eye: i64, ahead: i64) -> Self {
        let whole = i128::from(slope.y) * i128::from(TILE);
        let at = i128::from(eye) * i128::from(slope.y) + i128::from(slope.x) * i128::from(ahead);
        Self {
            column: at.div_euclid(whole) as i64,
            rest: at.rem_euclid(whole) as i64,
            whole: whole as i64,
            step: slope.x * TILE,
        }
    }

    /// The ray through a corner, at that corner: so far aside of the eye, and so far ahead.
    #[inline(always)]
    pub fn through(column: usize, aside: i64, ahead: i64) -> Self {
        Self { column: column as i64, rest: 0, whole: ahead, step: aside }
    }

    /// The ray a row further.
    #[inline(always)]
    pub fn advanced(self) -> Self {
        let rest = self.rest + self.step;
        let over = rest >= self.whole;
        Self {
            column: self.column + i64::from(over),
            rest: if over { rest - self.whole } else { rest },
            ..self
        }
    }

    /// A ray that is left of two, or on them, from here on.
    pub fn leftmost(self, other: Self) -> Self {
        let flat = if self.is_flatter(other) { other } else { self };
        Self::through(self.column.min(other.column) as usize, flat.step, flat.whole)
    }

    /// A ray that is right of two, or on them, from here on.
    pub fn rightmost(self, other: Self) -> Self {
        let flat = if self.is_flatter(other) { self } else { other };
        Self::through(self.end().max(other.end()) as usize, flat.step, flat.whole)
    }

    /// Whether the slope of a ray is greater than that of another.
    fn is_flatter(self, other: Self) -> bool {
        i128::from(self.step) * i128::from(other.whole) > i128::from(other.step) * i128::from(self.whole)
    }

    /// The column after the last one that begins before the ray.
    #[inline(always)]
    pub fn end(self) -> i64 {
        self.column + i64::from(self.rest != 0)
    }
}

/// The rays of one eye between two, without these.
pub(super) type Beam = (Ray, Ray);
