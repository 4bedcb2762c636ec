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

    /// Calls `found` with the bricks that the surface passes through: the hull of the block of all
    /// bricks, since a brick inside of that has no cell on the surface.
    #[inline]
    pub(crate) fn for_surface_bricks(self, mut found: impl FnMut(IVec3)) {
        let (b0, b1) = (self.lo >> 3i32, self.hi >> 3i32);
        for z in b0.z..=b1.z {
            for y in b0.y..=b1.y {
                let inner = b0.z < z && z < b1.z && b0.y < y && y < b1.y;
                let step = if inner { (b1.x - b0.x).max(1) } else { 1 };
                for x in (b0.x..=b1.x).step_by(step as usize) {
                    found(IVec3::new(x, y, z));
                }
            }
        }
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

    #[test]
    fn the_surface_passes_through_bricks_with_cells_on_it() {
        for (lo, hi) in [
            (IVec3::new(3, 5, 6), IVec3::new(30, 17, 9)),
            (IVec3::splat(0), IVec3::splat(31)),
            (IVec3::splat(7), IVec3::splat(40)),
            (IVec3::new(9, 8, 7), IVec3::new(9, 8, 7)),
            (IVec3::new(7, -9, 0), IVec3::new(8, 8, 64)),
        ] {
            let volume = CellBox { lo, hi };
            let mut found = Vec::new();
            volume.for_surface_bricks(|brick| found.push(brick.to_array()));
            let on_surface = |c: &IVec3| c.cmpeq(lo).any() || c.cmpeq(hi).any();
            let mut expected: Vec<_> =
                volume.cells().filter(on_surface).map(|c| (c >> 3i32).to_array()).collect();
            expected.sort_unstable_by_key(|&[x, y, z]| [z, y, x]);
            expected.dedup();
            assert_eq!(found, expected);
        }
    }
}
