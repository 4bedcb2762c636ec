//! Shapes against cells and boxes.

use glam::{DVec3, IVec3};

use crate::geometry::Block;
use crate::grid::Grid;
use crate::grid::run::{CellRun, rows_of};

/// A shape that can be written into the matrices of a grid.
pub trait Shape {
    /// Least and greatest corner of a box around the shape, in world units.
    fn bounds(&self) -> (DVec3, DVec3);

    /// Calls `out` with runs of cells that cover the shape.
    /// No cell comes twice.
    fn touched(&self, grid: &Grid, out: &mut dyn FnMut(CellRun));

    /// Calls `out` with runs of cells wholly inside the solid. No cell comes twice.
    fn opaque(&self, grid: &Grid, out: &mut dyn FnMut(CellRun));

    /// Whether the box from `min` to `max` lies wholly inside the solid; in doubt, no.
    fn contains_box(&self, min: DVec3, max: DVec3) -> bool;

    /// Whether the point lies in the solid or on its surface; in doubt, yes.
    fn contains_point(&self, point: DVec3) -> bool;
}

/// Which cells of a shape are asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Which {
    Touched,
    Opaque,
}

/// A shape whose cells can be asked for anywhere. All cells that contain a point of
/// it are touched, among them all cells of its inside.
pub(crate) trait Rows: Shape {
    /// Calls `out` with the touched cells between `lo` and `hi`.
    fn touched_rows(&self, grid: &Grid, lo: IVec3, hi: IVec3, out: &mut dyn FnMut(CellRun)) {
        if let Some((a, b)) = self.corners(grid, Which::Touched) {
            rows_of(a.max(lo), b.min(hi), out);
        }
    }

    /// Calls `out` with the opaque cells between `lo` and `hi`.
    fn opaque_rows(&self, grid: &Grid, lo: IVec3, hi: IVec3, out: &mut dyn FnMut(CellRun)) {
        if let Some((a, b)) = self.corners(grid, Which::Opaque) {
            rows_of(a.max(lo), b.min(hi), out);
        }
    }

    /// Whether the box from `min` to `max` contains no point of the shape; in doubt, no.
    fn misses(&self, min: DVec3, max: DVec3) -> bool {
        !Block::new(self.bounds()).meets(&Block { min, max })
    }

    /// The first and the last of the cells asked for, where those are all between them, as for a
    /// box. There are none if the last one comes before the first along an axis. Other shapes tell
    /// their rows.
    fn corners(&self, _: &Grid, _: Which) -> Option<(IVec3, IVec3)> {
        None
    }

    /// Whether all cells in the box from `min` to `max` are touched; in doubt, no.
    fn fills(&self, min: DVec3, max: DVec3) -> bool {
        self.contains_box(min, max)
    }
}
