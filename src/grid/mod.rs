//! The regular grid: where its cells lie and which cell contains a point. It has no border.
//!
//! All grid planes are exact `f64` numbers (see [`Grid::new`]), and every
//! decision about cells compares coordinates with those planes, so that
//! neighbouring cells share their face exactly and no rounding lies between.

pub(crate) mod bricks;
pub(crate) mod cell_box;
pub(crate) mod extent;
pub(crate) mod mask;
pub(crate) mod run;
pub(crate) mod side;

use glam::{DVec3, IVec3};

use crate::error::Error;
use crate::geometry::Aabb;
use crate::grid::mask::BRICK;

/// Cells have coordinates from minus this to this, without the last. Objects beyond are found by
/// every query.
pub(crate) const REACH: i32 = 1 << 20;

/// Advice has this many cells along the longest axis for each unit of the cube root of the number
/// of objects.
const CELLS_OF_CUBE_ROOT: f64 = 9.0;

/// And cells so large that the farthest corner is at most this many of them from the origin, so that
/// all is within [`REACH`].
const FARTHEST_CELLS: f64 = (1 << 18) as f64;

/// Cells are numbered anew by multiples of this many.
const RENUMBERED: f64 = 512.0;

/// Coordinates beyond this many cells from the grid's corner are clamped: far enough to be outside,
/// and small enough that sums and differences of any two cells fit 32 bits.
const FAR_CELLS: f64 = (1u64 << 29) as f64;

/// Corners are at most this many units from the origin.
const MOST_UNITS: f64 = (1u64 << 51) as f64;

/// The last binary digit of a cell size, at most 2^-23 of it.
fn unit_of(cell: f32) -> f64 {
    2f64.powi(cell.to_bits().wrapping_shr(23) as i32 - 127 - 23)
}

/// An edge length of cells that suits a level with a number of objects: 9 times the cube root of
/// that number along the longest axis, 32 to 512; and at most 2^18 from the origin.
///
/// The thesis' "solution point" (section 4.6): coarser cells list more objects each, finer ones
/// take longer to walk. [`crate::Method::Point`] walks bricks of 8x8x8 cells, so that it
/// matters less. Where most objects move and are hidden, finer may be faster.
///
/// ```
/// use casca::{Aabb, Scene, cell_for};
/// use glam::Vec3;
///
/// # fn main() -> Result<(), casca::Error> {
/// let level = Aabb::new(Vec3::ZERO, Vec3::new(100.0, 20.0, 60.0));
/// let cell = cell_for(level, 5000)?;
/// assert!((0.64..0.66).contains(&cell));
/// # let _ = Scene::new(cell)?;
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// Refuses a level that is not finite or inverted, and one in which a cell is no normal number.
pub fn cell_for(level: Aabb, objects: usize) -> Result<f32, Error> {
    level.check("the level")?;
    let cells = (CELLS_OF_CUBE_ROOT * (objects as f64).cbrt()).round().clamp(32.0, 512.0);
    let (min, max) = (level.min.as_dvec3(), level.max.as_dvec3());
    let farthest = min.abs().max(max.abs()).max_element();
    let cell = ((max - min).max_element() / cells).max(farthest / FARTHEST_CELLS) as f32;
    Grid::new(cell).map(|_| cell)
}

/// Whether cells in all directions around a cell have coordinates.
pub(crate) fn reaches(cell: IVec3) -> bool {
    cell.cmpge(IVec3::splat(-REACH)).all() && cell.cmplt(IVec3::splat(REACH)).all()
}

/// A grid whose planes are exact. Cells have integer coordinates; the least corner of cell 0 is the
/// origin, until that is shifted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    origin: DVec3,
    cell: f64,
}

impl Grid {
    /// The grid with cells of edge `cell`, in world units.
    ///
    /// Corner and planes are multiples of the cell size's last binary digit, at most 2^-23 of it,
    /// and below 2^52 times that, so `corner + i * cell` is exact.
    ///
    /// # Errors
    /// Refuses cell sizes that are not positive normal numbers.
    pub fn new(cell: f32) -> Result<Self, Error> {
        if !(cell.is_normal() && cell > 0.0) {
            return Err(Error::CellSize(cell));
        }
        Ok(Self { origin: DVec3::ZERO, cell: f64::from(cell) })
    }

