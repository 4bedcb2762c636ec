//! The queue of the times at which something in a slot expires.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::slot::Slot;

/// The queue is looked through for old entries when it is longer than this and twice the objects.
const MANY: usize = 64;

/// A slot whose value expires. Earlier ones are greater, so that a heap gives them first; those of
/// one time are ordered by slot and generation, the lesser first.
#[derive(Debug, Clone, Copy)]
pub struct Expiry {
    /// In seconds.
    pub at: f64,
    /// The slot.
    pub slot: Slot,
    /// The slot's generation: the entry is void once the slot has another value.
    pub generation: u32,
}

impl PartialEq for Expiry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
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

/// Expiries, the earliest first. Entries are never taken out when a value changes: whoever pops
/// one asks whether it still counts.
#[derive(Debug, Clone, Default)]
pub struct ExpiryQueue(BinaryHeap<Expiry>);

impl ExpiryQueue {
    /// Adds an entry.
    pub fn push(&mut self, entry: Expiry) {
        self.0.push(entry);
    }

    /// Takes the earliest entry, if it is not later than a time.
    pub fn pop_until(&mut self, time: f64) -> Option<Expiry> {
        self.0.peek().filter(|next| next.at <= time)?;
        self.0.pop()
    }

    /// Whether most entries must be old, since there are many more than this number of values.
    #[inline]
    pub fn is_crowded(&self, values: usize) -> bool {
        self.0.len() > 2 * values + MANY
    }

    /// Drops the entries that no longer count.
    pub fn retain(&mut self, counts: impl FnMut(&Expiry) -> bool) {
        self.0.retain(counts);
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        self.0.capacity() * size_of::<Expiry>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(at: f64, slot: u32, generation: u32) -> Expiry {
        Expiry { at, slot: Slot::new(slot), generation }
    }

    #[test]
    fn entries_come_by_time_then_slot_then_generation() {
        let mut queue = ExpiryQueue::default();
        let order = [
            entry(f64::NEG_INFINITY, 9, 0),
            entry(-1.0, 7, 0),
            entry(0.5, 1, 3),
            entry(0.5, 1, 4),
            entry(0.5, 2, 0),
            entry(2.0, 0, 0),
            entry(f64::INFINITY, 0, 0),
        ];
        for i in [3, 6, 0, 5, 2, 4, 1] {
            queue.push(order[i]);
        }
        let until =
            |queue: &mut ExpiryQueue, time| std::iter::from_fn(|| queue.pop_until(time)).collect::<Vec<_>>();
        assert_eq!(until(&mut queue, -2.0), order[..1]);
        assert_eq!(until(&mut queue, 0.5), order[1..5], "an entry of the very time is due");
        assert_eq!(until(&mut queue, 1.9), []);
        assert_eq!(until(&mut queue, f64::INFINITY), order[5..]);
    }

    #[test]
    fn compaction_keeps_order_and_what_counts() {
        let mut queue = ExpiryQueue::default();
        let many = MANY as u32 + 10;
        for slot in (0..many).rev() {
            queue.push(entry(f64::from(slot), slot, slot % 2));
        }
        assert!(queue.is_crowded(4) && !queue.is_crowded(5));
        // Odd slots were given to other values since.
        queue.retain(|e| e.generation == 0);
        let left: Vec<u32> = std::iter::from_fn(|| queue.pop_until(1e9)).map(|e| e.slot.get()).collect();
        assert!(left.into_iter().eq((0..many).step_by(2)));
    }
}
