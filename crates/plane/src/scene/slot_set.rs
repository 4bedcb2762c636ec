//! A set of slots that is looked through in a fixed order.

/// Slots in the order in which they came, but for those that take the place of one that left.
#[derive(Debug, Clone, Default)]
pub(super) struct SlotSet {
    slots: Vec<u32>,
    /// By slot: 1 + its place, or 0.
    places: Vec<u32>,
}

impl SlotSet {
    /// Adds a slot that may be in the set already.
    pub(super) fn insert(&mut self, slot: u32) {
        if self.places.len() <= slot as usize {
            self.places.resize(slot as usize + 1, 0);
        }
        if self.places[slot as usize] == 0 {
            self.slots.push(slot);
            self.places[slot as usize] = self.slots.len() as u32;
        }
    }

    /// Takes a slot out, if it is in the set.
    pub(super) fn remove(&mut self, slot: u32) {
        let Some(place) = self.places.get_mut(slot as usize).map(std::mem::take) else { return };
        if place > 0 {
            self.slots.swap_remove(place as usize - 1);
            if let Some(&other) = self.slots.get(place as usize - 1) {
                self.places[other as usize] = place;
            }
        }
    }

    pub(super) fn as_slice(&self) -> &[u32] {
        &self.slots
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_come_and_go() {
        let mut set = SlotSet::default();
        [4, 1, 7, 4].into_iter().for_each(|slot| set.insert(slot));
        assert_eq!(set.as_slice(), [4, 1, 7]);
        [4, 4, 99].into_iter().for_each(|slot| set.remove(slot));
        assert_eq!(set.as_slice(), [7, 1]);
        [7, 1].into_iter().for_each(|slot| set.remove(slot));
        assert!(set.as_slice().is_empty());
    }
}
