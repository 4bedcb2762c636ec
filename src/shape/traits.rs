//! Shapes against cells and boxes.

use glam::{DVec3, IVec3};

use crate::geometry::Block;
use crate::grid::run::{CellRun, rows_of};
use crate::grid::{Grid, REACH};

/// Which cells of a shape are asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Which {
    /// Those that may contain a point of it.
    Touched,
    /// Those wholly inside.
    Opaque,
}

/// A shape that can be written into the matrices of a grid.
pub trait Shape {
    /// Least and greatest corner of a box around the shape, in world units.
    fn bounds(&self) -> (DVec3, DVec3);

    /// Whether the box from `min` to `max` lies wholly inside the solid; in doubt, no.
    fn contains_box(&self, min: DVec3, max: DVec3) -> bool;

    /// Whether the point lies in the solid or on its surface; in doubt, yes.
    fn contains_point(&self, point: DVec3) -> bool;

    /// Whether its cells can be asked for anywhere, and all that contain a point of it are touched,
    /// among them those of its inside. Others are asked for all of their cells only.
    fn has_rows(&self) -> bool {
        true
    }

    /// Calls `out` with runs of the touched cells between `lo` and `hi`, which cover the shape
    /// there. No cell comes twice.
    fn touched_rows(&self, grid: &Grid, lo: IVec3, hi: IVec3, out: &mut dyn FnMut(CellRun)) {
        if let Some((a, b)) = self.corners(grid, Which::Touched) {
            rows_of(a.max(lo), b.min(hi), out);
        }
    }

    /// Calls `out` with runs of the cells between `lo` and `hi` that lie wholly inside the solid.
    /// No cell comes twice.
    fn opaque_rows(&self, grid: &Grid, lo: IVec3, hi: IVec3, out: &mut dyn FnMut(CellRun)) {
        if let Some((a, b)) = self.corners(grid, Which::Opaque) {
            rows_of(a.max(lo), b.min(hi), out);
        }
    }

    /// All cells of a kind.
    fn rows(&self, grid: &Grid, which: Which, out: &mut dyn FnMut(CellRun)) {
        let (lo, hi) = (IVec3::splat(-REACH), IVec3::splat(REACH - 1));
        match which {
            Which::Touched => self.touched_rows(grid, lo, hi, out),
            Which::Opaque => self.opaque_rows(grid, lo, hi, out),
        }
    }

    /// The first and the last of the cells asked for, where those are all between them, as for a
    /// box. There are none if the last one comes before the first along an axis. Other shapes tell
    /// their rows.
    fn corners(&self, _: &Grid, _: Which) -> Option<(IVec3, IVec3)> {
        None
    }

    /// Whether the box from `min` to `max` contains no point of the shape; in doubt, no.
    fn misses(&self, min: DVec3, max: DVec3) -> bool {
        !Block::new(self.bounds()).meets(&Block { min, max })
    }

    /// Whether all cells in the box from `min` to `max` are touched; in doubt, no.
    fn fills(&self, min: DVec3, max: DVec3) -> bool {
        self.contains_box(min, max)
    }
}
