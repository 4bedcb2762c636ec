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

/// Cells of a grid that make a box, found by [`Cells::of_box`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CellBox {
    low: [u32; 3],
    high: [u32; 3],
}

impl CellBox {
    /// How many there are.
    #[inline]
    pub fn count(&self) -> u64 {
        (0..3).map(|i| u64::from(self.high[i] - self.low[i]) + 1).product()
    }
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

    /// The number of cells; `None` beyond 2^32 - 1.
    pub fn count(&self) -> Option<u32> {
        self.dims[0].checked_mul(self.dims[1])?.checked_mul(self.dims[2])
    }

    /// The number of the cell that holds a place, x running fastest; `None` outside of the grid.
    #[inline]
    pub fn at(&self, place: [f64; 3]) -> Option<u32> {
        Some(self.number(self.step(place)?))
    }

    /// The cells that hold the places in a box, from its least to its greatest corner; `None` if
    /// the box is inverted or not wholly in the grid. For each place in it, [`Cells::at`] is one of
    /// them: that divides the same difference, and roundings keep the order of numbers.
    #[inline]
    pub fn of_box(&self, low: [f64; 3], high: [f64; 3]) -> Option<CellBox> {
        let all = CellBox { low: self.step(low)?, high: self.step(high)? };
        (0..3).all(|i| low[i] <= high[i]).then_some(all)
    }

    /// The numbers of the cells of a box, ascending.
    pub fn numbers(&self, all: CellBox) -> impl Iterator<Item = u32> + Clone + use<> {
        let grid = *self;
        let CellBox { low, high } = all;
        let rows = (low[2]..=high[2]).flat_map(move |z| (low[1]..=high[1]).map(move |y| [y, z]));
        rows.flat_map(move |[y, z]| (low[0]..=high[0]).map(move |x| grid.number([x, y, z])))
    }

    /// The place of a cell along each axis.
    #[inline]
    fn step(&self, place: [f64; 3]) -> Option<[u32; 3]> {
        // There are not more cells than numbers.
        self.count()?;
        let mut cell = [0; 3];
        for i in 0..3 {
            let at = (place[i] - self.low[i]) / self.size[i];
            // Not a number is neither.
            if !(at >= 0.0 && at < f64::from(self.dims[i]) && place[i] <= self.high(i)) {
                return None;
            }
            cell[i] = at as u32;
        }
        Some(cell)
    }

    /// Where the grid ends along an axis.
    #[inline]
    fn high(&self, i: usize) -> f64 {
        self.low[i] + f64::from(self.dims[i]) * self.size[i]
    }

    #[inline]
    fn number(&self, [x, y, z]: [u32; 3]) -> u32 {
        (z * self.dims[1] + y) * self.dims[0] + x
    }

    /// The least and the greatest corner of a box that holds each place for which [`Cells::at`] is
    /// this cell, with room for its rounding: where eyes may be that use the set of the cell. It
    /// ends where the grid does. `None` if there is no such cell.
    pub fn room(&self, cell: u32) -> Option<([f64; 3], [f64; 3])> {
        let [x, y, _] = self.dims;
        if cell >= self.count()? {
            return None;
        }
        let at = [cell % x, cell / x % y, cell / x / y];
        let border = |i: usize, at: f64| (self.low[i] + at * self.size[i]).max(self.low[i]).min(self.high(i));
        let low = core::array::from_fn(|i| border(i, f64::from(at[i]) - ROUNDING));
        let high = core::array::from_fn(|i| border(i, f64::from(at[i]) + 1.0 + ROUNDING));
        Some((low, high))
    }
}
