//! Blocks of cells.

use glam::IVec3;

use crate::grid::bricks::BRICK;

/// A block of cells, both corners included.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct CellBox {
    pub(crate) lo: IVec3,
    pub(crate) hi: IVec3,
}

impl CellBox {
    pub(crate) fn contains(&self, cell: IVec3) -> bool {
        cell.cmpge(self.lo).all() && cell.cmple(self.hi).all()
    }

    pub(crate) fn cells(self) -> impl Iterator<Item = IVec3> {
        let Self { lo, hi } = self;
        (lo.z..=hi.z).flat_map(move |z| {
            (lo.y..=hi.y).flat_map(move |y| (lo.x..=hi.x).map(move |x| IVec3::new(x, y, z)))
        })
    }

    /// The bricks that the surface passes through.
    pub(crate) fn surface_bricks(self) -> impl Iterator<Item = IVec3> {
        let (b0, b1) = (self.lo >> 3i32, self.hi >> 3i32);
        (b0.z..=b1.z).flat_map(move |z| {
            (b0.y..=b1.y).flat_map(move |y| {
                (b0.x..=b1.x).map(move |x| IVec3::new(x, y, z)).filter(move |&b| !self.swallows(b))
            })
        })
    }

    /// Whether all cells of a brick lie strictly inside.
    fn swallows(&self, brick: IVec3) -> bool {
        let (first, last) = (brick * BRICK, brick * BRICK + BRICK - 1);
        first.cmpgt(self.lo).all() && last.cmplt(self.hi).all()
    }
}

/// Number of cells in a block of them, both corners included.
pub(crate) fn volume(lo: IVec3, hi: IVec3) -> u64 {
    (hi - lo + 1).to_array().iter().map(|&n| n.max(0) as u64).product()
}
