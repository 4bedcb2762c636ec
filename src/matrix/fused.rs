//! Fused occluders: boxes of opaque cells where no single solid says why they are opaque.
//!
//! Solids that abut leave a seam when each is drawn for itself. The grid knows that the cells there
//! are solid: boxes of opaque cells are grown around them, also over cells that single solids make
//! opaque, so that they bridge the seams (thesis, section 3.3.4: occluder fusion by extension).

use std::collections::BTreeSet;

use glam::IVec3;
use smallvec::SmallVec;

use crate::grid::bricks::{Bricks, Pages};
use crate::grid::cell_box::CellBox;
use crate::grid::mask::{BRICK, Mask, NONE, block_mask, both, cells_of, either, without};
use crate::heap::in_tree;
use crate::matrix::bits::{BitMatrix, OpacityMatrix};

/// Boxes reach this far beyond the brick of their first cell.
const MOST_SPREAD: i32 = BRICK;

/// Boxes of one brick, at most.
const MOST: usize = 32;

/// The fused occluders of a scene.
#[derive(Clone, Default)]
pub(crate) struct Fused {
    /// Opaque cells that no single drawable solid covers.
    cells: BitMatrix,
    /// Cells that were opaque beside opaque cells of another solid. They may not be opaque any
    /// more.
    contacts: BitMatrix,
    boxes: Bricks<SmallVec<[CellBox; 2]>>,
    /// Bricks whose boxes are to be grown anew.
    stale: BTreeSet<[i32; 3]>,
}

impl Fused {
    /// A cell is opaque for a reason that is not drawn.
    pub(crate) fn add(&mut self, cell: IVec3) {
        self.cells.set(cell);
        self.stale.insert((cell >> 3i32).to_array());
    }

    /// Adds opaque cells of a brick that are beside those of another solid.
    pub(crate) fn add_contacts(&mut self, brick: IVec3, cells: &Mask) {
        self.contacts.set_mask(brick, cells);
        self.stale.insert(brick.to_array());
    }

    /// Removes cells of a brick that are no longer beside those of another solid.
    pub(crate) fn forget_contacts(&mut self, brick: IVec3, cells: &Mask) {
        self.contacts.clear_mask(brick, cells);
        self.stale.insert(brick.to_array());
    }

    /// Cells of a brick have no such reason any more.
    pub(crate) fn part(&mut self, brick: IVec3, cells: &Mask) {
        self.cells.clear_mask(brick, cells);
    }

    /// Calls `out` with the cells that are opaque for such a reason, of all bricks that a block
    /// touches.
    pub(crate) fn for_cells(&self, lo: IVec3, hi: IVec3, out: &mut dyn FnMut(IVec3, &Mask)) {
        masks_there(&self.cells, lo, hi, out);
    }

    /// Calls `out` with the cells that were beside another solid's, of all bricks that a block
    /// touches.
    pub(crate) fn for_contacts(&self, lo: IVec3, hi: IVec3, out: &mut dyn FnMut(IVec3, &Mask)) {
        masks_there(&self.contacts, lo, hi, out);
    }

    /// Removes the boxes with some of the cells of a brick, which are no longer opaque.
    pub(crate) fn clear_cells(&mut self, brick: IVec3, cells: &Mask) {
        self.clear(brick * BRICK, brick * BRICK + (BRICK - 1), &|b| {
            both(&block_mask(brick, b.lo, b.hi), cells) != NONE
        });
    }

    /// No cell between `lo` and `hi` is opaque any longer.
    pub(crate) fn clear_block(&mut self, lo: IVec3, hi: IVec3) {
        self.clear(lo, hi, &|b| b.lo.cmple(hi).all() && b.hi.cmpge(lo).all());
    }

    fn clear(&mut self, lo: IVec3, hi: IVec3, gone: &dyn Fn(&CellBox) -> bool) {
        let around = bricks_around(lo, hi);
        let gone: SmallVec<[IVec3; 8]> = bricks_there(self.boxes.pages(), around.lo, around.hi)
            .filter(|&b| self.boxes.get(b).iter().any(gone))
            .collect();
        for brick in gone {
            self.boxes.release(brick);
            // Its neighbours may have relied on its boxes.
            let around = bricks_around(brick * BRICK, brick * BRICK + (BRICK - 1));
            let growing =
                around.cells().filter(|&b| *self.cells.brick(b) != NONE || *self.contacts.brick(b) != NONE);
            self.stale.extend(growing.map(|b| b.to_array()));
        }
    }

