//! The matrices that the cell method reads.

use glam::IVec2;

use crate::matrix::CrossBits;

/// The matrices that a walk reads.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellMap<'a> {
    pub(crate) dims: IVec2,
    /// O, as cells that are opaque in either. Empty where nothing may hide.
    pub(crate) opaque: &'a [&'a CrossBits],
    /// The cells to report where they are in sight, of I or of T.
    pub(crate) found: [&'a CrossBits; 2],
}

impl CellMap<'_> {
    pub(super) fn contains(&self, cell: IVec2) -> bool {
        cell.cmpge(IVec2::ZERO).all() && cell.cmplt(self.dims).all()
    }

    /// Whether a cell is opaque. Cells outside of the grid are not.
    pub(super) fn is_opaque(&self, cell: IVec2) -> bool {
        self.contains(cell) && self.opaque.iter().any(|o| o.get(cell.x as u32, cell.y as u32))
    }

    /// Chessboard distance from a cell to the nearest and to the farthest cell of the grid.
    pub(super) fn shells(&self, v: IVec2) -> (i32, i32) {
        let last = self.dims - 1;
        let nearest = (-v).max(v - last).max(IVec2::ZERO).max_element();
        (nearest, v.abs().max((last - v).abs()).max_element())
    }
}
