//! The objects that the last frame ended with in sight, a bit for each slot.

use casca_slots::Slot;

/// The objects that a frame ended with in sight.
#[derive(Debug, Clone, Default)]
pub(super) struct Seen {
    /// By slot, a bit for each.
    bits: Vec<u64>,
    /// The number of the frame.
    pub(super) frame: u64,
}

impl Seen {
    /// Forgets all, for the end of a frame of a scene with so many slots.
    pub(super) fn begin(&mut self, slots: usize, frame: u64) {
        self.bits.clear();
        self.bits.resize(slots.div_ceil(64), 0);
        self.frame = frame;
    }

    /// An object is in sight.
    pub(super) fn insert(&mut self, slot: Slot) {
        self.bits[slot.index() / 64] |= 1 << (slot.index() % 64);
    }

    /// An object is gone: another may get its slot before the next frame.
    pub(super) fn remove(&mut self, slot: Slot) {
        if let Some(word) = self.bits.get_mut(slot.index() / 64) {
            *word &= !(1 << (slot.index() % 64));
        }
    }

    /// Whether an object was in sight.
    pub(super) fn contains(&self, slot: Slot) -> bool {
        self.bits.get(slot.index() / 64).is_some_and(|word| word >> (slot.index() % 64) & 1 != 0)
    }

    pub(super) fn bytes(&self) -> usize {
        self.bits.capacity() * size_of::<u64>()
    }
}
