//! I: which objects touch each cell (a superset).

use glam::IVec3;
use smallvec::SmallVec;

use super::bits::{SideAxes, tile_of};
use crate::bricks::Bricks;

/// The mark of a cell with several objects; the rest of the word is the index of its list.
const SEVERAL: u32 = 1 << 31;

/// One brick: which cells have objects, and one word for each such cell, in
/// the order of the bits.
#[derive(Clone, Default)]
struct IdBrick {
    bits: [u64; 8],
    /// Number of set bits before each word.
    before: [u16; 8],
    /// A slot, or [`SEVERAL`] and the index of a list.
    cells: Vec<u32>,
    /// The objects of the brick and the number of its cells that each touches.
    members: Vec<Member>,
    /// Where the last object asked for was found.
    last: u32,
}

#[derive(Clone, Copy)]
struct Member {
    slot: u32,
    cells: u32,
}

impl IdBrick {
    #[inline]
    fn place(&self, cell: IVec3) -> (usize, u32, usize) {
        let (word, bit) = ((cell.z & 7) as usize, (((cell.y & 7) << 3) | (cell.x & 7)) as u32);
        let below = self.bits[word] & ((1u64 << bit) - 1);
        (word, bit, usize::from(self.before[word]) + below.count_ones() as usize)
    }

    /// Where an object stands among the members. Its cells come one after the other, so
    /// it mostly stands where it stood before.
    fn member(&mut self, slot: u32) -> Option<usize> {
        let last = self.last as usize;
        if self.members.get(last).is_some_and(|m| m.slot == slot) {
            return Some(last);
        }
        let found = self.members.iter().position(|m| m.slot == slot)?;
        self.last = found as u32;
        Some(found)
    }

    fn join(&mut self, slot: u32) {
        match self.member(slot) {
            Some(i) => self.members[i].cells += 1,
            None => {
                self.last = self.members.len() as u32;
                self.members.push(Member { slot, cells: 1 });
            }
        }
    }

    fn leave(&mut self, slot: u32) {
        let Some(i) = self.member(slot) else { return };
        self.members[i].cells -= 1;
        if self.members[i].cells == 0 {
            self.members.swap_remove(i);
        }
    }
}

/// I: the objects that touch each cell, as indices of the scene's slots.
///
/// Cells with one object cost four bytes, and one bit tells an empty cell.
#[derive(Clone)]
pub struct IdMatrix {
    bricks: Bricks<IdBrick>,
    lists: Vec<SmallVec<[u32; 6]>>,
    free_lists: Vec<u32>,
    entries: usize,
}

impl IdMatrix {
    pub(crate) fn new(dims: IVec3) -> Self {
        Self { bricks: Bricks::new(dims), lists: Vec::new(), free_lists: Vec::new(), entries: 0 }
    }

    /// Adds an object to a cell inside the grid. It must not be there already.
    pub(crate) fn insert(&mut self, cell: IVec3, slot: u32) {
        self.entries += 1;
        let brick = self.bricks.get_mut(cell >> 3i32);
        brick.join(slot);
        let (word, bit, place) = brick.place(cell);
        if brick.bits[word] >> bit & 1 == 0 {
            brick.bits[word] |= 1 << bit;
            brick.before[word + 1..].iter_mut().for_each(|n| *n += 1);
            brick.cells.insert(place, slot);
            return;
        }
        let held = &mut brick.cells[place];
        if *held & SEVERAL != 0 {
            self.lists[(*held & !SEVERAL) as usize].push(slot);
        } else {
            let list = SmallVec::from_slice(&[*held, slot]);
            let index = match self.free_lists.pop() {
                Some(i) => {
                    self.lists[i as usize] = list;
                    i
                }
                None => {
                    self.lists.push(list);
                    self.lists.len() as u32 - 1
                }
            };
            *held = SEVERAL | index;
        }
    }

    /// Takes an object out of a cell inside the grid; nothing happens if it is not there.
    pub(crate) fn remove(&mut self, cell: IVec3, slot: u32) {
        let Some(brick) = self.bricks.get_existing_mut(cell >> 3i32) else { return };
        let (word, bit, place) = brick.place(cell);
        if brick.bits[word] >> bit & 1 == 0 {
            return;
        }
        let held = &mut brick.cells[place];
        if *held & SEVERAL != 0 {
            let index = *held & !SEVERAL;
            let list = &mut self.lists[index as usize];
            let Some(i) = list.iter().position(|&s| s == slot) else { return };
            list.remove(i);
            if list.len() == 1 {
                *held = list[0];
                *list = SmallVec::new();
                self.free_lists.push(index);
            }
            brick.leave(slot);
        } else if *held == slot {
            brick.bits[word] &= !(1 << bit);
            brick.before[word + 1..].iter_mut().for_each(|n| *n -= 1);
            brick.cells.remove(place);
            brick.leave(slot);
            if brick.cells.is_empty() {
                self.bricks.release(cell >> 3i32);
            }
        } else {
            return;
        }
        self.entries -= 1;
    }

