//! Marks of objects that a query has decided.

use casca_slots::Slot;

/// For each slot of the scene, whether the running query has seen its volume, or decided the object
/// itself.
#[derive(Debug, Clone, Default)]
pub(crate) struct Marks {
    /// Twice the query's number if the volume was revealed, one more if the object was decided.
    marks: Vec<u32>,
    /// The number of the running query.
    epoch: u32,
}

impl Marks {
    /// Forgets all marks, for a scene with this number of slots.
    pub(crate) fn begin(&mut self, slots: usize) {
        self.marks.resize(slots.max(self.marks.len()), 0);
        self.epoch += 1;
        if self.epoch >= u32::MAX / 2 {
            self.marks.fill(0);
            self.epoch = 1;
        }
    }

    pub(crate) fn is_decided(&self, slot: Slot) -> bool {
        self.marks[slot.index()] == self.epoch * 2 + 1
    }

    /// Whether the object's volume was revealed, or the object itself decided.
    pub(crate) fn is_revealed(&self, slot: Slot) -> bool {
        self.marks[slot.index()] >= self.epoch * 2
    }

    /// Marks an object as decided. Returns whether it was not.
    pub(crate) fn decide(&mut self, slot: Slot) -> bool {
        let new = !self.is_decided(slot);
        self.marks[slot.index()] = self.epoch * 2 + 1;
        new
    }

    /// Marks an object's volume as revealed. Returns whether it was not.
    pub(crate) fn reveal(&mut self, slot: Slot) -> bool {
        let new = !self.is_revealed(slot);
        if new {
            self.marks[slot.index()] = self.epoch * 2;
        }
        new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_last_for_one_query() {
        let mut marks = Marks::default();
        // The last rounds wrap the number of the query around.
        for epoch in [0, 1, u32::MAX / 2 - 2, u32::MAX / 2 - 1] {
            marks.epoch = epoch;
            marks.begin(3);
            assert!(Slot::below(3).all(|slot| !marks.is_revealed(slot) && !marks.is_decided(slot)));
            let [one, two] = [1, 2].map(Slot::new);
            assert!(marks.reveal(one) && !marks.reveal(one));
            assert!(marks.is_revealed(one) && !marks.is_decided(one));
            assert!(marks.decide(one) && !marks.decide(one) && marks.decide(two));
            assert!(!marks.reveal(two) && marks.is_revealed(two) && marks.is_decided(one));
        }
    }
}
