//! What the views of the last frame saw.

use casca_slots::Slot;
use glam::IVec3;

use crate::scene::slot_bits::SlotBits;

/// What the views of the last frame that ended with results saw, and whose turn it is to be hidden.
#[derive(Debug, Clone, Default)]
pub(super) struct LastFrame {
    /// Its number.
    number: u64,
    /// The objects that it ended with in sight.
    pub(super) seen: SlotBits,
    /// Cells of the viewers.
    pub(super) viewers: Vec<IVec3>,
    /// The number of the slot from which on the next frame hides objects, if they are many.
    next_to_hide: u32,
    /// Memory used again: listed objects out of sight.
    unseen: Vec<Slot>,
}

impl LastFrame {
    /// Another frame ends, seen from these cells; no object is in sight yet.
    pub(super) fn end(&mut self, number: u64, viewers: impl Iterator<Item = IVec3>) {
        self.number = number;
        self.viewers.clear();
        self.viewers.extend(viewers);
        self.seen.clear();
    }

    /// Whether an object was in sight, if this is the frame of a number.
    pub(super) fn saw_in(&self, number: u64, slot: Slot) -> bool {
        self.number == number && self.seen.contains(slot)
    }

    /// Those of some objects that were out of sight, at most so many in a frame, in turn: those that
    /// follow the last one in the order of slots are first. Give them back with [`LastFrame::hid`].
    pub(super) fn unseen(&mut self, objects: impl Iterator<Item = Slot>, most: usize) -> Vec<Slot> {
        let mut unseen = std::mem::take(&mut self.unseen);
        unseen.clear();
        unseen.extend(objects.filter(|&slot| !self.seen.contains(slot)));
        if unseen.len() > most {
            let turn = |slot: &Slot| slot.get().wrapping_sub(self.next_to_hide);
            unseen.select_nth_unstable_by_key(most, turn);
            unseen.truncate(most);
            unseen.sort_unstable_by_key(turn);
        }
        unseen
    }

    /// The first `tried` of the objects out of sight had their turn.
    pub(super) fn hid(&mut self, unseen: Vec<Slot>, tried: usize) {
        if let Some(last) = unseen[..tried].last() {
            self.next_to_hide = last.next().get();
        }
        self.unseen = unseen;
    }

    pub(super) fn bytes(&self) -> usize {
        self.seen.bytes() + self.unseen.capacity() * size_of::<Slot>()
    }
}
