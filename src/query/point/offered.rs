//! The objects that a kept result rests on.

use casca_slots::Slot;

/// The objects on whose occluders a kept result may rest: all that were not hidden when they were
/// found, whether their occluders were drawn, waited or were too small. The occluders of others are
/// hidden: no ray of the view reaches them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Offered(Vec<Slot>);

impl Offered {
    /// Forgets the last run.
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds an object by its slot.
    pub(super) fn push(&mut self, slot: Slot) {
        self.0.push(slot);
    }

    /// Takes over the objects of a run, and puts all in order.
    pub(crate) fn append(&mut self, other: &Self) {
        self.0.extend_from_slice(&other.0);
        self.0.sort_unstable();
        self.0.dedup();
    }

    /// Whether an object is among them, which are in order.
    pub(crate) fn has(&self, slot: Slot) -> bool {
        self.0.binary_search(&slot).is_ok()
    }

    /// Forgets objects, whose slots are in order.
    pub(crate) fn forget(&mut self, slots: &[Slot]) {
        self.0.retain(|slot| slots.binary_search(slot).is_err());
    }

    /// The slots of all.
    pub(super) fn slots(&self) -> impl Iterator<Item = Slot> {
        self.0.iter().copied()
    }
}
