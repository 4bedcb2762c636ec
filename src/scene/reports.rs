//! When objects that are reported on expiry were last reported.
//!
//! Such an object is *overdue* if it is in no volume and was not reported since the clock last
//! moved. Most are reported a moment later. So those that are listed in zones
//! ([`crate::scene::movers`]) become overdue without a change of any list: this log tells which
//! ones are, and how many. The others change their state ([`crate::scene::state`]).

use casca_slots::Slot;

use crate::scene::slot_bits::SlotBits;

/// The last reports of objects that are reported on expiry.
#[derive(Debug, Clone)]
pub(super) struct ReportLog {
    /// Counts the times that the clock was moved.
    tick: u64,
    /// By slot: the tick of the last report, or 0.
    last: Vec<u64>,
    /// Those listed in zones, and how many they are.
    zoned: SlotBits,
    count: usize,
    /// How many of these are overdue.
    overdue: usize,
}

impl Default for ReportLog {
    fn default() -> Self {
        Self { tick: 1, last: Vec::new(), zoned: SlotBits::default(), count: 0, overdue: 0 }
    }
}

impl ReportLog {
    /// The clock moves: no report tells where an object is any more.
    pub(super) fn clock_moved(&mut self) {
        self.tick += 1;
        self.overdue = self.count;
    }

    /// An object is reported. Returns whether it is in a zone and was overdue.
    #[inline]
    pub(super) fn report(&mut self, slot: Slot) -> bool {
        if self.last.len() <= slot.index() {
            self.last.resize(slot.index() + 1, 0);
        }
        let before = std::mem::replace(&mut self.last[slot.index()], self.tick);
        let overdue = before != self.tick && self.zoned.contains(slot);
        self.overdue -= usize::from(overdue);
        overdue
    }

    /// Whether an object was reported since the clock last moved.
    #[inline]
    pub(super) fn is_current(&self, slot: Slot) -> bool {
        self.last.get(slot.index()) == Some(&self.tick)
    }

    /// An object is listed in a zone from now on.
    pub(super) fn enter_zone(&mut self, slot: Slot) {
        if self.zoned.insert(slot) {
            self.count += 1;
            self.overdue += usize::from(!self.is_current(slot));
        }
    }

    /// An object is in no zone any more; nothing changes if it was in none.
    pub(super) fn leave_zone(&mut self, slot: Slot) {
        if self.zoned.remove(slot) {
            self.count -= 1;
            self.overdue -= usize::from(!self.is_current(slot));
        }
    }

    /// No object is in a zone any more.
    pub(super) fn leave_all_zones(&mut self) {
        self.zoned.clear();
        (self.count, self.overdue) = (0, 0);
    }

    /// How many objects in zones are overdue.
    #[inline]
    pub(super) fn count_overdue(&self) -> usize {
        self.overdue
    }

    /// The objects in zones that are overdue, in the order of slots. Costs nothing if there are
    /// none, else a look at each object in a zone that is reported on expiry.
    pub(super) fn overdue(&self) -> impl Iterator<Item = Slot> {
        let all = (self.overdue > 0).then(|| self.zoned.iter());
        all.into_iter().flatten().filter(|&slot| !self.is_current(slot))
    }

    pub(super) fn bytes(&self) -> usize {
        self.last.capacity() * size_of::<u64>() + self.zoned.bytes()
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
        let (mut last, mut zoned, mut now) = (BTreeMap::new(), BTreeSet::new(), 0);
        for _ in 0..6000 {
            let slot = Slot::new((random.next().abs() * 40.0) as u32);
            let current = last.get(&slot) == Some(&now);
            match (random.next().abs() * 20.0) as u32 {
                0 => {
                    log.clock_moved();
                    now += 1;
                }
                1 => {
                    log.leave_all_zones();
                    zoned.clear();
                }
                2..6 => {
                    log.leave_zone(slot);
                    zoned.remove(&slot);
                }
                6..11 => {
                    log.enter_zone(slot);
                    zoned.insert(slot);
                }
                _ => {
                    assert_eq!(log.report(slot), zoned.contains(&slot) && !current);
                    last.insert(slot, now);
                }
            }
            let expected: Vec<_> =
                zoned.iter().filter(|&slot| last.get(slot) != Some(&now)).copied().collect();
            let mut found: Vec<_> = log.overdue().collect();
            found.sort_unstable();
            assert_eq!((log.count_overdue(), found), (expected.len(), expected));
            assert_eq!(log.is_current(slot), last.get(&slot) == Some(&now));
        }
        assert!(now > 100);
    }
}
