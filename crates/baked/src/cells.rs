//! The grid of cells.

/// A grid of boxes in which eyes may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cells {
    /// Least corner, in world units.
    pub low: [f64; 3],
    /// Edges of a cell, in world units.
    pub size: [f64; 3],
    /// Cells along each axis.
    pub dims: [u32; 3],
}

/// What roundings in [`Cells::at`] and [`Cells::room`] come to in cells, at most. The first divides
/// a difference: two halves of an epsilon of less than 2^21 cells, 1e-9. The second adds to a
/// corner that lies up to 2^30 cells from the origin: 3e-7.
const ROUNDING: f64 = 1e-6;

/// The most cells along an axis.
const MOST: u32 = 1 << 21;

/// The grid lies so many cells from the origin at most, or the origin in it.
const FARTHEST: f64 = (1u64 << 30) as f64;

impl Cells {
    /// Whether the numbers make a grid.
    pub(crate) fn is_valid(&self) -> bool {
        let axis = |i: usize| {
            let (low, size, dims) = (self.low[i], self.size[i], self.dims[i]);
            size.is_normal()
                && size > 0.0
                && low.is_finite()
                && (low / size).abs() <= FARTHEST
                && (1..=MOST).contains(&dims)
        };
        // Numbers of cells are of 32 bits, and one stands for none.
        (0..3).all(axis) && self.count().is_some_and(|count| count < u32::MAX)
    }

    /// The number of cells.
    pub(crate) fn count(&self) -> Option<u32> {
        self.dims[0].checked_mul(self.dims[1])?.checked_mul(self.dims[2])
    }

    /// The number of the cell that holds a place, x running fastest; `None` outside of the grid.
    pub fn at(&self, place: [f64; 3]) -> Option<u32> {
        let mut cell = [0; 3];
        for i in 0..3 {
            let at = (place[i] - self.low[i]) / self.size[i];
            // Not a number is neither.
            if !(at >= 0.0 && at < f64::from(self.dims[i])) {
                return None;
            }
            cell[i] = at as u32;
        }
        Some((cell[2] * self.dims[1] + cell[1]) * self.dims[0] + cell[0])
    }

    /// The least and the greatest corner of a box that holds each place for which [`Cells::at`] is
    /// this cell, with room for its rounding: where eyes may be that use the set of the cell.
    /// `None` if there is no such cell.
    pub fn room(&self, cell: u32) -> Option<([f64; 3], [f64; 3])> {
        let [x, y, _] = self.dims;
        if cell >= self.count()? {
            return None;
        }
        let at = [cell % x, cell / x % y, cell / x / y];
        let low = core::array::from_fn(|i| self.low[i] + (f64::from(at[i]) - ROUNDING) * self.size[i]);
        let high = core::array::from_fn(|i| self.low[i] + (f64::from(at[i]) + 1.0 + ROUNDING) * self.size[i]);
        Some((low, high))
    }
}