    /// The grid in coordinates that are greater by an offset, with its corner snapped down by at most
    /// two units of [`Grid::unit`]; and whether cells keep their numbers. Where cell 0 would be far
    /// away, another one becomes it.
    ///
    /// # Errors
    /// Refuses a corner that would be more than about 2^28 cells from the origin.
    pub(crate) fn shifted(&self, by: DVec3) -> Result<(Self, bool), Error> {
        let unit = self.unit();
        let units = ((self.origin + by) / unit).floor();
        if units.abs().max_element() > MOST_UNITS {
            return Err(Error::GridTooFar { min: (units * unit).as_vec3(), cell: self.cell as f32 });
        }
        let corner = units * unit;
        let blocks = (-corner / (self.cell * RENUMBERED)).floor() * RENUMBERED;
        let far = blocks.abs().cmpgt(DVec3::splat(FARTHEST_CELLS));
        let renumbered = DVec3::select(far, blocks, DVec3::ZERO);
        Ok((Self { origin: corner + renumbered * self.cell, ..*self }, !far.any()))
    }

    /// The last binary digit of the cell size: all planes are multiples of it.
    pub(crate) fn unit(&self) -> f64 {
        unit_of(self.cell as f32)
    }

    /// The grid of bricks of 8x8x8 cells. Its planes are planes of this grid, just as exact.
    pub(crate) fn bricks(&self) -> Self {
        Self { origin: self.origin, cell: self.cell * f64::from(BRICK) }
    }

    /// The least corner of cell 0, in world units.
    pub fn min(&self) -> DVec3 {
        self.origin
    }

    /// Edge length of a cell.
    pub fn cell_size(&self) -> f64 {
        self.cell
    }

    /// World coordinate of plane `i` along `axis`: the lower face of cell `i`.
    pub(crate) fn plane(&self, axis: usize, i: i32) -> f64 {
        self.origin[axis] + f64::from(i) * self.cell
    }

    /// The corners of a cell.
    pub fn cell_bounds(&self, cell: IVec3) -> (DVec3, DVec3) {
        self.range_bounds(cell, cell)
    }

    /// The corners of the block of cells from `lo` to `hi`, both included.
    pub(crate) fn range_bounds(&self, lo: IVec3, hi: IVec3) -> (DVec3, DVec3) {
        (self.origin + lo.as_dvec3() * self.cell, self.origin + (hi + 1).as_dvec3() * self.cell)
    }

    /// The cell that contains `point`; a point on a face belongs to the upper cell.
    /// Coordinates saturate 2^29 cells away.
    pub fn cell_of(&self, point: DVec3) -> IVec3 {
        IVec3::from_array([0, 1, 2].map(|axis| self.cell_along(axis, point[axis])))
    }

    /// [`Grid::cell_of`] along one axis.
    pub(crate) fn cell_along(&self, axis: usize, p: f64) -> i32 {
        let guess = ((p - self.origin[axis]) / self.cell).clamp(-FAR_CELLS, FAR_CELLS);
        // The floor: not every processor has an instruction for it.
        let toward_zero = guess as i32;
        let i = toward_zero - i32::from(f64::from(toward_zero) > guess);
        // The quotient may be off by one rounding: the planes decide.
        if self.plane(axis, i) > p && f64::from(i) > -FAR_CELLS {
            i - 1
        } else if self.plane(axis, i + 1) <= p && f64::from(i) < FAR_CELLS {
            i + 1
        } else {
            i
        }
    }

    /// The least block of cells whose closed cells cover the box from `min` to
    /// `max`: a box that ends on a face does not reach into the next cell.
    pub(crate) fn cover(&self, min: DVec3, max: DVec3) -> (IVec3, IVec3) {
        let x = self.cover_along(0, min.x, max.x);
        let y = self.cover_along(1, min.y, max.y);
        let z = self.cover_along(2, min.z, max.z);
        (IVec3::new(x.0, y.0, z.0), IVec3::new(x.1, y.1, z.1))
    }

    /// As [`Grid::cover`], along one axis.
    pub(crate) fn cover_along(&self, axis: usize, min: f64, max: f64) -> (i32, i32) {
        let lo = self.cell_along(axis, min);
        let hi = self.cell_along(axis, max).max(lo);
        if hi > lo && self.plane(axis, hi) >= max { (lo, hi - 1) } else { (lo, hi) }
    }

