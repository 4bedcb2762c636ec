//! The lists of a scene that objects are in, beside the matrices.

use casca_slots::SlotSet;

use crate::scene::outer::Outer;

/// The lists of a scene that objects are in.
#[derive(Debug, Clone, Default)]
pub(super) struct Membership {
    /// Listed dynamic objects.
    pub(super) movers: SlotSet,
    /// Those of them that are reported on expiry and are in no zone.
    pub(super) on_expiry: SlotSet,
    /// Objects tested in every query: outside the grid, too large, overdue or unlocated.
    pub(super) always: SlotSet,
    /// Listed objects in cells that reach beyond the grid, with their boxes.
    pub(super) overhang: Outer,
}

impl Membership {
    pub(super) fn bytes(&self) -> usize {
        self.movers.bytes() + self.on_expiry.bytes() + self.always.bytes() + self.overhang.bytes()
    }
}
