//! The regular grid: where its cells lie and which cell contains a point.
//!
//! All grid lines are exact `f64` numbers (see [`Grid::new`]), so that neighbouring cells share
//! their side exactly.

use glam::{DVec2, IVec2, UVec2, Vec2};

use crate::error::{Error, finite2, within};
use crate::geometry::Rect;

/// Greatest number of cells along one axis.
pub const MAX_CELLS_PER_AXIS: u32 = 8192;

/// Coordinates beyond this many cells from the grid's corner are clamped: far enough to be outside,
/// and small enough that sums and differences of any two cells fit 32 bits.
const FAR_CELLS: f64 = (1u64 << 29) as f64;

/// The measures of a grid: a corner, the edge length of its square cells and how many of them lie
/// along each axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridSpec {
    /// Least corner in world units.
    pub min: Vec2,
    /// Edge length of a cell in world units.
    pub cell: f32,
    /// Cells along x and y: 1 to [`MAX_CELLS_PER_AXIS`] each.
    pub dims: UVec2,
}

impl GridSpec {
    /// The grid with cells of edge `cell`, in world units, that covers `region`.
    ///
    /// # Errors
    /// Refuses a region that is not finite or inverted, a cell size that is not positive, and a
    /// region that needs more than [`MAX_CELLS_PER_AXIS`] cells along an axis.
    pub fn covering(region: Rect, cell: f32) -> Result<Self, Error> {
        region.check("the region")?;
        cell_size(cell)?;
        let extent = region.max.as_dvec2() - region.min.as_dvec2();
        let dims = (extent / f64::from(cell)).ceil().max(DVec2::ONE);
        // Numbers beyond the integers saturate, and are refused below.
        let spec = Self { min: region.min, cell, dims: dims.as_uvec2() };
        let grid = Grid::new(&spec)?;
        // The corner is snapped down by less than a cell: one more may be needed.
        let short = region.max.as_dvec2().cmpgt(grid.max());
        let spec = Self { dims: spec.dims + UVec2::new(short.x.into(), short.y.into()), ..spec };
        Grid::new(&spec)?;
        Ok(spec)
    }
}

/// A grid whose lines are exact. Cells have integer coordinates from 0; a cell outside the grid has
/// coordinates below 0 or from [`Grid::dims`] on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Grid {
    /// Least corner in world units.
    pub(crate) min: DVec2,
    /// Edge length of a cell.
    pub(crate) cell: f64,
    /// Cells along each axis.
    pub(crate) dims: IVec2,
}

impl Grid {
    /// Checks `spec` and computes the grid's lines.
    ///
    /// The corner is snapped down to a multiple of the cell size's last binary digit (at most 2^-23
    /// of a cell). Corner and lines are then multiples of one power of two below 2^52 times it, so
    /// `corner + i * cell` is exact.
    ///
    /// # Errors
    /// Refuses corners that are not finite, cell sizes that are not positive normal numbers, 0 or
    /// more than [`MAX_CELLS_PER_AXIS`] cells, and corners more than about 2^28 cells from the
    /// origin.
    pub(crate) fn new(spec: &GridSpec) -> Result<Self, Error> {
        finite2("the grid's corner", spec.min)?;
        let cell = cell_size(spec.cell)?;
        for cells in spec.dims.to_array() {
            within("the number of cells along an axis", cells.into(), [1.0, MAX_CELLS_PER_AXIS.into()])?;
        }
        let unit = 2f64.powi((spec.cell.to_bits() >> 23) as i32 - 127 - 23);
        let units = (spec.min.as_dvec2() / unit).floor();
        if units.abs().max_element() > 2f64.powi(51) {
            return Err(Error::GridTooFar { min: spec.min, cell: spec.cell });
        }
        Ok(Self { min: units * unit, cell, dims: spec.dims.as_ivec2() })
    }

    /// Greatest corner in world units.
    pub(crate) fn max(&self) -> DVec2 {
        self.min + self.dims.as_dvec2() * self.cell
    }

    /// World coordinate of line `i` across `axis`: the lower side of cell `i`.
    pub(crate) fn line(&self, axis: usize, i: i32) -> f64 {
        self.min[axis] + f64::from(i) * self.cell
    }

