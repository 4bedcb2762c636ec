//! The objects that the last frame ended with in sight.

use casca_slots::Slot;

use crate::scene::slot_bits::SlotBits;

/// The objects that a frame ended with in sight.
#[derive(Debug, Clone, Default)]
pub(super) struct Seen {
    slots: SlotBits,
    /// The number of the frame.
    pub(super) frame: u64,
}

impl Seen {
    /// Forgets all, for the end of a frame.
    pub(super) fn begin(&mut self, frame: u64) {
        self.slots.clear();
        self.frame = frame;
    }

    /// An object is in sight.
    #[inline]
    pub(super) fn insert(&mut self, slot: Slot) {
        self.slots.insert(slot);
    }

    /// An object is gone: another may get its slot before the next frame.
    pub(super) fn remove(&mut self, slot: Slot) {
        self.slots.remove(slot);
    }

    /// Whether an object was in sight.
    #[inline]
    pub(super) fn contains(&self, slot: Slot) -> bool {
        self.slots.contains(slot)
    }

    pub(super) fn bytes(&self) -> usize {
        self.slots.bytes()
    }
}
