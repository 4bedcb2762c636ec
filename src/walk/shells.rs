//! The cells that a walk visits: chessboard shells around one cell, cut off by the frustum.

use glam::IVec3;

use crate::geometry::Block;
use crate::grid::Grid;
use crate::grid::cell_box::CellBox;
use crate::numeric::query::FAR_VIEWER;
use crate::view::{Origin, View};
use crate::walk::frustum::{CellFrustum, Start};

/// A box farther away than this many shells counts as if it began in the last of them. So there are
/// never more lists by shell than this.
const MOST_SHELLS: i32 = 4096;

/// The shells of cells around a cell, as far as there is anything.
#[derive(Debug, Clone)]
pub(crate) struct Shells {
    /// The cell in the middle.
    pub(crate) cell: IVec3,
    /// The cells in which there is anything.
    pub(crate) extent: CellBox,
    /// Chessboard distance of the nearest and the farthest of them.
    pub(crate) nearest: i32,
    pub(crate) farthest: i32,
    /// The frustum, relative to the middle.
    pub(crate) frustum: CellFrustum,
    /// The cell in the middle, in world units.
    middle: Block,
    /// Cells for one unit of length.
    per_unit: f64,
}

impl Shells {
    /// The shells around the cell of the eye. `None` for parallel rays, and for an eye so far from
    /// cell 0 that coordinates in cells are not exact enough.
    pub(crate) fn around_eye(grid: &Grid, extent: CellBox, view: &View, start: Start) -> Option<Self> {
        let Origin::Eye { at, .. } = view.origin else { return None };
        let cell = grid.cell_of(at);
        (cell.abs().max_element() <= FAR_VIEWER).then(|| Self::around(grid, extent, view, cell, start))
    }

    /// The shells around the middle, for walks that do not start at the eye.
    pub(crate) fn around_middle(grid: &Grid, extent: CellBox, view: &View) -> Self {
        Self::around(grid, extent, view, extent.middle(), Start::None)
    }

    fn around(grid: &Grid, extent: CellBox, view: &View, cell: IVec3, start: Start) -> Self {
        let (nearest, farthest) = shell_range(&extent, cell);
        let frustum = CellFrustum::new(grid, view, cell, start);
        let (middle, per_unit) = (Block::new(grid.cell_bounds(cell)), 1.0 / grid.cell_size());
        Self { cell, extent, nearest, farthest, frustum, middle, per_unit }
    }

    /// The least shell that a box in world units reaches into. Rounding may choose a
    /// neighbour where the box ends on the border of a cell.
    #[inline]
    pub(crate) fn begin_of(&self, block: &Block) -> usize {
        let away = (block.min - self.middle.max).max(self.middle.min - block.max).max_element();
        if away >= 0.0 {
            ((away * self.per_unit) as i32).saturating_add(1).min(self.farthest.clamp(0, MOST_SHELLS))
                as usize
        } else {
            0
        }
    }
}

/// Chessboard distance from a cell to the nearest and farthest cell of a block.
fn shell_range(extent: &CellBox, cell: IVec3) -> (i32, i32) {
    let CellBox { lo, hi } = *extent;
    let nearest = (lo - cell).max(cell - hi).max(IVec3::ZERO).max_element();
    let farthest = (cell - lo).abs().max((hi - cell).abs()).max_element();
    (nearest, farthest)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn shells_reach_from_the_nearest_to_the_farthest_cell() {
        let grid = Grid::new(1.0).unwrap();
        let extent = CellBox { lo: IVec3::ZERO, hi: IVec3::new(9, 19, 29) };
        let range = |eye: Vec3| {
            let view = View::omnidirectional(eye).unwrap();
            Shells::around_eye(&grid, extent, &view, Start::Cell).map(|s| (s.cell, s.nearest, s.farthest))
        };
        assert_eq!(range(Vec3::splat(2.5)), Some((IVec3::splat(2), 0, 27)));
        assert_eq!(range(Vec3::new(-3.5, 5.5, 5.5)), Some((IVec3::new(-4, 5, 5), 4, 24)));
        assert_eq!(range(Vec3::new(4e6, 5.5, 5.5)), None);
        let middle = Shells::around_middle(&grid, extent, &View::omnidirectional(Vec3::splat(2.5)).unwrap());
        assert_eq!((middle.cell, middle.nearest, middle.farthest), (IVec3::new(4, 9, 14), 0, 15));
    }

    #[test]
    fn boxes_begin_in_the_shell_of_their_nearest_cell() {
        let grid = Grid::new(0.5).unwrap();
        let extent = CellBox { lo: IVec3::new(-6, 2, 0), hi: IVec3::new(33, 21, 9) };
        let (least, most) = grid.range_bounds(extent.lo, extent.hi);
        let view = View::omnidirectional(Vec3::new(2.3, 4.1, 1.2)).unwrap();
        let shells = Shells::around_eye(&grid, extent, &view, Start::Eye).unwrap();
        let mut found = [false; 40];
        for i in 0..4000 {
            let share = |by: i32| f64::from(i * by % 1009) / 1009.0;
            let min = least + (most - least) * glam::DVec3::new(share(7), share(13), share(31));
            let block = Block { min, max: min + 0.3 + share(17) };
            let (lo, hi) = grid.cover(block.min, block.max);
            let expected = (lo - shells.cell).max(shells.cell - hi).max_element().clamp(0, shells.farthest);
            assert_eq!(shells.begin_of(&block), expected as usize, "{block:?}");
            found[expected as usize] = true;
        }
        assert!(found[..20].iter().all(|&found| found), "{found:?}");
        // Boxes beyond begin in the last shell, also where that is the first one.
        let single = CellBox { lo: extent.lo, hi: extent.lo };
        let view = View::omnidirectional(Vec3::new(-2.8, 1.1, 0.1)).unwrap();
        let shells = Shells::around_eye(&grid, single, &view, Start::Eye).unwrap();
        for far in [1.0, 1e30, f64::INFINITY] {
            let block = Block { min: glam::DVec3::splat(far), max: glam::DVec3::splat(far) };
            assert_eq!(shells.begin_of(&block), 0, "{far}");
        }
    }
}
