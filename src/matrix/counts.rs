//! How many solids make a cell opaque, so that one of them can go and leave the cells of the
//! others.
//!
//! The first is the bit of the cell itself; only cells with more than one cost more.

use glam::IVec3;

use crate::grid::bricks::Bricks;
use crate::grid::mask::{ALL, Mask, NONE, both, places_of, without};
use crate::matrix::bits::OpacityMatrix;

/// For each cell of a brick, the number of solids beyond the first that make it opaque.
#[derive(Clone, Default)]
struct MoreSolids {
    /// Solids that count for every cell.
    whole: u32,
    /// More of them by cell.
    cells: Option<Box<[u32; 512]>>,
    /// Cells with a number above zero in there.
    used: Mask,
}

impl MoreSolids {
    fn cells(&mut self) -> &mut [u32; 512] {
        self.cells.get_or_insert_with(|| Box::new([0; 512]))
    }

    fn add(&mut self, mask: &Mask) {
        if *mask == ALL {
            self.whole += 1;
            return;
        }
        let cells = self.cells();
        places_of(mask).for_each(|i| cells[i] += 1);
        self.used = std::array::from_fn(|z| self.used[z] | mask[z]);
    }

    /// Takes one away from each cell of a mask that has any. Gives those that have none.
    fn take(&mut self, mask: &Mask) -> Mask {
        if self.whole > 0 && *mask == ALL {
            self.whole -= 1;
            return NONE;
        }
        let whole = std::mem::take(&mut self.whole);
        if whole > 0 {
            self.cells().iter_mut().for_each(|n| *n += whole);
            self.used = ALL;
        }
        let some = both(mask, &self.used);
        let mut used = self.used;
        if some != NONE {
            let cells = self.cells();
            for i in places_of(&some) {
                cells[i] -= 1;
                if cells[i] == 0 {
                    used[i >> 6] &= !(1 << (i & 63));
                }
            }
        }
        self.used = used;
        without(mask, &some)
    }

    fn is_empty(&self) -> bool {
        self.whole == 0 && self.used == NONE
    }
}

/// Opaque cells, and how many solids make each of them opaque.
#[derive(Clone, Default)]
pub(crate) struct OpaqueCells {
    bits: OpacityMatrix,
    beyond: Bricks<MoreSolids>,
}

impl OpaqueCells {
    #[inline]
    pub(crate) fn bits(&self) -> &OpacityMatrix {
        &self.bits
    }

    /// Adds a solid that contains cells of a brick.
    pub(crate) fn add(&mut self, brick: IVec3, mask: &Mask) {
        let again = both(mask, self.bits.brick(brick));
        if again != NONE {
            self.beyond.get_mut(brick).add(&again);
        }
        if again != *mask {
            self.bits.set_mask(brick, mask);
        }
    }

    /// One solid fewer contains these cells of a brick, all of which are set: clears and gives
    /// those that no other contains.
    pub(crate) fn take(&mut self, brick: IVec3, mask: &Mask) -> Mask {
        let gone = match self.beyond.get_existing_mut(brick) {
            Some(beyond) => {
                let gone = beyond.take(mask);
                if beyond.is_empty() {
                    self.beyond.release(brick);
                }
                gone
            }
            None => *mask,
        };
        if gone != NONE {
            self.bits.clear_mask(brick, &gone);
        }
        gone
    }

    /// Adds a solid that contains a whole page; false, without a change, if a cell of the page is
    /// set.
    pub(crate) fn add_page(&mut self, page: IVec3) -> bool {
        let free = self.bits.pages().is_empty(page);
        if free {
            self.bits.fill_page(page);
        }
        free
    }

    /// Clears a page that a single solid contains; false, without a change, if there are others.
    pub(crate) fn take_page(&mut self, page: IVec3) -> bool {
        let single = self.beyond.pages().is_empty(page);
        if single {
            self.bits.clear_page(page);
        }
        single
    }

    /// Makes a cell opaque that no single solid contains.
    pub(crate) fn set(&mut self, cell: IVec3) {
        self.bits.set(cell);
    }

    pub(crate) fn bytes(&self) -> usize {
        let cells = self.beyond.iter().filter(|(_, b)| b.cells.is_some()).count();
        self.bits.bytes() + self.beyond.bytes() + cells * size_of::<[u32; 512]>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn cells_stay_set_until_the_last_solid_goes() {
        let mut random = Random::new(11);
        let mut next = |n: u32| random.below(n);
        let brick = IVec3::new(1, 2, 1);
        let mut counts = OpaqueCells::default();
        let mut held: Vec<Mask> = Vec::new();
        for step in 0..2000 {
            let fewer = step >= 1500 || held.len() > 8;
            if fewer && !held.is_empty() {
                let mask = held.swap_remove(next(held.len() as u32) as usize);
                let gone = counts.take(brick, &mask);
                for i in 0..512usize {
                    let has = |m: &Mask| m[i >> 6] >> (i & 63) & 1 != 0;
                    assert_eq!(has(&gone), has(&mask) && !held.iter().any(has), "step {step}, cell {i}");
                }
            } else if step < 1500 {
                let mask = match next(3) {
                    0 => ALL,
                    1 => std::array::from_fn(|_| u64::from(next(1 << 16)) << (next(7) * 8)),
                    _ => std::array::from_fn(|z| if z < 5 { u64::MAX } else { u64::from(next(2)) }),
                };
                counts.add(brick, &mask);
                held.push(mask);
            }
            let all: Mask = std::array::from_fn(|z| held.iter().fold(0, |sum, m| sum | m[z]));
            assert_eq!(*counts.bits.brick(brick), all, "step {step}");
        }
        assert_eq!((counts.bits.count(), counts.beyond.iter().count()), (0, 0));
    }
}
