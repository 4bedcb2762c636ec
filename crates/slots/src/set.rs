//! Sets of slots that are iterated as slices.

use crate::slot::Slot;

/// Where a slot that is in no set is.
const NOWHERE: u32 = u32::MAX;

/// A set of slots: insertion, removal and membership cost one look-up, and iteration costs the
/// members. It takes 4 bytes for each slot up to the greatest that was ever in it.
///
/// The order of the members depends on the operations alone: they come in the order of insertion,
/// but that the last one takes the place of one that leaves.
///
/// ```
/// use casca_slots::{Slot, SlotSet};
///
/// let mut set = SlotSet::default();
/// [4, 1, 7, 4].map(|slot| set.insert(Slot::new(slot)));
/// assert_eq!(set.as_slice(), [4, 1, 7].map(Slot::new));
/// set.remove(Slot::new(4));
/// assert_eq!(set.as_slice(), [7, 1].map(Slot::new));
/// ```
#[derive(Debug, Clone, Default)]
pub struct SlotSet {
    members: Vec<Slot>,
    /// By slot: its place in `members`, or `NOWHERE`.
    places: Vec<u32>,
}

impl SlotSet {
    /// The members; their order changes when one is removed.
    #[inline]
    pub fn as_slice(&self) -> &[Slot] {
        &self.members
    }

    /// Whether a slot is a member.
    #[inline]
    pub fn contains(&self, slot: Slot) -> bool {
        self.places.get(slot.index()).is_some_and(|&at| at != NOWHERE)
    }

    /// Adds a slot; false if it was a member.
    #[inline]
    pub fn insert(&mut self, slot: Slot) -> bool {
        if self.places.len() <= slot.index() {
            self.places.resize(slot.index() + 1, NOWHERE);
        }
        let place = &mut self.places[slot.index()];
        let new = *place == NOWHERE;
        if new {
            *place = self.members.len() as u32;
            self.members.push(slot);
        }
        new
    }

    /// Takes a slot out; false if it was no member. The last member takes its place.
    #[inline]
    pub fn remove(&mut self, slot: Slot) -> bool {
        let Some(place) = self.places.get_mut(slot.index()) else { return false };
        let at = std::mem::replace(place, NOWHERE);
        if at == NOWHERE {
            return false;
        }
        self.members.swap_remove(at as usize);
        if let Some(&moved) = self.members.get(at as usize) {
            self.places[moved.index()] = at;
        }
        true
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        self.members.capacity() * size_of::<Slot>() + self.places.capacity() * size_of::<u32>()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn it_agrees_with_an_ordered_set() {
        let (mut set, mut model) = (SlotSet::default(), BTreeSet::new());
        let mut state = 5u32;
        for _ in 0..5000 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let slot = Slot::new((state >> 8) % 40);
            if state >> 31 == 0 {
                assert_eq!(set.insert(slot), model.insert(slot));
            } else {
                assert_eq!(set.remove(slot), model.remove(&slot));
            }
            let mut members = set.as_slice().to_vec();
            members.sort_unstable();
            assert!(members.into_iter().eq(model.iter().copied()));
            assert!(Slot::below(50).all(|s| set.contains(s) == model.contains(&s)));
        }
    }
}
