//! I: which objects touch each brick (a superset).
//!
//! Those of single cells are listed by the queries that ask for them: see
//! `query::cell::lists`.

use casca_slots::Slot;
use glam::IVec3;

use crate::grid::bricks::{Bricks, Pages};
use crate::matrix::slots::SlotList;

/// I: the objects that touch each brick, as indices of the scene's slots.
#[derive(Clone, Default)]
pub struct IdMatrix {
    bricks: Bricks<SlotList>,
}

impl IdMatrix {
    /// Lists an object in a brick; it was not there.
    pub(crate) fn insert(&mut self, brick: IVec3, slot: Slot) {
        self.bricks.get_mut(brick).push(slot);
    }

    /// Takes an object out of a brick.
    pub(crate) fn remove(&mut self, brick: IVec3, slot: Slot) {
        let slots = self.bricks.get_mut(brick);
        slots.find(slot).into_iter().for_each(|i| slots.swap_remove(i));
        if slots.as_slice().is_empty() {
            self.bricks.release(brick);
        }
    }

    /// The objects that touch a brick.
    #[inline]
    pub(crate) fn in_brick(&self, brick: IVec3) -> impl ExactSizeIterator<Item = Slot> {
        self.bricks.get(brick).as_slice().iter().copied()
    }

    /// The pages that contain objects.
    #[inline]
    pub(crate) fn pages(&self) -> &Pages {
        self.bricks.pages()
    }

    /// Number of pairs of a brick and an object that touches it.
    pub fn entries(&self) -> usize {
        self.bricks.iter().map(|(_, slots)| slots.as_slice().len()).sum()
    }

    /// Bytes of memory that the matrix uses.
    pub fn bytes(&self) -> usize {
        self.bricks.bytes() + self.bricks.iter().map(|(_, slots)| slots.bytes()).sum::<usize>()
    }
}

impl std::fmt::Debug for IdMatrix {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "IdMatrix({} bricks with objects)", self.bricks.iter().count())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::random::Random;

    #[test]
    fn agrees_with_a_set() {
        let bricks = [IVec3::new(1, 1, 1), IVec3::new(2, 0, 1), IVec3::new(9, 1, 2)];
        let (mut m, mut set, mut random) = (IdMatrix::default(), BTreeSet::new(), Random::new(1));
        for step in 0..2500 {
            let (i, slot) = (random.below(3) as usize, Slot::new(random.below(90)));
            if set.remove(&(i, slot)) {
                m.remove(bricks[i], slot);
            } else if step < 1500 {
                set.insert((i, slot));
                m.insert(bricks[i], slot);
            }
            for (i, brick) in bricks.into_iter().enumerate() {
                let mut members: Vec<Slot> = m.in_brick(brick).collect();
                members.sort_unstable();
                assert!(members.into_iter().eq(set.iter().filter(|own| own.0 == i).map(|own| own.1)));
            }
            assert_eq!(m.entries(), set.len());
        }
        set.iter().for_each(|&(i, slot)| m.remove(bricks[i], slot));
        assert_eq!(m.bricks.iter().count(), 0);
    }
}
