//! Blocks of cells.

use glam::IVec3;

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

    /// The block around both.
    pub(crate) fn join(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// A cell in the middle.
    pub(crate) fn middle(self) -> IVec3 {
        self.lo + (self.hi - self.lo) / 2
    }

    pub(crate) fn cells(self) -> impl Iterator<Item = IVec3> {
        let Self { lo, hi } = self;
        (lo.z..=hi.z).flat_map(move |z| {
            (lo.y..=hi.y).flat_map(move |y| (lo.x..=hi.x).map(move |x| IVec3::new(x, y, z)))
        })
    }

    /// The bricks that a block of cells reaches into.
    #[inline]
    pub(crate) fn bricks(self) -> Self {
        Self { lo: self.lo >> 3i32, hi: self.hi >> 3i32 }
    }
}

/// Number of cells in a block of them, both corners included, or the greatest number if there are
/// more.
pub(crate) fn volume(lo: IVec3, hi: IVec3) -> u64 {
    (hi - lo + 1).to_array().iter().map(|&n| n.max(0) as u64).fold(1, u64::saturating_mul)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_counted_or_too_many() {
        assert_eq!(volume(IVec3::new(-1, 2, 3), IVec3::new(1, 2, 4)), 6);
        assert_eq!(volume(IVec3::ONE, IVec3::ZERO), 0);
        let far = IVec3::splat(1 << 29);
        assert_eq!(volume(-far, far), u64::MAX);
    }
}
