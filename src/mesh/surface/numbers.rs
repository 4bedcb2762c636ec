//! The numbers of patches in a scene.

use casca_slots::Slot;

use crate::mesh::surface::index::PatchNumber;

/// Numbers the patches of all surfaces: those of one follow each other.
#[derive(Debug, Clone, Default)]
pub(crate) struct PatchNumbers {
    /// By slot, the number of the first patch of the object, if it has any.
    first: Vec<PatchNumber>,
    /// All numbers ever given are smaller.
    end: PatchNumber,
    /// Ranges given back, by the logarithm of their length.
    free: Vec<Vec<PatchNumber>>,
}

impl PatchNumbers {
    /// All numbers are smaller.
    pub(crate) fn end(&self) -> usize {
        self.end.index()
    }

    /// The number of the first patch of an object that has a surface.
    pub(crate) fn first_of(&self, slot: Slot) -> PatchNumber {
        self.first[slot.index()]
    }

    fn class(count: usize) -> usize {
        count.next_power_of_two().trailing_zeros() as usize
    }

    /// Leaves no numbers that were not given before.
    #[cfg(test)]
    pub(crate) fn use_up(&mut self) {
        self.end = PatchNumber::new(u32::MAX - 1);
    }

    /// Numbers the patches of an object's surface, for as long as it has it; false, without a
    /// change, if there are no numbers left.
    pub(crate) fn insert(&mut self, slot: Slot, patches: usize) -> bool {
        if self.first.len() <= slot.index() {
            self.first.resize(slot.index() + 1, PatchNumber::default());
        }
        let class = Self::class(patches);
        if self.free.len() <= class {
            self.free.resize_with(class + 1, Vec::new);
        }
        let first = match self.free[class].pop() {
            Some(first) => first,
            None => {
                // The last number means none.
                let end = self.end.get().checked_add(1 << class).map(PatchNumber::new);
                let Some(end) = end.filter(|&end| end < PatchNumber::NONE) else { return false };
                std::mem::replace(&mut self.end, end)
            }
        };
        self.first[slot.index()] = first;
        true
    }

    /// Takes the numbers of a surface back.
    pub(crate) fn remove(&mut self, slot: Slot, patches: usize) {
        self.free[Self::class(patches)].push(self.first[slot.index()]);
    }

    pub(crate) fn bytes(&self) -> usize {
        let free = self.free.iter().map(Vec::capacity).sum::<usize>();
        (self.first.capacity() + free) * size_of::<PatchNumber>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_were_given_back_are_given_again_when_no_others_are_left() {
        let mut numbers = PatchNumbers::default();
        assert!(numbers.insert(Slot::new(0), 3) && numbers.insert(Slot::new(1), 3));
        assert_eq!((numbers.first_of(Slot::new(1)), numbers.end()), (PatchNumber::new(4), 8));
        numbers.remove(Slot::new(0), 3);
        numbers.use_up();
        assert!(!numbers.insert(Slot::new(2), 5), "no numbers are left");
        assert!(numbers.insert(Slot::new(3), 4), "those of object 0 are");
        assert!(!numbers.insert(Slot::new(4), 3));
        assert_eq!(numbers.first_of(Slot::new(3)), PatchNumber::new(0));
    }
}
