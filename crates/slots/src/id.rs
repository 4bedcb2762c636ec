//! Names of values.

use crate::slot::Slot;

/// Names one value of one [`Slots`](crate::Slots), for ever: ids are not given twice.
///
/// It has 96 bits: the [tag](crate::Slots::tag) of the store that the value was inserted into, its
/// slot, and how many values had that slot before. Ids are ordered by these, in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Id {
    store: u32,
    slot: Slot,
    generation: u32,
}

impl Id {
    /// The id of these parts, of one that was taken apart.
    #[inline]
    pub const fn new(store: u32, slot: Slot, generation: u32) -> Self {
        Self { store, slot, generation }
    }

    /// The tag of the store that the value was inserted into.
    #[inline]
    pub const fn store(self) -> u32 {
        self.store
    }

    /// The place of the value.
    #[inline]
    pub const fn slot(self) -> Slot {
        self.slot
    }

    /// How many values had the slot before.
    #[inline]
    pub const fn generation(self) -> u32 {
        self.generation
    }
}
