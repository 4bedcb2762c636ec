//! I: which objects touch each brick (a superset).
//!
//! Those of single cells are listed by the queries that ask for them: see
//! `query::cell::lists`.

use casca_slots::Slot;
use glam::IVec3;

use crate::grid::bricks::{Bricks, Pages};
use crate::grid::mask::{Mask, NONE};
use crate::matrix::slots::SlotList;

/// I: the objects that touch each brick, as indices of the scene's slots.
#[derive(Clone, Default)]
pub struct IdMatrix {
    bricks: Bricks<SlotList>,
}

impl IdMatrix {
    /// Moves an object inside a brick: it leaves the cells of `old`, which are all that it is in,
    /// and enters those of `new`.
    pub(crate) fn change(&mut self, brick: IVec3, old: &Mask, new: &Mask, slot: Slot) {
        match (*old == NONE, *new == NONE) {
            (true, false) => self.bricks.get_mut(brick).push(slot),
            (false, true) => {
                let slots = self.bricks.get_mut(brick);
                slots.find(slot).into_iter().for_each(|i| slots.swap_remove(i));
                if slots.as_slice().is_empty() {
                    self.bricks.release(brick);
                }
            }
            _ => {}
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
    use std::collections::BTreeMap;

    use super::*;
    use crate::grid::mask::ALL;
    use crate::random::Random;

    #[test]
    fn agrees_with_a_map() {
        let bricks = [IVec3::new(1, 1, 1), IVec3::new(2, 0, 1), IVec3::new(9, 1, 2)];
        let mut m = IdMatrix::default();
        let mut map = BTreeMap::<([i32; 3], Slot), Mask>::new();
        let mut random = Random::new(1);
        let compare = |m: &IdMatrix, map: &BTreeMap<([i32; 3], Slot), Mask>| {
            for brick in bricks {
                let mut members: Vec<Slot> = m.in_brick(brick).collect();
                members.sort_unstable();
                let here = map.keys().filter(|(at, _)| *at == brick.to_array());
                assert_eq!(members, here.map(|(_, slot)| *slot).collect::<Vec<_>>());
            }
            assert_eq!(m.entries(), map.len());
        };
        for _ in 0..1500 {
            let (brick, slot) = (bricks[random.below(3) as usize], Slot::new(random.below(90)));
            let new: Mask = match random.below(3) {
                0 => ALL,
                1 => NONE,
                _ => std::array::from_fn(|z| if z == 4 { 1 << random.below(64) } else { 0 }),
            };
            let old = map.insert((brick.to_array(), slot), new).unwrap_or(NONE);
            if new == NONE {
                map.remove(&(brick.to_array(), slot));
            }
            m.change(brick, &old, &new, slot);
            compare(&m, &map);
        }
        for ((brick, slot), old) in std::mem::take(&mut map) {
            m.change(IVec3::from_array(brick), &old, &NONE, slot);
        }
        compare(&m, &map);
        assert_eq!(m.bricks.iter().count(), 0);
    }
}
