//! Objects that get no volume for some frames, though no view sees them: they leave volumes so soon
//! that the lists of zones cost less.

use std::collections::VecDeque;

use casca_slots::Slot;

use crate::scene::slot_bits::SlotBits;

/// Sets of objects by the frame until which they rest.
#[derive(Debug, Clone, Default)]
pub(super) struct Resting {
    slots: SlotBits,
    /// In the order of frames.
    queue: VecDeque<(u64, Slot)>,
}

impl Resting {
    /// An object rests until a frame, which comes no sooner than those of the calls before.
    pub(super) fn rest(&mut self, slot: Slot, until: u64) {
        if self.slots.insert(slot) {
            self.queue.push_back((until, slot));
        }
    }

    /// A frame begins.
    pub(super) fn wake(&mut self, frame: u64) {
        while let Some(&(_, slot)) = self.queue.front().filter(|next| next.0 <= frame) {
            self.queue.pop_front();
            self.slots.remove(slot);
        }
    }

    /// Whether the object in a slot rests, or one that had the slot before would.
    pub(super) fn contains(&self, slot: Slot) -> bool {
        self.slots.contains(slot)
    }

    pub(super) fn bytes(&self) -> usize {
        self.slots.bytes() + self.queue.capacity() * size_of::<(u64, Slot)>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_rest_until_their_frame() {
        let mut resting = Resting::default();
        let [a, b] = [3, 200].map(Slot::new);
        resting.rest(a, 5);
        resting.rest(a, 7);
        resting.rest(b, 8);
        for (frame, expected) in [(4, (true, true)), (5, (false, true)), (8, (false, false))] {
            resting.wake(frame);
            assert_eq!((resting.contains(a), resting.contains(b)), expected, "{frame}");
        }
        assert!(!resting.contains(Slot::new(9999)));
    }
}
