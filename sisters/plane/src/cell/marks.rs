//! Marks of objects that a query has decided.

use casca_slots::Slot;

/// For each slot of the scene, whether the running query has seen its volume, or decided the object
/// itself.
#[derive(Debug, Clone, Default)]
pub(super) struct Marks {
    /// Twice the query's number if the volume was seen, one more if the object was decided.
    marks: Vec<u64>,
    /// The number of the running query.
    query: u64,
}

impl Marks {
    /// Forgets all marks, for a scene with so many slots.
    pub(super) fn begin(&mut self, slots: usize) {
        self.marks.resize(slots.max(self.marks.len()), 0);
        self.query += 1;
    }

    /// Marks an object as decided. Returns whether it was not.
    pub(super) fn decide(&mut self, slot: Slot) -> bool {
        std::mem::replace(&mut self.marks[slot.index()], 2 * self.query + 1) != 2 * self.query + 1
    }

    /// Marks an object's volume as seen. Returns whether neither that nor the object was marked.
    pub(super) fn reveal(&mut self, slot: Slot) -> bool {
        let mark = &mut self.marks[slot.index()];
        let new = *mark < 2 * self.query;
        *mark = (*mark).max(2 * self.query);
        new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_last_for_one_query() {
        let mut marks = Marks::default();
        for _ in 0..3 {
            marks.begin(3);
            let [zero, one, two] = [0, 1, 2].map(Slot::new);
            assert!(marks.reveal(one) && !marks.reveal(one));
            assert!(marks.decide(one) && !marks.decide(one) && marks.decide(two));
            assert!(!marks.reveal(two) && marks.reveal(zero));
        }
    }
}
