//! The place of a value, and its name.

use std::fmt;

/// The place of a value in a [`Slots`](crate::Slots): a small number, to index tables with.
///
/// A slot is given to another value after removal. Only an [`Id`] names one value.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct Slot(u32);

impl Slot {
    /// The slot of a number.
    #[inline]
    pub const fn new(number: u32) -> Self {
        Self(number)
    }

    /// Its number.
    #[inline]
    pub const fn get(self) -> u32 {
        self.0
    }

    /// Its number as an index.
    #[inline]
    pub const fn index(self) -> usize {
        self.0 as usize
    }

    /// The slot of the next number.
    ///
    /// # Panics
    /// In debug builds, on the slot of `u32::MAX`.
    #[inline]
    pub const fn next(self) -> Self {
        Self(self.0 + 1)
    }

    /// The slots with numbers below `count`, in order. Numbers are at most `u32::MAX`.
    #[inline]
    pub fn below(count: usize) -> impl DoubleEndedIterator<Item = Self> + ExactSizeIterator + Clone {
        (0..u32::try_from(count).unwrap_or(u32::MAX)).map(Self)
    }
}

impl fmt::Display for Slot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

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