    /// Grows the boxes of all stale bricks.
    pub(crate) fn refresh(&mut self, opaque: &OpacityMatrix) {
        for brick in std::mem::take(&mut self.stale) {
            let brick = IVec3::from_array(brick);
            self.boxes.release(brick);
            let corner = brick * BRICK;
            let bounds = CellBox { lo: corner - MOST_SPREAD, hi: corner + (BRICK - 1) + MOST_SPREAD };
            let gone = without(self.contacts.brick(brick), opaque.brick(brick));
            if gone != NONE {
                self.contacts.clear_mask(brick, &gone);
            }
            let seeds = either(self.cells.brick(brick), self.contacts.brick(brick));
            let mut open = both(&seeds, opaque.brick(brick));
            for b in bricks_around(corner, corner + (BRICK - 1)).cells() {
                for held in self.boxes.get(b) {
                    open = without(&open, &block_mask(brick, held.lo, held.hi));
                }
            }
            let mut grown: SmallVec<[CellBox; 2]> = SmallVec::new();
            while let Some(cell) = cells_of(brick, &open).next().filter(|_| grown.len() < MOST) {
                let b = grow(cell, &bounds, opaque);
                open = without(&open, &block_mask(brick, b.lo, b.hi));
                grown.push(b);
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

    /// The pages that contain boxes.
    pub(crate) fn pages(&self) -> &Pages {
        self.boxes.pages()
    }

    pub(crate) fn bytes(&self) -> usize {
        let boxes = self.boxes.iter().map(|(_, boxes)| boxes).filter(|boxes| boxes.spilled());
        self.cells.bytes()
            + self.contacts.bytes()
            + self.boxes.bytes()
            + in_tree::<[i32; 3]>(self.stale.len())
            + boxes.map(|b| b.capacity() * size_of::<CellBox>()).sum::<usize>()
    }
}

/// The bricks whose boxes may reach into a block.
fn bricks_around(lo: IVec3, hi: IVec3) -> CellBox {
    CellBox { lo: (lo - MOST_SPREAD) >> 3i32, hi: (hi + MOST_SPREAD) >> 3i32 }
}

/// Calls `out` with the set cells of all bricks that a block touches.
fn masks_there(cells: &BitMatrix, lo: IVec3, hi: IVec3, out: &mut dyn FnMut(IVec3, &Mask)) {
    for brick in bricks_there(cells.pages(), lo >> 3i32, hi >> 3i32) {
        let mask = cells.brick(brick);
        if *mask != NONE {
            out(brick, mask);
        }
    }
}

/// The bricks from `lo` to `hi` in pages that are not empty.
fn bricks_there(pages: &Pages, lo: IVec3, hi: IVec3) -> impl Iterator<Item = IVec3> {
    let of = CellBox { lo, hi }.bricks();
    of.cells()
        .filter(|&p| !pages.is_empty(p))
        .flat_map(move |p| CellBox { lo: lo.max(p * BRICK), hi: hi.min(p * BRICK + (BRICK - 1)) }.cells())
}

/// A box of opaque cells around one, as large as growing by a layer at a time makes it.
fn grow(cell: IVec3, bounds: &CellBox, opaque: &OpacityMatrix) -> CellBox {
    let CellBox { lo: least, hi: most } = *bounds;
    let mut b = CellBox { lo: cell, hi: cell };
    let mut open = [true; 6];
    while open.contains(&true) {
        for (side, open) in open.iter_mut().enumerate().filter(|(_, open)| **open) {
            let (axis, up) = (side / 2, side % 2 == 1);
            let at = if up { b.hi[axis] + 1 } else { b.lo[axis] - 1 };
            let mut layer = b;
            (layer.lo[axis], layer.hi[axis]) = (at, at);
            *open = least[axis] <= at && at <= most[axis] && opaque.holds_block(layer.lo, layer.hi);
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
        let (mut opaque, mut fused) = (BitMatrix::default(), Fused::default());
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
        fused.clear_cells(hole >> 3i32, &block_mask(hole >> 3i32, hole, hole));
        assert!(all(&fused).iter().all(|b| !b.contains(hole)));
        fused.refresh(&opaque);
        assert!(all(&fused).iter().flat_map(|b| b.cells()).all(|c| opaque.get(c)));
        assert!(seeds.iter().all(|&c| all(&fused).iter().any(|b| b.contains(c))));
    }
}
