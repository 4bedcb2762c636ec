//! The lists of a scene that objects are in, beside the matrices.

use casca_slots::{Slot, SlotSet};

use crate::geometry::Block;
use crate::grid::cell_box::CellBox;
use crate::scene::outer::Outer;

/// The lists of a scene that objects are in.
#[derive(Debug, Clone, Default)]
pub(super) struct Membership {
    /// Listed dynamic objects.
    movers: SlotSet,
    /// Those of them that are reported on expiry and are in no zone.
    on_expiry: SlotSet,
    /// Objects tested in every query: outside the grid, too large, overdue or unlocated.
    always: SlotSet,
    /// Listed objects in cells that reach beyond the grid, with their boxes.
    overhang: Outer,
}

impl Membership {
    /// Listed dynamic objects.
    #[inline]
    pub(super) fn movers(&self) -> &[Slot] {
        self.movers.as_slice()
    }

    /// Whether an object is listed and dynamic.
    #[inline]
    pub(super) fn is_mover(&self, slot: Slot) -> bool {
        self.movers.contains(slot)
    }

    /// The listed dynamic objects in no zone that are reported on expiry.
    pub(super) fn on_expiry(&self) -> &[Slot] {
        self.on_expiry.as_slice()
    }

    /// A dynamic object is listed.
    pub(super) fn add_mover(&mut self, slot: Slot) {
        self.movers.insert(slot);
    }

    /// A listed dynamic object that is in no zone is reported on expiry.
    pub(super) fn add_on_expiry(&mut self, slot: Slot) {
        self.on_expiry.insert(slot);
    }

    /// An object is not listed any more; nothing changes if it is static.
    pub(super) fn remove_mover(&mut self, slot: Slot) {
        self.movers.remove(slot);
        self.on_expiry.remove(slot);
    }

    /// The objects that every query tests.
    #[inline]
    pub(super) fn always(&self) -> &[Slot] {
        self.always.as_slice()
    }

    /// Whether every query tests an object.
    #[inline]
    pub(super) fn is_always(&self, slot: Slot) -> bool {
        self.always.contains(slot)
    }

    /// From now on every query tests an object.
    pub(super) fn add_always(&mut self, slot: Slot) {
        self.always.insert(slot);
    }

    /// Queries test an object only where they find it.
    pub(super) fn remove_always(&mut self, slot: Slot) {
        self.always.remove(slot);
    }

    /// The listed objects in cells that reach beyond the grid.
    #[inline]
    pub(super) fn overhang(&self) -> &Outer {
        &self.overhang
    }

    /// An object with this box, in these cells, reaches beyond the grid.
    pub(super) fn add_overhang(&mut self, block: &Block, cells: &CellBox, slot: Slot) {
        self.overhang.insert(block, cells, slot);
    }

    /// An object in these cells reaches beyond the grid no longer.
    pub(super) fn remove_overhang(&mut self, cells: &CellBox, slot: Slot) {
        self.overhang.remove(cells, slot);
    }

    pub(super) fn bytes(&self) -> usize {
        self.movers.bytes() + self.on_expiry.bytes() + self.always.bytes() + self.overhang.bytes()
    }
}
