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
    /// From here solids were given in single precision, in world units: not the origin of the world
    /// where a level lies far from that.
    pub origin: [f64; 3],
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

/// Whoever finds sets may take eyes to be in a solid that are this near to it, as a share of the
/// greatest of their coordinates, counted from [`Cells::origin`]: four roundings to single
/// precision, in which solids are given.
pub const NEAR: f64 = 4.0 / (1 << 24) as f64;

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
                && self.origin[i].is_finite()
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

    /// The cells whose sets hold what eyes in a box see: those of [`Cells::of_box`], and their
    /// neighbours across borders that the box touches, or nearly does ([`NEAR`]). An eye on a
    /// border may lie on the face of a solid that begins there: the set of the cell with the solid
    /// holds what eyes behind it see.
    pub fn of_eyes(&self, low: [f64; 3], high: [f64; 3]) -> Option<CellBox> {
        let mut all = self.of_box(low, high)?;
        let farthest = self.farthest(low).max(self.farthest(high));
        for i in 0..3 {
            let near = self.near(i, farthest);
            // Beyond the grid, up to its border.
            all.low[i] = self.index(i, low[i] - near).unwrap_or(0);
            all.high[i] = self.index(i, high[i] + near).unwrap_or(self.dims[i] - 1);
        }
        Some(all)
    }

    /// Whether a place in the grid is so near to a border of its cell that eyes there may need
    /// other sets, too.
    #[inline]
    pub(crate) fn is_at_border(&self, place: [f64; 3]) -> bool {
        let farthest = self.farthest(place);
        (0..3).any(|i| {
            let at = (place[i] - self.low[i]) / self.size[i];
            let border = f64::from((at + 0.5) as u32);
            // Twice, against roundings: who is told so looks closer.
            (at - border).abs() * self.size[i] <= 2.0 * self.near(i, farthest)
        })
    }

    /// The greatest coordinate of a place, from the origin.
    #[inline]
    fn farthest(&self, place: [f64; 3]) -> f64 {
        let at = |i: usize| (place[i] - self.origin[i]).abs();
        at(0).max(at(1)).max(at(2))
    }

    /// How near to a border along an axis that is, for places with coordinates up to `farthest`.
    #[inline]
    fn near(&self, i: usize, farthest: f64) -> f64 {
        NEAR * farthest + ROUNDING * self.size[i]
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
        Some([self.index(0, place[0])?, self.index(1, place[1])?, self.index(2, place[2])?])
    }

    /// The place of a cell along one axis.
    #[inline]
    fn index(&self, i: usize, place: f64) -> Option<u32> {
        let at = (place - self.low[i]) / self.size[i];
        // Not a number is neither.
        (at >= 0.0 && at < f64::from(self.dims[i]) && place <= self.high(i)).then_some(at as u32)
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

    /// Whether a cell is in a box of them.
    pub(crate) fn is_in(&self, cell: u32, all: CellBox) -> bool {
        let at = self.place(cell);
        (0..3).all(|i| (all.low[i]..=all.high[i]).contains(&at[i]))
    }

    /// The place of a cell along each axis, from its number.
    fn place(&self, cell: u32) -> [u32; 3] {
        let [x, y, _] = self.dims;
        [cell % x, cell / x % y, cell / x / y]
    }

    /// The least and the greatest corner of a box that holds each place for which [`Cells::at`] is
    /// this cell, with room for its rounding: where eyes may be that use the set of the cell. It
    /// ends where the grid does. `None` if there is no such cell.
    pub fn room(&self, cell: u32) -> Option<([f64; 3], [f64; 3])> {
        if cell >= self.count()? {
            return None;
        }
        let at = self.place(cell);
        let border = |i: usize, at: f64| (self.low[i] + at * self.size[i]).max(self.low[i]).min(self.high(i));
        let low = core::array::from_fn(|i| border(i, f64::from(at[i]) - ROUNDING));
        let high = core::array::from_fn(|i| border(i, f64::from(at[i]) + 1.0 + ROUNDING));
        Some((low, high))
    }
}
