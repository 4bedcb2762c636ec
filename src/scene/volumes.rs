//! All temporal bounding volumes of a scene: their cells in the matrices, and the structures that
//! find them.

use casca_slots::Slot;
use glam::IVec3;

use crate::geometry::Block;
use crate::grid::Grid;
use crate::grid::cell_box::CellBox;
use crate::matrix::tbv::TbvMatrix;
use crate::scene::containing::Containing;
use crate::scene::outer::Outer;
use crate::scene::volume::Tbv;

/// All volumes of a scene.
#[derive(Clone)]
pub(crate) struct Volumes {
    matrix: TbvMatrix,
    /// By slot; only read for slots in the matrix.
    cells: Vec<CellBox>,
    containing: Containing,
    /// Those that leave the grid are not in the matrix.
    outer: Outer,
    /// All cells of the grid.
    whole: CellBox,
}

impl Volumes {
    pub(super) fn new(grid: &Grid) -> Self {
        Self {
            matrix: TbvMatrix::new(grid.dims()),
            cells: Vec::new(),
            containing: Containing::default(),
            outer: Outer::default(),
            whole: CellBox { lo: IVec3::ZERO, hi: grid.dims() - 1 },
        }
    }

    /// Txy, Txz, Tyz: the surfaces of the volumes that lie inside the grid.
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
        if self.leaves(volume) {
            self.outer.insert(&tbv.block, volume, slot);
        } else {
            self.matrix.insert(volume, slot);
        }
        self.containing.insert(volume, slot);
    }

    /// Whether a volume reaches beyond the grid.
    fn leaves(&self, volume: &CellBox) -> bool {
        !(self.whole.contains(volume.lo) && self.whole.contains(volume.hi))
    }

    /// Whether the volume of an object reaches beyond the grid.
    pub(crate) fn is_outer(&self, slot: Slot) -> bool {
        self.leaves(self.cells(slot))
    }

    /// The box of an object's volume.
    pub(crate) fn block(&self, grid: &Grid, slot: Slot) -> Block {
        let CellBox { lo, hi } = *self.cells(slot);
        if self.is_outer(slot) { self.outer.block(slot) } else { Block::new(grid.range_bounds(lo, hi)) }
    }

    /// The volumes that reach beyond the grid.
    pub(crate) fn outer(&self) -> &Outer {
        &self.outer
    }

    pub(super) fn remove(&mut self, slot: Slot) {
        let volume = self.cells[slot.index()];
        if self.leaves(&volume) {
            self.outer.remove(&volume, slot);
        } else {
            self.matrix.remove(&volume, slot);
        }
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
        self.matrix.bytes()
            + self.cells.capacity() * size_of::<CellBox>()
            + self.containing.bytes()
            + self.outer.bytes()
    }
}

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};

    use super::*;
    use crate::grid::GridSpec;
    use crate::random::Random;

    fn grid() -> Grid {
        Grid::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::new(100, 60, 100) }).unwrap()
    }

    #[test]
    fn finds_every_volume_around_a_cell() {
        let mut volumes = Volumes::new(&grid());
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
