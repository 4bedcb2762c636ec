//! Temporal bounding volumes (TBVs): circles of cells that hold hidden moving objects for a while,
//! so that motion inside changes no matrix (Sudarsky & Gotsman 1996; thesis, section 3.3.2).

mod circle;
mod containing;
mod tbv;
mod validity;

use std::collections::HashMap;

use casca_slots::Slot;
use glam::IVec2;
use smallvec::SmallVec;

use crate::grid::Grid;
use crate::matrix::CrossBits;
use crate::volume::containing::Containing;

pub(crate) use tbv::Tbv;
pub(crate) use validity::Validity;

/// T: the outlines of all volumes of a scene.
#[derive(Debug, Clone)]
pub(crate) struct Volumes {
    dims: IVec2,
    /// The cells with outlines.
    bits: CrossBits,
    /// By cell: the slots of the volumes. Never iterated.
    lists: HashMap<IVec2, SmallVec<[Slot; 4]>>,
    containing: Containing,
}

impl Volumes {
    pub(crate) fn new(grid: &Grid) -> Self {
        let dims = grid.dims();
        let bits = CrossBits::new(dims.as_uvec2());
        Self { dims, bits, lists: HashMap::new(), containing: Containing::default() }
    }

    /// The cells of the grid with outlines.
    pub(crate) fn bits(&self) -> &CrossBits {
        &self.bits
    }

    /// The slots of the volumes whose outlines pass a cell.
    pub(crate) fn at(&self, cell: IVec2) -> &[Slot] {
        if !self.bits.get(cell.x as u32, cell.y as u32) {
            return &[];
        }
        self.lists.get(&cell).map_or(&[], |list| list.as_slice())
    }

    /// Calls `found` with the volumes that contain a cell, on their outlines or inside.
    pub(crate) fn holding(&self, cell: IVec2, found: impl FnMut(Slot)) {
        self.containing.find(cell, found);
    }

    /// Draws the outline of a volume. Costs its cells.
    pub(crate) fn insert(&mut self, slot: Slot, tbv: &Tbv) {
        for cell in self.outline(tbv) {
            let list = self.lists.entry(cell).or_default();
            list.push(slot);
            self.bits.set(cell.x as u32, cell.y as u32, true);
        }
        self.containing.insert(tbv, slot);
    }

    /// Takes the outline of a volume away. Costs its cells and the volumes there.
    pub(crate) fn remove(&mut self, slot: Slot, tbv: &Tbv) {
        for cell in self.outline(tbv) {
            let Some(list) = self.lists.get_mut(&cell) else { continue };
            if let Some(at) = list.iter().rposition(|other| *other == slot) {
                list.swap_remove(at);
            }
            if list.is_empty() {
                self.lists.remove(&cell);
                self.bits.set(cell.x as u32, cell.y as u32, false);
            }
        }
        self.containing.remove(tbv, slot);
    }

    /// The cells of an outline that lie in the grid.
    fn outline(&self, tbv: &Tbv) -> impl Iterator<Item = IVec2> + use<> {
        let dims = self.dims;
        tbv.outline().filter(move |c| c.cmpge(IVec2::ZERO).all() && c.cmplt(dims).all())
    }
}

#[cfg(test)]
mod tests {
    use glam::{UVec2, Vec2};

    use super::*;
    use crate::grid::GridSpec;

    #[test]
    fn outlines_come_and_go() {
        let grid = Grid::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::new(40, 30) }).unwrap();
        let mut volumes = Volumes::new(&grid);
        let places = [(5, 5, 3), (5, 5, 3), (8, 6, 9), (39, 29, 4), (20, 2, 1)];
        let slots = || Slot::below(places.len());
        let tbvs = places.map(|(x, y, radius)| Tbv::new(IVec2::new(x, y), radius));
        slots().zip(&tbvs).for_each(|(slot, tbv)| volumes.insert(slot, tbv));
        for (slot, tbv) in slots().zip(&tbvs) {
            for cell in tbv.outline().filter(|&c| grid.contains(c)) {
                assert!(volumes.at(cell).contains(&slot) && volumes.bits().get(cell.x as u32, cell.y as u32));
            }
        }
        let holding = |volumes: &Volumes, cell| {
            let mut found = Vec::new();
            volumes.holding(cell, |slot| found.push(slot));
            found.sort_unstable();
            found
        };
        assert_eq!(holding(&volumes, IVec2::new(5, 5)), [0, 1, 2].map(Slot::new));
        assert_eq!(holding(&volumes, IVec2::new(39, 28)), [Slot::new(3)]);
        volumes.remove(Slot::new(0), &tbvs[0]);
        assert_eq!(holding(&volumes, IVec2::new(5, 5)), [1, 2].map(Slot::new));
        slots().skip(1).for_each(|slot| volumes.remove(slot, &tbvs[slot.index()]));
        assert!(volumes.lists.is_empty() && volumes.bits().cells().next().is_none());
    }
}
