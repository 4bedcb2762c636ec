//! When objects that are reported on expiry were last reported.
//!
//! Such an object is *overdue* if it is listed and was not reported since the clock last moved. Most
//! are reported a moment later. So they become overdue without a change of any list: this log tells
//! which ones are, and how many.

use casca_slots::Slot;

use crate::scene::slot_bits::SlotBits;

/// How many objects are reported on expiry, and how many of them are overdue.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Overdue {
    all: usize,
    overdue: usize,
}

impl Overdue {
    /// How many are overdue.
    #[inline]
    pub(super) fn count(self) -> usize {
        self.overdue
    }

    /// The clock moves.
    pub(super) fn clock_moved(&mut self) {
        self.overdue = self.all;
    }

    /// One that was overdue is reported.
    pub(super) fn report(&mut self) {
        self.overdue -= 1;
    }

    /// One comes, reported since the clock last moved or not.
    pub(super) fn enter(&mut self, is_current: bool) {
        self.all += 1;
        self.overdue += usize::from(!is_current);
    }

    /// One goes.
    pub(super) fn leave(&mut self, is_current: bool) {
        self.all -= 1;
        self.overdue -= usize::from(!is_current);
    }
}

/// The last reports of objects that are reported on expiry.
#[derive(Debug, Clone)]
pub(super) struct ReportLog {
    /// Counts the times that the clock was moved.
    tick: u64,
    /// By slot: the tick of the last report, or 0.
    last: Vec<u64>,
    /// Those that are listed.
    listed: SlotBits,
    counts: Overdue,
}

impl Default for ReportLog {
    fn default() -> Self {
        Self { tick: 1, last: Vec::new(), listed: SlotBits::default(), counts: Overdue::default() }
    }
}

impl ReportLog {
    /// The clock moves: no report tells where an object is any more.
    pub(super) fn clock_moved(&mut self) {
        self.tick += 1;
        self.counts.clock_moved();
    }

    /// An object is reported. Returns whether it was overdue.
    #[inline]
    pub(super) fn report(&mut self, slot: Slot) -> bool {
        if self.last.len() <= slot.index() {
            self.last.resize(slot.index() + 1, 0);
        }
        let before = std::mem::replace(&mut self.last[slot.index()], self.tick);
        let overdue = before != self.tick && self.listed.contains(slot);
        if overdue {
            self.counts.report();
        }
        overdue
    }

    /// An object comes to a slot, and is not reported yet.
    pub(super) fn forget(&mut self, slot: Slot) {
        if let Some(last) = self.last.get_mut(slot.index()) {
            *last = 0;
        }
    }

    /// Whether an object was reported since the clock last moved.
    #[inline]
    pub(super) fn is_current(&self, slot: Slot) -> bool {
        self.last.get(slot.index()) == Some(&self.tick)
    }

    /// An object is listed from now on.
    pub(super) fn enter(&mut self, slot: Slot) {
        if self.listed.insert(slot) {
            self.counts.enter(self.is_current(slot));
        }
    }

    /// An object is not listed any more; nothing changes if it was not.
    pub(super) fn leave(&mut self, slot: Slot) {
        if self.listed.remove(slot) {
            self.counts.leave(self.is_current(slot));
        }
    }

    /// No object is listed any more.
    pub(super) fn leave_all(&mut self) {
        self.listed.clear();
        self.counts = Overdue::default();
    }

    /// How many listed objects are overdue.
    #[inline]
    pub(super) fn count_overdue(&self) -> usize {
        self.counts.count()
    }

    /// The listed objects that are overdue, in the order of slots. Costs nothing if there are none,
    /// else a look at each listed object that is reported on expiry.
    pub(super) fn overdue(&self) -> impl Iterator<Item = Slot> {
        let all = (self.counts.count() > 0).then(|| self.listed.iter());
        all.into_iter().flatten().filter(|&slot| !self.is_current(slot))
    }

    pub(super) fn bytes(&self) -> usize {
        self.last.capacity() * size_of::<u64>() + self.listed.bytes()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, BTreeSet};

    use super::*;
    use crate::random::Random;

    #[test]
    fn the_log_knows_who_is_overdue() {
        let (mut log, mut random) = (ReportLog::default(), Random::new(4));
        let (mut last, mut listed, mut now) = (BTreeMap::new(), BTreeSet::new(), 0);
        for _ in 0..6000 {
            let slot = Slot::new((random.next().abs() * 40.0) as u32);
            let current = last.get(&slot) == Some(&now);
            match (random.next().abs() * 20.0) as u32 {
                0 => {
                    log.clock_moved();
                    now += 1;
                }
                1 => {
                    log.leave_all();
                    listed.clear();
                }
                2..6 => {
                    log.leave(slot);
                    listed.remove(&slot);
                }
                6..11 => {
                    log.enter(slot);
                    listed.insert(slot);
                }
                11 if !listed.contains(&slot) => {
                    log.forget(slot);
                    last.remove(&slot);
                }
                _ => {
                    assert_eq!(log.report(slot), listed.contains(&slot) && !current);
                    last.insert(slot, now);
                }
            }
            let expected: Vec<_> =
                listed.iter().filter(|&slot| last.get(slot) != Some(&now)).copied().collect();
            let mut found: Vec<_> = log.overdue().collect();
            found.sort_unstable();
            assert_eq!((log.count_overdue(), found), (expected.len(), expected));
            assert_eq!(log.is_current(slot), last.get(&slot) == Some(&now));
        }
        assert!(now > 100);
    }
}
