//! Rows of cells.

use glam::IVec3;

/// A run of cells along x, both ends included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CellRun {
    /// First cell.
    pub x0: i32,
    /// Last cell.
    pub x1: i32,
    /// Row.
    pub y: i32,
    /// Slice.
    pub z: i32,
}

impl CellRun {
    /// The cells of the run.
    pub fn cells(self) -> impl Iterator<Item = IVec3> {
        (self.x0..=self.x1).map(move |x| IVec3::new(x, self.y, self.z))
    }
}

/// The rows of a block of cells, which may be none.
pub(crate) fn rows_of(lo: IVec3, hi: IVec3, out: &mut dyn FnMut(CellRun)) {
    if lo.x > hi.x {
        return;
    }
    for z in lo.z..=hi.z {
        for y in lo.y..=hi.y {
            out(CellRun { x0: lo.x, x1: hi.x, y, z });
        }
    }
}
