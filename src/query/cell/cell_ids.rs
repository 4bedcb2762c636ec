//! The objects of single cells.

use casca_slots::{MOST_SLOTS, Slot};
use glam::IVec3;

use crate::grid::bricks::{Bricks, Pages};
use crate::grid::mask::{Mask, places_of, tile_of, without};
use crate::grid::side::SideAxes;
use crate::matrix::slots::SlotList;

/// The mark of a cell with several objects; the rest of the number is the index of their list.
/// No slot has it: there are at most [`MOST_SLOTS`].
const SEVERAL: u32 = 1 << 31;

const _: () = assert!(MOST_SLOTS <= SEVERAL as usize);

/// The index of a list, in place of a slot.
fn several(list: u32) -> Slot {
    Slot::new(SEVERAL | list)
}

/// The list that stands in place of a slot, if one does.
#[inline]
fn list_of(held: Slot) -> Option<usize> {
    (held.get() & SEVERAL != 0).then_some((held.get() & !SEVERAL) as usize)
}

/// One brick: which cells have objects, and one number for each such cell, in the order of the
/// bits.
#[derive(Clone, Default)]
struct CellBrick {
    bits: Mask,
    /// Number of set bits before each word.
    before: [u16; 8],
    /// A slot, or what [`several`] makes of the index of a list.
    cells: Vec<Slot>,
}

impl CellBrick {
    #[inline]
    fn place(&self, word: usize, bit: u32) -> usize {
        let below = self.bits[word] & ((1u64 << bit) - 1);
        usize::from(self.before[word]) + below.count_ones() as usize
    }
}

/// The lists of cells with several objects.
#[derive(Clone, Default)]
struct SharedCells {
    lists: Vec<SlotList>,
    free: Vec<u32>,
}

impl SharedCells {
    fn make(&mut self, a: Slot, b: Slot) -> u32 {
        let mut list = SlotList::default();
        list.push(a);
        list.push(b);
        match self.free.pop() {
            Some(i) => {
                self.lists[i as usize] = list;
                i
            }
            None => {
                self.lists.push(list);
                self.lists.len() as u32 - 1
            }
        }
    }

    /// The objects that the number of a cell stands for.
    #[inline]
    fn of<'a>(&'a self, held: &'a Slot) -> &'a [Slot] {
        match list_of(*held) {
            None => std::slice::from_ref(held),
            Some(list) => self.lists[list].as_slice(),
        }
    }

    fn add(&mut self, brick: &mut CellBrick, i: usize, slot: Slot) {
        let (word, bit) = (i >> 6, (i & 63) as u32);
        let place = brick.place(word, bit);
        if brick.bits[word] >> bit & 1 == 0 {
            brick.bits[word] |= 1 << bit;
            brick.before[word + 1..].iter_mut().for_each(|n| *n += 1);
            brick.cells.insert(place, slot);
            return;
        }
        let held = &mut brick.cells[place];
        match list_of(*held) {
            Some(list) => self.lists[list].push(slot),
            None => *held = several(self.make(*held, slot)),
        }
    }

    /// Takes an object out of a cell, if it is there.
    fn remove(&mut self, brick: &mut CellBrick, i: usize, slot: Slot) {
        let (word, bit) = (i >> 6, (i & 63) as u32);
        if brick.bits[word] >> bit & 1 == 0 {
            return;
        }
        let place = brick.place(word, bit);
        let held = &mut brick.cells[place];
        if let Some(index) = list_of(*held) {
            let list = &mut self.lists[index];
            let Some(at) = list.find(slot) else { return };
            list.remove(at);
            if let &[last] = list.as_slice() {
                *held = last;
                *list = SlotList::default();
                self.free.push(index as u32);
            }
        } else if *held == slot {
            brick.bits[word] &= !(1 << bit);
            brick.before[word + 1..].iter_mut().for_each(|n| *n -= 1);
            brick.cells.remove(place);
        }
    }
}

/// The objects that touch single cells, but not all of their brick.
///
/// Cells with one object cost four bytes, and one bit tells an empty cell.
#[derive(Clone, Default)]
pub(super) struct CellIds {
    bricks: Bricks<CellBrick>,
    lists: SharedCells,
}

impl CellIds {
    /// The pages with cells that have objects.
    pub(super) fn pages(&self) -> &Pages {
        self.bricks.pages()
    }

    /// An object leaves cells of a brick and enters others.
    pub(super) fn change(&mut self, at: IVec3, old: &Mask, new: &Mask, slot: Slot) {
        let brick = self.bricks.get_mut(at);
        places_of(&without(old, new)).for_each(|i| self.lists.remove(brick, i, slot));
        places_of(&without(new, old)).for_each(|i| self.lists.add(brick, i, slot));
        if brick.cells.is_empty() {
            self.bricks.release(at);
        }
    }

    /// Number of pairs of a cell and an object.
    #[cfg(test)]
    pub(super) fn entries(&self) -> usize {
        let cells = self.bricks.iter().flat_map(|(_, brick)| &brick.cells);
        cells.map(|held| self.lists.of(held).len()).sum()
    }

    /// The objects of a cell.
    #[inline]
    pub(super) fn of(&self, cell: IVec3) -> &[Slot] {
        let brick = self.bricks.get(cell >> 3i32);
        let (word, bit) = ((cell.z & 7) as usize, (((cell.y & 7) << 3) | (cell.x & 7)) as u32);
        if brick.bits[word] >> bit & 1 == 0 {
            return &[];
        }
        self.lists.of(&brick.cells[brick.place(word, bit)])
    }

    /// Calls `found` with each cell of a tile whose bit is set, as its bit, and its objects.
    #[inline]
    pub(super) fn for_tile(
        &self,
        brick: IVec3,
        axes: &SideAxes,
        at: i32,
        mut tile: u64,
        mut found: impl FnMut(i32, &[Slot]),
    ) {
        let (brick, at) = (self.bricks.get(brick), at & 7);
        while tile != 0 {
            let bit = tile.trailing_zeros() as i32;
            tile &= tile - 1;
            let (row, col) = (bit >> 3, bit & 7);
            let (word, bit_in_word) = match axes.normal {
                0 => (row, col << 3 | at),
                1 => (row, at << 3 | col),
                _ => (at, bit),
            };
            let word = (word & 7) as usize;
            if brick.bits[word] >> bit_in_word & 1 == 0 {
                found(bit, &[]);
            } else if let Some(held) = brick.cells.get(brick.place(word, bit_in_word as u32)) {
                found(bit, self.lists.of(held));
            }
        }
    }

    /// Which cells of a tile have objects.
    #[inline]
    pub(super) fn tile(&self, brick: IVec3, axes: &SideAxes, at: i32) -> u64 {
        tile_of(&self.bricks.get(brick).bits, axes, at)
    }
}
