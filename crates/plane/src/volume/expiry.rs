//! The queue of the times at which volumes expire.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The queue is looked through for old entries when it is longer than this and twice the objects.
const MANY: usize = 64;

/// The time of an entry that is due at once, whatever the clock says.
pub(crate) const AT_ONCE: f64 = f64::NEG_INFINITY;

/// An object whose volume expires, ordered by time, slot and generation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Expiry {
    /// In seconds.
    pub(crate) at: f64,
    pub(crate) slot: u32,
    /// The slot's generation: the entry is void once the slot has another object.
    pub(crate) generation: u32,
}

impl Eq for Expiry {}

impl PartialOrd for Expiry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Expiry {
    /// The earliest is the greatest: [`BinaryHeap`] gives the greatest first.
    fn cmp(&self, other: &Self) -> Ordering {
        let time = other.at.total_cmp(&self.at);
        time.then(other.slot.cmp(&self.slot)).then(other.generation.cmp(&self.generation))
    }
}

/// Expiries, the earliest first. Entries are never taken out when an object changes: whoever pops one asks whether it still counts.
#[derive(Debug, Clone, Default)]
pub(crate) struct ExpiryQueue(BinaryHeap<Expiry>);

impl ExpiryQueue {
    pub(crate) fn push(&mut self, entry: Expiry) {
        self.0.push(entry);
    }

    /// Takes the earliest entry, if it is not later than a time.
    pub(crate) fn pop_until(&mut self, time: f64) -> Option<Expiry> {
        self.0.peek().filter(|next| next.at <= time)?;
        self.0.pop()
    }

    /// Whether there are so many entries for this number of objects that most of them must be old.
    pub(crate) fn is_crowded(&self, objects: usize) -> bool {
        self.0.len() > 2 * objects + MANY
    }

    /// Drops the entries that no longer count.
    pub(crate) fn retain(&mut self, counts: impl FnMut(&Expiry) -> bool) {
        self.0.retain(counts);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_come_by_time_then_slot_then_generation() {
        let mut queue = ExpiryQueue::default();
        let entry = |at, slot, generation| Expiry { at, slot, generation };
        let order = [
            entry(AT_ONCE, 9, 0),
            entry(-1.0, 7, 0),
            entry(0.5, 1, 3),
            entry(0.5, 1, 4),
            entry(0.5, 2, 0),
            entry(f64::INFINITY, 0, 0),
        ];
        [3, 0, 5, 2, 4, 1].into_iter().for_each(|i| queue.push(order[i]));
        let until =
            |queue: &mut ExpiryQueue, time| std::iter::from_fn(|| queue.pop_until(time)).collect::<Vec<_>>();
        assert_eq!(until(&mut queue, -2.0), order[..1]);
        assert_eq!(until(&mut queue, 0.5), order[1..5], "an entry of the very time is due");
        assert_eq!(until(&mut queue, f64::INFINITY), order[5..]);
        assert!(!queue.is_crowded(0));
        (0..=MANY as u32).for_each(|slot| queue.push(entry(1.0, slot, slot % 2)));
        assert!(queue.is_crowded(0) && !queue.is_crowded(1));
        queue.retain(|e| e.generation == 0);
        assert!(until(&mut queue, 9.0).iter().map(|e| e.slot).eq((0..=MANY as u32).step_by(2)));
    }
}
