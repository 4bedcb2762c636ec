//! What tells whether a result still holds: the number of changes of a scene, and the last of them,
//! so that who looked at everything once looks only at the changes since.

use std::collections::VecDeque;

use casca_slots::Slot;

use crate::geometry::Block;

/// More new volumes than this and than objects are not kept: then it is cheaper to test all again.
const MANY: usize = 1024;

/// More changes of static objects than this are not kept: then a new result costs less than to
/// follow them.
pub(super) const MOST_STATIC: usize = 2048;

/// A static object came, went or changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StaticChange {
    slot: Slot,
    occluder: Option<Block>,
}

impl StaticChange {
    pub(super) fn new(slot: Slot, occluder: Option<Block>) -> Self {
        Self { slot, occluder }
    }

    /// The slot of the object.
    pub(crate) fn slot(&self) -> Slot {
        self.slot
    }

    /// A box around the occluder that it had before.
    pub(crate) fn occluder(&self) -> Option<Block> {
        self.occluder
    }
}

/// The last changes of a kind, in the order in which they came.
#[derive(Debug, Clone)]
pub(crate) struct Journal<T> {
    /// How many entries were dropped.
    dropped: u64,
    entries: VecDeque<T>,
}

impl<T> Default for Journal<T> {
    fn default() -> Self {
        Self { dropped: 0, entries: VecDeque::new() }
    }
}

impl<T: Copy> Journal<T> {
    /// Adds an entry, where up to `most` are kept, or 1,024 if those are more.
    pub(super) fn push(&mut self, entry: T, most: usize) {
        if self.entries.len() >= MANY.max(most) {
            self.entries.pop_front();
            self.dropped += 1;
        }
        self.entries.push_back(entry);
    }

    /// Drops all entries, and one that was never made: whoever asks for those since an earlier end
    /// is told to look at everything.
    pub(super) fn cut(&mut self) {
        self.dropped += self.entries.len() as u64 + 1;
        self.entries.clear();
    }

    /// The number of all entries ever made.
    pub(crate) fn end(&self) -> u64 {
        self.dropped + self.entries.len() as u64
    }

    /// The entries since there were `end` of them; `None` if some were dropped.
    pub(crate) fn since(&self, end: u64) -> Option<impl ExactSizeIterator<Item = T>> {
        let first = usize::try_from(end.checked_sub(self.dropped)?).ok()?;
        Some(self.entries.range(first.min(self.entries.len())..).copied())
    }

    pub(super) fn bytes(&self) -> usize {
        self.entries.capacity() * size_of::<T>()
    }
}

/// The changes of a scene, counted, with the last ones of two kinds.
#[derive(Debug, Clone, Default)]
pub(super) struct Changes {
    /// Changes that a result may depend on.
    pub(super) revision: u64,
    /// Moves of all objects, hidden ones included.
    pub(super) moves: u64,
    /// The objects that were put into a volume, or whose layers changed there.
    pub(super) volumes: Journal<Slot>,
    /// The static objects that came, went or changed.
    pub(super) fixed: Journal<StaticChange>,
}

impl Changes {
    /// Something changed that a result may depend on.
    #[inline]
    pub(super) fn changed(&mut self) {
        self.revision += 1;
    }

    /// An object moved: gives the number of the move.
    #[inline]
    pub(super) fn moved(&mut self) -> u64 {
        self.moves += 1;
        self.moves
    }

    /// One of this many objects has another volume, or other layers in its volume.
    pub(super) fn volume_is_new(&mut self, slot: Slot, objects: usize) {
        self.volumes.push(slot, objects);
    }

    /// A static object comes, goes or changes; the box is around its occluder before.
    pub(super) fn static_changed(&mut self, slot: Slot, occluder: Option<Block>) {
        self.fixed.push(StaticChange::new(slot, occluder), MOST_STATIC);
    }

    /// All static objects changed.
    pub(super) fn all_static_changed(&mut self) {
        self.fixed.cut();
    }

    pub(super) fn bytes(&self) -> usize {
        self.volumes.bytes() + self.fixed.bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_told_until_they_are_dropped() {
        let mut journal = Journal::default();
        let told = |journal: &Journal<u32>, end| journal.since(end).map(Iterator::collect::<Vec<_>>);
        (0..5).for_each(|slot| journal.push(slot, 3));
        assert_eq!(told(&journal, 0), Some(vec![0, 1, 2, 3, 4]));
        assert_eq!(told(&journal, 3), Some(vec![3, 4]));
        assert_eq!((told(&journal, journal.end()), told(&journal, 9)), (Some(vec![]), Some(vec![])));
        (0..MANY as u32).for_each(|slot| journal.push(slot, 3));
        assert_eq!(told(&journal, 4), None, "dropped");
        assert_eq!(told(&journal, 5).map(|slots| slots.len()), Some(MANY));
        assert_eq!(journal.end(), MANY as u64 + 5);
    }
}