    /// The objects that touch a cell inside the grid.
    #[inline]
    pub(crate) fn get(&self, cell: IVec3) -> &[u32] {
        let brick = self.bricks.get(cell >> 3i32);
        let (word, bit, place) = brick.place(cell);
        if brick.bits[word] >> bit & 1 == 0 {
            return &[];
        }
        let held = &brick.cells[place];
        if *held & SEVERAL != 0 {
            &self.lists[(*held & !SEVERAL) as usize]
        } else {
            std::slice::from_ref(held)
        }
    }

    /// Calls `found` with each cell of a tile whose bit is set, which must have
    /// objects, as its bit and its objects.
    #[inline]
    pub(crate) fn for_tile(
        &self,
        brick: IVec3,
        axes: &SideAxes,
        at: i32,
        mut tile: u64,
        mut found: impl FnMut(i32, &[u32]),
    ) {
        let brick = self.bricks.get(brick);
        let at = at & 7;
        while tile != 0 {
            let bit = tile.trailing_zeros() as i32;
            tile &= tile - 1;
            let (row, col) = (bit >> 3, bit & 7);
            let (word, bit_in_word) = match axes.normal {
                0 => (row, col << 3 | at),
                1 => (row, at << 3 | col),
                _ => (at, bit),
            };
            let below = brick.bits[(word & 7) as usize] & !(u64::MAX << bit_in_word);
            let place = usize::from(brick.before[(word & 7) as usize]) + below.count_ones() as usize;
            let Some(held) = brick.cells.get(place) else { continue };
            let objects = match held & SEVERAL {
                0 => std::slice::from_ref(held),
                _ => &self.lists[(held & !SEVERAL) as usize][..],
            };
            found(bit, objects);
        }
    }

    /// The objects that touch a brick.
    #[inline]
    pub(crate) fn in_brick(&self, brick: IVec3) -> impl ExactSizeIterator<Item = u32> {
        self.bricks.get(brick).members.iter().map(|m| m.slot)
    }

    /// Which cells of a tile have objects.
    #[inline]
    pub(crate) fn tile(&self, brick: IVec3, axes: &SideAxes, at: i32) -> u64 {
        tile_of(&self.bricks.get(brick).bits, axes, at)
    }

    /// Number of pairs of a cell and an object that touches it.
    pub fn entries(&self) -> usize {
        self.entries
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.bricks.bytes()
            + self
                .bricks
                .iter()
                .map(|(_, b)| b.cells.capacity() * 4 + b.members.capacity() * size_of::<Member>())
                .sum::<usize>()
            + self.lists.capacity() * size_of::<SmallVec<[u32; 6]>>()
            + self.lists.iter().filter(|l| l.spilled()).map(|l| l.capacity() * 4).sum::<usize>()
            + self.free_lists.capacity() * 4
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn agrees_with_a_map() {
        let mut m = IdMatrix::new(IVec3::splat(24));
        let mut map = BTreeMap::<[i32; 3], Vec<u32>>::new();
        let mut state = 1u32;
        let mut next = |n: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % n
        };
        for _ in 0..20_000 {
            let c = IVec3::new(next(24) as i32, next(3) as i32 + 7, next(3) as i32 + 14);
            let slot = next(12);
            let list = map.entry(c.to_array()).or_default();
            match list.iter().position(|&s| s == slot) {
                Some(i) => {
                    list.remove(i);
                    m.remove(c, slot);
                }
                None => {
                    list.push(slot);
                    m.insert(c, slot);
                }
            }
            assert_eq!(m.get(c), &list[..]);
            m.remove(c, 99);
        }
        let mut bricks = BTreeMap::<[i32; 3], Vec<u32>>::new();
        for (c, list) in &map {
            bricks.entry((IVec3::from_array(*c) >> 3i32).to_array()).or_default().extend(list);
        }
        for (b, mut slots) in bricks {
            slots.sort_unstable();
            slots.dedup();
            let mut found: Vec<u32> = m.in_brick(IVec3::from_array(b)).collect();
            found.sort_unstable();
            assert_eq!(found, slots);
        }
        assert_eq!(m.entries(), map.values().map(Vec::len).sum::<usize>());
        for (c, list) in &map {
            m.remove(IVec3::from_array(*c), 99);
            list.iter().for_each(|&s| m.remove(IVec3::from_array(*c), s));
        }
        assert_eq!((m.entries(), m.bricks.iter().count()), (0, 0));
    }
}
