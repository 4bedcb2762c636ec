//! Lists of objects that stay quick when they grow long.

use casca_slots::Slot;
use hashbrown::HashMap;
use smallvec::SmallVec;

use crate::heap::in_table;

/// Longer lists are looked up by a table instead of one by one; they go back at half of this.
const LONG: usize = 32;

/// Where each of a list is. Apart, so that short lists stay small.
#[derive(Clone, Default)]
struct Places(HashMap<Slot, u32>);

/// A list without repetition. Short ones keep their order.
#[derive(Clone, Default)]
pub(crate) struct SlotList {
    slots: SmallVec<[Slot; 6]>,
    /// Of a long list, the place of each.
    places: Option<Box<Places>>,
}

impl SlotList {
    pub(crate) fn as_slice(&self) -> &[Slot] {
        &self.slots
    }

    pub(crate) fn find(&self, slot: Slot) -> Option<usize> {
        match &self.places {
            Some(places) => places.0.get(&slot).map(|&i| i as usize),
            None => self.slots.iter().position(|&s| s == slot),
        }
    }

    pub(crate) fn push(&mut self, slot: Slot) {
        self.slots.push(slot);
        if let Some(places) = &mut self.places {
            places.0.insert(slot, self.slots.len() as u32 - 1);
        } else if self.slots.len() > LONG {
            self.places = Some(Box::new(Places(self.slots.iter().copied().zip(0..).collect())));
        }
    }

    /// Takes one out and puts the last into its place.
    pub(crate) fn swap_remove(&mut self, i: usize) {
        let slot = self.slots.swap_remove(i);
        if let Some(places) = &mut self.places {
            places.0.remove(&slot);
            if let Some(&moved) = self.slots.get(i) {
                places.0.insert(moved, i as u32);
            }
        }
        self.shrink();
    }

    /// Takes one out. The others of a short list keep their order.
    pub(crate) fn remove(&mut self, i: usize) {
        if self.places.is_some() {
            self.swap_remove(i);
        } else {
            self.slots.remove(i);
        }
    }

    fn shrink(&mut self) {
        if self.places.is_some() && self.slots.len() <= LONG / 2 {
            self.places = None;
            self.slots.shrink_to_fit();
        }
    }

    /// Bytes on the heap.
    pub(crate) fn bytes(&self) -> usize {
        let table = |p: &Places| size_of_val(p) + in_table::<(Slot, u32)>(p.0.capacity());
        let spilled = if self.slots.spilled() { self.slots.capacity() * size_of::<Slot>() } else { 0 };
        spilled + self.places.as_deref().map_or(0, table)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn long_lists_find_what_they_hold() {
        let mut list = SlotList::default();
        let mut held: Vec<Slot> = Vec::new();
        let mut random = Random::new(5);
        for step in 0..6000 {
            let slot = Slot::new(random.below(120));
            let grows = step / 1000 % 2 == 0;
            match (list.find(slot), grows || random.below(2) == 0) {
                (Some(i), false) => {
                    if random.below(2) == 0 {
                        list.remove(i)
                    } else {
                        list.swap_remove(i)
                    }
                    held.retain(|&s| s != slot);
                }
                (None, true) => {
                    list.push(slot);
                    held.push(slot);
                }
                _ => {}
            }
            let mut all = list.as_slice().to_vec();
            assert!((0..all.len()).all(|i| list.find(all[i]) == Some(i)));
            all.sort_unstable();
            held.sort_unstable();
            assert_eq!(all, held);
        }
    }
}
