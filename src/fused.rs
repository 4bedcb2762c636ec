//! Fused occluders: boxes of opaque cells where no single solid says why they are opaque.
//!
//! Solids that abut leave a seam when each is drawn for itself. The grid knows that the cells there are
//! solid: boxes of opaque cells are grown around them, also over cells that single solids make opaque, so that they bridge the seams
//! (thesis, section 3.3.4: occluder fusion by extension).

use std::collections::BTreeSet;

use glam::IVec3;
use smallvec::SmallVec;

use crate::bricks::{BRICK, Bricks};
use crate::matrix::{BitMatrix, CellBox, OpacityMatrix};

/// Boxes reach this far beyond the brick of their first cell.
const REACH: i32 = BRICK;

/// Boxes of one brick, at most.
const MOST: usize = 32;

/// The fused occluders of a scene.
#[derive(Clone)]
pub(crate) struct Fused {
    /// Opaque cells that no single drawable solid covers, or that abut on those of another solid.
    cells: BitMatrix,
    boxes: Bricks<SmallVec<[CellBox; 2]>>,
    /// Bricks whose boxes are to be grown anew.
    stale: BTreeSet<[i32; 3]>,
}

impl Fused {
    pub(crate) fn new(dims: IVec3) -> Self {
        Self { cells: BitMatrix::new(dims), boxes: Bricks::new(dims), stale: BTreeSet::new() }
    }

    /// A cell is opaque for a reason that is not drawn.
    pub(crate) fn add(&mut self, cell: IVec3) {
        self.cells.set(cell);
        self.stale.insert((cell >> 3i32).to_array());
    }

    /// A cell is no longer opaque: boxes that may hold it go.
    pub(crate) fn clear(&mut self, cell: IVec3) {
        self.cells.clear_cell(cell);
        let around = CellBox { lo: cell - REACH, hi: cell + REACH };
        let gone: Vec<IVec3> =
            self.bricks_of(&around).filter(|&b| self.boxes.get(b).iter().any(|b| b.contains(cell))).collect();
        for brick in gone {
            self.boxes.release(brick);
            // Its neighbours may have relied on its boxes.
            let reach = CellBox { lo: brick * BRICK - REACH, hi: brick * BRICK + BRICK - 1 + REACH };
            let around: Vec<IVec3> = self.bricks_of(&reach).collect();
            self.stale.extend(around.iter().map(|b| b.to_array()));
        }
    }

    /// The bricks of the grid that a block of cells touches.
    fn bricks_of(&self, block: &CellBox) -> impl Iterator<Item = IVec3> {
        let lo = block.lo.max(IVec3::ZERO) >> 3i32;
        CellBox { lo, hi: block.hi.min(self.cells.dims() - 1) >> 3i32 }.cells()
    }

    /// Grows the boxes of all stale bricks.
    pub(crate) fn refresh(&mut self, opaque: &OpacityMatrix) {
        for brick in std::mem::take(&mut self.stale) {
            let brick = IVec3::from_array(brick);
            self.boxes.release(brick);
            let corner = brick * BRICK;
            let last = (corner + BRICK).min(self.cells.dims()) - 1;
            let mut grown: SmallVec<[CellBox; 2]> = SmallVec::new();
            let neighbours = CellBox { lo: corner - REACH, hi: corner + BRICK - 1 + REACH };
            let around: Vec<CellBox> =
                self.bricks_of(&neighbours).flat_map(|b| self.boxes.get(b).iter().copied()).collect();
            for z in corner.z..=last.z {
                for y in corner.y..=last.y {
                    for x in corner.x..=last.x {
                        let cell = IVec3::new(x, y, z);
                        let new = self.cells.get(cell)
                            && !grown.iter().any(|b| b.contains(cell))
                            && !around.iter().any(|b| b.contains(cell));
                        if new && grown.len() < MOST {
                            let bounds = CellBox { lo: corner - REACH, hi: corner + BRICK - 1 + REACH };
                            grown.push(grow(cell, &bounds, opaque));
                        }
                    }
                }
            }
            if !grown.is_empty() {
                *self.boxes.get_mut(brick) = grown;
            }
        }
    }

    /// The boxes that start in a brick. They may reach beyond it.
    pub(crate) fn in_brick(&self, brick: IVec3) -> &[CellBox] {
        self.boxes.get(brick)
    }

    pub(crate) fn bytes(&self) -> usize {
        self.cells.bytes() + self.boxes.bytes() + self.stale.len() * 24
    }
}

/// A box of opaque cells around one, as large as growing by a layer at a time makes it.
fn grow(cell: IVec3, bounds: &CellBox, opaque: &OpacityMatrix) -> CellBox {
    let dims = opaque.dims();
    let (least, most) = (bounds.lo.max(IVec3::ZERO), bounds.hi.min(dims - 1));
    let mut b = CellBox { lo: cell, hi: cell };
    let mut open = [true; 6];
    while open.contains(&true) {
        for (side, open) in open.iter_mut().enumerate().filter(|(_, open)| **open) {
            let (axis, up) = (side / 2, side % 2 == 1);
            let at = if up { b.hi[axis] + 1 } else { b.lo[axis] - 1 };
            let mut layer = b;
            (layer.lo[axis], layer.hi[axis]) = (at, at);
            *open = least[axis] <= at && at <= most[axis] && layer.cells().all(|c| opaque.get(c));
            if *open {
                (b.lo, b.hi) = (b.lo.min(layer.lo), b.hi.max(layer.hi));
            }
        }
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_cover_their_cells_with_opaque_ones_only() {
        let dims = IVec3::splat(40);
        let (mut opaque, mut fused) = (BitMatrix::new(dims), Fused::new(dims));
        // A wall two cells thick and a block beside it.
        for y in 0..30 {
            for x in 3..35 {
                opaque.set(IVec3::new(x, y, 10));
                opaque.set(IVec3::new(x, y, 11));
            }
        }
        for i in 0..125 {
            opaque.set(IVec3::new(20 + i % 5, 5 + i / 5 % 5, 12 + i / 25));
        }
        let all = |f: &Fused| f.boxes.iter().flat_map(|(_, b)| b.to_vec()).collect::<Vec<_>>();
        let seeds = [IVec3::new(8, 8, 10), IVec3::new(8, 20, 11), IVec3::new(22, 7, 14)];
        seeds.iter().for_each(|&c| fused.add(c));
        fused.refresh(&opaque);
        for c in seeds {
            let boxes = fused.in_brick(c >> 3i32);
            assert!(all(&fused).iter().any(|b| b.contains(c)));
            assert!(boxes.iter().flat_map(|b| b.cells()).all(|c| opaque.get(c)));
            assert!(boxes.iter().all(|b| b.cells().count() > 100));
        }
        // A hole takes away every box over it, until they are grown again.
        let hole = IVec3::new(9, 9, 10);
        opaque.clear_cell(hole);
        fused.clear(hole);
        assert!(all(&fused).iter().all(|b| !b.contains(hole)));
        fused.refresh(&opaque);
        assert!(all(&fused).iter().flat_map(|b| b.cells()).all(|c| opaque.get(c)));
        assert!(seeds.iter().all(|&c| all(&fused).iter().any(|b| b.contains(c))));
    }
}