    /// The least and the greatest corner of a cell.
    pub(crate) fn cell_bounds(&self, cell: IVec2) -> (DVec2, DVec2) {
        (self.min + cell.as_dvec2() * self.cell, self.min + (cell + 1).as_dvec2() * self.cell)
    }

    /// The cell that contains `point`, inside the grid or not; a point on a side belongs to the
    /// upper cell. Coordinates saturate 2^29 cells away.
    pub(crate) fn cell_of(&self, point: DVec2) -> IVec2 {
        IVec2::new(self.cell_along(0, point.x), self.cell_along(1, point.y))
    }

    /// [`Grid::cell_of`] along one axis.
    pub(crate) fn cell_along(&self, axis: usize, p: f64) -> i32 {
        let guess = ((p - self.min[axis]) / self.cell).clamp(-FAR_CELLS, FAR_CELLS).floor();
        let i = guess as i32;
        // The quotient may be off by one rounding: the lines decide.
        if self.line(axis, i) > p && guess > -FAR_CELLS {
            i - 1
        } else if self.line(axis, i + 1) <= p && guess < FAR_CELLS {
            i + 1
        } else {
            i
        }
    }

    /// Whether the closed rectangle from `min` to `max` lies in the interior of the grid.
    pub(crate) fn surrounds(&self, min: DVec2, max: DVec2) -> bool {
        min.cmpgt(self.min).all() && max.cmplt(self.max()).all()
    }
}

/// Refuses a size of cells that is no positive normal number.
fn cell_size(cell: f32) -> Result<f64, Error> {
    within("the cell size", cell.into(), [f32::MIN_POSITIVE, f32::MAX].map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_what_is_no_grid() {
        let spec = |min, cell, dims| Grid::new(&GridSpec { min, cell, dims });
        let ok = UVec2::splat(4);
        assert!(matches!(spec(Vec2::splat(f32::NAN), 1.0, ok), Err(Error::NotFinite { .. })));
        for cell in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-45] {
            assert!(matches!(spec(Vec2::ZERO, cell, ok), Err(Error::Range { .. })), "{cell}");
        }
        assert!(matches!(spec(Vec2::ZERO, 1.0, UVec2::new(4, 0)), Err(Error::Range { .. })));
        assert!(matches!(spec(Vec2::ZERO, 1.0, UVec2::MAX), Err(Error::Range { .. })));
        assert!(matches!(spec(Vec2::splat(1e30), 1.0, ok), Err(Error::GridTooFar { .. })));
    }

    #[test]
    fn lines_are_exact_and_cells_meet() {
        for (min, cell) in [(-50.0, 1.0), (1e6, 0.1), (-0.3, 0.1), (123.456, 0.0625), (1e-20, 3.7)] {
            let g = Grid::new(&GridSpec { min: Vec2::splat(min), cell, dims: UVec2::splat(5000) }).unwrap();
            for i in [0, 1, 17, 999, 4999] {
                assert_eq!(g.line(0, i + 1) - g.line(0, i), f64::from(cell), "{min} {cell} {i}");
                assert_eq!(g.cell_of(DVec2::splat(g.line(0, i))).x, i);
                assert_eq!(g.cell_of(DVec2::splat(g.line(0, i + 1).next_down())).x, i);
            }
        }
        let g = Grid::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(9) }).unwrap();
        assert_eq!(g.cell_of(DVec2::new(1e300, -1e300)), IVec2::new(1 << 29, -(1 << 29)));
    }

    #[test]
    fn covering_holds_its_region() {
        for (lo, hi, cell) in [(0.0, 10.0, 1.0), (-3.3, 7.7, 0.1), (1000.1, 1000.2, 0.05), (5.0, 5.0, 1.0)] {
            let spec = GridSpec::covering(Rect::new(Vec2::splat(lo), Vec2::splat(hi)), cell).unwrap();
            let g = Grid::new(&spec).unwrap();
            assert!(g.min.x <= f64::from(lo) && g.max().x >= f64::from(hi), "{spec:?}");
        }
        let huge = Rect::new(Vec2::splat(-3e38), Vec2::splat(3e38));
        assert!(GridSpec::covering(huge, 1e-30).is_err());
    }
}
