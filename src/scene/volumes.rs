//! All temporal bounding volumes of a scene: their cells in the matrices, and the structures that
//! find them.

use casca_slots::Slot;
use glam::IVec3;

use crate::grid::cell_box::CellBox;
use crate::matrix::tbv::TbvMatrix;
use crate::scene::containing::Containing;
use crate::scene::volume::Tbv;

/// All volumes of a scene.
#[derive(Clone, Default)]
pub(crate) struct Volumes {
    matrix: TbvMatrix,
    /// By slot; only read for slots in the matrix.
    cells: Vec<CellBox>,
    containing: Containing,
}

impl Volumes {
    /// Txy, Txz, Tyz: the surfaces of the volumes.
    #[inline]
    pub(crate) fn matrix(&self) -> &TbvMatrix {
        &self.matrix
    }

    pub(super) fn insert(&mut self, slot: Slot, tbv: &Tbv) {
        let volume = &tbv.cells;
        if self.cells.len() <= slot.index() {
            self.cells.resize(slot.index() + 1, CellBox::default());
        }
        self.cells[slot.index()] = *volume;
        self.matrix.insert(volume, slot);
        self.containing.insert(volume, slot);
    }

    pub(super) fn remove(&mut self, slot: Slot) {
        let volume = self.cells[slot.index()];
        self.matrix.remove(&volume, slot);
        self.containing.remove(&volume, slot);
    }

    #[inline]
    pub(crate) fn cells(&self, slot: Slot) -> &CellBox {
        &self.cells[slot.index()]
    }

    /// The volumes that contain a cell, on their surface or inside.
    pub(crate) fn holding(&self, cell: IVec3, mut found: impl FnMut(Slot)) {
        self.containing.find(cell, |slot| {
            if self.cells[slot.index()].contains(cell) {
                found(slot);
            }
        });
    }

    pub(super) fn bytes(&self) -> usize {
        self.matrix.bytes() + self.cells.capacity() * size_of::<CellBox>() + self.containing.bytes()
    }
}

#[cfg(test)]
mod tests {

    use super::*;
    use crate::geometry::Block;
    use crate::grid::Grid;
    use crate::random::Random;

    fn grid() -> Grid {
        Grid::new(1.0).unwrap()
    }

    #[test]
    fn finds_every_volume_around_a_cell() {
        let mut volumes = Volumes::default();
        let mut boxes = Vec::new();
        let mut random = Random::new(9);
        let mut next = |n: i32| random.below(n as u32) as i32;
        for slot in Slot::below(400) {
            let lo = IVec3::new(next(90), next(50), next(90));
            let hi = (lo + IVec3::new(next(30), next(9), next(20))).min(IVec3::new(99, 59, 99));
            boxes.push(CellBox { lo, hi });
            let block = Block::new(grid().range_bounds(lo, hi));
            volumes.insert(slot, &Tbv { cells: CellBox { lo, hi }, block, slack: 0.0 });
        }
        for slot in Slot::below(400).step_by(3) {
            volumes.remove(slot);
        }
        for _ in 0..500 {
            let c = IVec3::new(next(100), next(60), next(100));
            let mut found = Vec::new();
            volumes.holding(c, |s| found.push(s));
            found.sort_unstable();
            let expect: Vec<Slot> =
                Slot::below(400).filter(|s| s.index() % 3 != 0 && boxes[s.index()].contains(c)).collect();
            assert_eq!(found, expect, "{c}");
        }
    }
}
