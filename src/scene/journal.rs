//! A list of the hidden objects whose volumes changed, so that who tested all volumes once tests only those since.

use std::collections::VecDeque;

/// More entries than this and than objects are not kept: then it is cheaper to test all volumes again.
const MANY: usize = 1024;

/// The slots of objects that were put into a volume, or whose layers changed there, in this order.
#[derive(Debug, Clone, Default)]
pub(crate) struct Journal {
    /// How many entries were dropped.
    dropped: u64,
    slots: VecDeque<u32>,
}

impl Journal {
    /// Adds an entry, for a scene of so many objects.
    pub(super) fn push(&mut self, slot: u32, objects: usize) {
        if self.slots.len() >= MANY.max(objects) {
            self.slots.pop_front();
            self.dropped += 1;
        }
        self.slots.push_back(slot);
    }

    /// The number of all entries ever made.
    pub(crate) fn end(&self) -> u64 {
        self.dropped + self.slots.len() as u64
    }

    /// The entries since there were `end` of them; `None` if some were dropped.
    pub(crate) fn since(&self, end: u64) -> Option<impl Iterator<Item = u32>> {
        let first = usize::try_from(end.checked_sub(self.dropped)?).ok()?;
        Some(self.slots.range(first.min(self.slots.len())..).copied())
    }

    pub(super) fn bytes(&self) -> usize {
        self.slots.capacity() * size_of::<u32>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_told_until_they_are_dropped() {
        let mut journal = Journal::default();
        let told = |journal: &Journal, end| journal.since(end).map(Iterator::collect::<Vec<_>>);
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
