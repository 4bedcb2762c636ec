//! Sets of slots that are iterated as slices.

/// Where a slot that is in no set is.
const NOWHERE: u32 = u32::MAX;

/// A set of slots: insertion, removal and membership cost one look-up, and iteration costs the members.
#[derive(Debug, Clone, Default)]
pub(crate) struct SlotSet {
    members: Vec<u32>,
    /// By slot: its place in `members`, or `NOWHERE`.
    places: Vec<u32>,
}

impl SlotSet {
    /// The members; their order changes when one is removed.
    #[inline]
    pub(crate) fn as_slice(&self) -> &[u32] {
        &self.members
    }

    pub(crate) fn contains(&self, slot: u32) -> bool {
        self.places.get(slot as usize).is_some_and(|&at| at != NOWHERE)
    }

    /// Adds a slot; false if it was a member.
    pub(crate) fn insert(&mut self, slot: u32) -> bool {
        if self.places.len() <= slot as usize {
            self.places.resize(slot as usize + 1, NOWHERE);
        }
        let place = &mut self.places[slot as usize];
        let new = *place == NOWHERE;
        if new {
            *place = self.members.len() as u32;
            self.members.push(slot);
        }
        new
    }

    /// Takes a slot out; false if it was no member. The last member takes its place.
    pub(crate) fn remove(&mut self, slot: u32) -> bool {
        let Some(place) = self.places.get_mut(slot as usize) else { return false };
        let at = std::mem::replace(place, NOWHERE);
        if at == NOWHERE {
            return false;
        }
        self.members.swap_remove(at as usize);
        if let Some(&moved) = self.members.get(at as usize) {
            self.places[moved as usize] = at;
        }
        true
    }

    pub(super) fn bytes(&self) -> usize {
        (self.members.capacity() + self.places.capacity()) * size_of::<u32>()
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
            let slot = (state >> 8) % 40;
            if state >> 31 == 0 {
                assert_eq!(set.insert(slot), model.insert(slot));
            } else {
                assert_eq!(set.remove(slot), model.remove(&slot));
            }
            let mut members = set.as_slice().to_vec();
            members.sort_unstable();
            assert!(members.into_iter().eq(model.iter().copied()));
            assert!((0..50).all(|s| set.contains(s) == model.contains(&s)));
        }
    }
}