    /// The cells wholly inside the box from `min` to `max`; `None` if there is none.
    pub(crate) fn inside(&self, min: DVec3, max: DVec3) -> Option<(IVec3, IVec3)> {
        let x = self.inside_along(0, min.x, max.x);
        let y = self.inside_along(1, min.y, max.y);
        let z = self.inside_along(2, min.z, max.z);
        clip(IVec3::new(x.0, y.0, z.0), IVec3::new(x.1, y.1, z.1))
    }

    /// As [`Grid::inside`], along one axis; the last comes before the first where there is none.
    pub(crate) fn inside_along(&self, axis: usize, min: f64, max: f64) -> (i32, i32) {
        let (lo, hi) = (self.cell_along(axis, min), self.cell_along(axis, max));
        (
            if self.plane(axis, lo) < min { lo + 1 } else { lo },
            if self.plane(axis, hi + 1) > max { hi - 1 } else { hi },
        )
    }
}

/// The part of a block of cells within [`REACH`]; `None` if there is none.
pub(crate) fn clip(lo: IVec3, hi: IVec3) -> Option<(IVec3, IVec3)> {
    let (lo, hi) = (lo.max(IVec3::splat(-REACH)), hi.min(IVec3::splat(REACH - 1)));
    lo.cmple(hi).all().then_some((lo, hi))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn refuses_what_is_no_grid() {
        for cell in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-45] {
            assert!(matches!(Grid::new(cell), Err(Error::CellSize(_))), "{cell}");
        }
        let far = Grid::new(1.0).unwrap().shifted(DVec3::splat(1e30));
        assert!(matches!(far, Err(Error::GridTooFar { .. })));
    }

    #[test]
    fn planes_are_exact_and_cells_meet() {
        for (min, cell) in [(-50.0, 1.0), (1e6, 0.1), (-0.3, 0.1), (123.456, 0.0625), (1e-20, 3.7f32)] {
            let g = Grid::new(cell).unwrap().shifted(DVec3::splat(min)).unwrap().0;
            for i in [0, 1, 17, 999, 4999] {
                let p = g.plane(0, i + 1) - g.plane(0, i);
                assert_eq!(p, f64::from(cell), "{min} {cell} {i}");
                assert_eq!(g.cell_of(DVec3::splat(g.plane(0, i))).x, i);
                let below = f64::from_bits(g.plane(0, i + 1).to_bits() - 1);
                if g.plane(0, i + 1) > 0.0 {
                    assert_eq!(g.cell_of(DVec3::splat(below)).x, i);
                }
            }
        }
    }

    #[test]
    fn cover_and_inside() {
        let g = Grid::new(1.0).unwrap();
        let cover = g.cover(DVec3::splat(1.0), DVec3::new(2.0, 2.5, 1.0));
        assert_eq!(cover, (IVec3::ONE, IVec3::new(1, 2, 1)));
        let inside = g.inside(DVec3::splat(0.5), DVec3::splat(3.0));
        assert_eq!(inside, Some((IVec3::ONE, IVec3::splat(2))));
        assert_eq!(g.inside(DVec3::splat(0.5), DVec3::splat(1.5)), None);
        assert_eq!(
            g.inside(DVec3::splat(-5.0), DVec3::splat(50.0)),
            Some((IVec3::splat(-5), IVec3::splat(49)))
        );
        assert_eq!(g.cell_of(DVec3::splat(1e300)), IVec3::splat(1 << 29));
        assert_eq!(g.cell_of(DVec3::splat(-1e300)), IVec3::splat(-(1 << 29)));
    }

    #[test]
    fn advice_reaches_all_of_a_level() {
        for (lo, hi) in [(0.0, 10.0), (-3.3, 7.7), (1e6, 1e6 + 1.0), (-1e30, 1e30), (0.0, 1e-20)] {
            let cell = cell_for(Aabb { min: Vec3::splat(lo), max: Vec3::splat(hi) }, 1000).unwrap();
            let grid = Grid::new(cell).unwrap();
            assert!([lo, hi].iter().all(|v| reaches(grid.cell_of(DVec3::splat(f64::from(*v))))), "{lo} {hi}");
        }
        assert!(cell_for(Aabb { min: Vec3::ZERO, max: Vec3::ZERO }, 1000).is_err());
        assert!(cell_for(Aabb { min: Vec3::ZERO, max: Vec3::splat(f32::NAN) }, 1000).is_err());
    }
}
