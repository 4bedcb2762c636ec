//! A set of slots, as a bit for each: where most slots may be in it, or its order counts.

use casca_slots::Slot;

/// A set of slots. Its order is that of the slots.
#[derive(Debug, Clone, Default)]
pub(super) struct SlotBits(Vec<u64>);

impl SlotBits {
    fn place(slot: Slot) -> (usize, u64) {
        (slot.index() / 64, 1 << (slot.index() % 64))
    }

    /// Takes all out.
    pub(super) fn clear(&mut self) {
        self.0.fill(0);
    }

    /// Puts a slot in; false if it was there.
    #[inline]
    pub(super) fn insert(&mut self, slot: Slot) -> bool {
        let (word, bit) = Self::place(slot);
        if self.0.len() <= word {
            self.0.resize(word + 1, 0);
        }
        let before = self.0[word];
        self.0[word] = before | bit;
        before & bit == 0
    }

    /// Takes a slot out; false if it was not there.
    #[inline]
    pub(super) fn remove(&mut self, slot: Slot) -> bool {
        let (word, bit) = Self::place(slot);
        let Some(bits) = self.0.get_mut(word) else { return false };
        let before = *bits;
        *bits = before & !bit;
        before & bit != 0
    }

    /// Whether a slot is in it.
    #[inline]
    pub(super) fn contains(&self, slot: Slot) -> bool {
        let (word, bit) = Self::place(slot);
        self.0.get(word).is_some_and(|bits| bits & bit != 0)
    }

    /// The slots, in their order.
    pub(super) fn iter(&self) -> impl Iterator<Item = Slot> {
        (0u32..).zip(&self.0).flat_map(|(word, &bits)| {
            let rest = |bits: u64| (bits != 0).then_some(bits);
            std::iter::successors(rest(bits), move |bits| rest(bits & (bits - 1)))
                .map(move |bits| Slot::new(word * 64 + bits.trailing_zeros()))
        })
    }

    pub(super) fn bytes(&self) -> usize {
        self.0.capacity() * size_of::<u64>()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::random::Random;

    #[test]
    fn the_set_is_what_was_put_in_and_not_taken_out() {
        let (mut bits, mut set, mut random) = (SlotBits::default(), BTreeSet::new(), Random::new(2));
        for step in 0..4000 {
            let slot = Slot::new((random.next().abs() * 400.0) as u32);
            assert_eq!(bits.contains(slot), set.contains(&slot));
            match step % 3 {
                0 => assert_eq!(bits.remove(slot), set.remove(&slot)),
                _ => assert_eq!(bits.insert(slot), set.insert(slot)),
            }
            if step % 100 == 0 {
                assert!(bits.iter().eq(set.iter().copied()));
            }
        }
        bits.clear();
        assert!(bits.iter().next().is_none() && !bits.remove(Slot::new(9999)));
    }
}
