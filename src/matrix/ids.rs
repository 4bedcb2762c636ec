//! I: which objects touch each cell (a superset).

use glam::IVec3;

use crate::grid::bricks::{Bricks, Pages};
use crate::grid::side::SideAxes;
use crate::matrix::bits::{ALL, Mask, NONE, count, places_of, tile_of, without};
use crate::matrix::slots::SlotList;

/// The mark of a cell with several objects; the rest of the word is the index of its list.
const SEVERAL: u32 = 1 << 31;

/// One brick: which cells have objects, and one word for each such cell, in
/// the order of the bits. Objects that touch every cell are listed once instead.
#[derive(Clone, Default)]
struct IdBrick {
    bits: Mask,
    /// Number of set bits before each word.
    before: [u16; 8],
    /// How many of the first members touch every cell of the brick. They are in none of its cells.
    whole: u32,
    /// A slot, or [`SEVERAL`] and the index of a list.
    cells: Vec<u32>,
    /// The objects of the brick.
    members: SlotList,
}

impl IdBrick {
    #[inline]
    fn place(&self, word: usize, bit: u32) -> usize {
        let below = self.bits[word] & ((1u64 << bit) - 1);
        usize::from(self.before[word]) + below.count_ones() as usize
    }

    #[inline]
    fn whole(&self) -> &[u32] {
        &self.members.as_slice()[..self.whole as usize]
    }

    fn join(&mut self, slot: u32, whole: bool) {
        self.members.push(slot);
        if whole {
            self.members.swap(self.members.as_slice().len() - 1, self.whole as usize);
            self.whole += 1;
        }
    }

    fn leave(&mut self, mut at: usize) {
        if at < self.whole as usize {
            self.whole -= 1;
            self.members.swap(at, self.whole as usize);
            at = self.whole as usize;
        }
        self.members.swap_remove(at);
    }
}

/// The lists of cells with several objects.
#[derive(Clone, Default)]
struct Lists {
    lists: Vec<SlotList>,
    free: Vec<u32>,
}

impl Lists {
    fn make(&mut self, a: u32, b: u32) -> u32 {
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

    /// The objects that the word of a cell stands for.
    #[inline]
    fn of<'a>(&'a self, held: &'a u32) -> &'a [u32] {
        match held & SEVERAL {
            0 => std::slice::from_ref(held),
            _ => self.lists[(held & !SEVERAL) as usize].as_slice(),
        }
    }

    fn add(&mut self, brick: &mut IdBrick, i: usize, slot: u32) {
        let (word, bit) = (i >> 6, (i & 63) as u32);
        let place = brick.place(word, bit);
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
            *held = SEVERAL | self.make(*held, slot);
        }
    }

    /// Takes an object out of a cell; false if it is not there.
    fn remove(&mut self, brick: &mut IdBrick, i: usize, slot: u32) -> bool {
        let (word, bit) = (i >> 6, (i & 63) as u32);
        if brick.bits[word] >> bit & 1 == 0 {
            return false;
        }
        let place = brick.place(word, bit);
        let held = &mut brick.cells[place];
        if *held & SEVERAL != 0 {
            let index = *held & !SEVERAL;
            let list = &mut self.lists[index as usize];
            let Some(at) = list.find(slot) else { return false };
            list.remove(at);
            if let &[last] = list.as_slice() {
                *held = last;
                *list = SlotList::default();
                self.free.push(index);
            }
        } else if *held == slot {
            brick.bits[word] &= !(1 << bit);
            brick.before[word + 1..].iter_mut().for_each(|n| *n -= 1);
            brick.cells.remove(place);
        } else {
            return false;
        }
        true
    }
}

/// I: the objects that touch each cell, as indices of the scene's slots.
///
/// Cells with one object cost four bytes, and one bit tells an empty cell. An object that touches all
/// cells of a brick costs four bytes there.
#[derive(Clone)]
pub struct IdMatrix {
    bricks: Bricks<IdBrick>,
    lists: Lists,
    entries: usize,
}

impl IdMatrix {
    pub(crate) fn new(dims: IVec3) -> Self {
        Self { bricks: Bricks::new(dims), lists: Lists::default(), entries: 0 }
    }

    /// Moves an object inside a brick: it leaves the cells of `old`, all of which it is in, and enters those
    /// of `new`, which are inside the grid.
    pub(crate) fn change(&mut self, brick: IVec3, old: &Mask, new: &Mask, slot: u32) {
        if old == new {
            return;
        }
        let at = brick;
        let brick = self.bricks.get_mut(at);
        let found = brick.members.find(slot);
        let old = if found.is_some() { old } else { &NONE };
        let was_whole = found.is_some_and(|i| i < brick.whole as usize);
        let (old_cells, new_cells) =
            (if was_whole { &NONE } else { old }, if *new == ALL { &NONE } else { new });
        let mut left = if was_whole { 512 } else { 0 };
        for i in places_of(&without(old_cells, new_cells)) {
            left += usize::from(self.lists.remove(brick, i, slot));
        }
        for i in places_of(&without(new_cells, old_cells)) {
            self.lists.add(brick, i, slot);
        }
        let stays = *new != NONE && was_whole == (*new == ALL);
        match found {
            Some(i) if !stays => {
                brick.leave(i);
                if *new != NONE {
                    brick.join(slot, *new == ALL);
                }
            }
            None if *new != NONE => brick.join(slot, *new == ALL),
            _ => {}
        }
        if *new == ALL {
            self.entries += 512;
        }
        self.entries += count(&without(new_cells, old_cells)) as usize;
        self.entries -= left;
        if brick.members.as_slice().is_empty() {
            self.bricks.release(at);
        }
    }

    /// The objects that touch a cell inside the grid: those that touch all of its brick, and others.
    #[inline]
    pub(crate) fn lists(&self, cell: IVec3) -> (&[u32], &[u32]) {
        let brick = self.bricks.get(cell >> 3i32);
        let (word, bit) = ((cell.z & 7) as usize, (((cell.y & 7) << 3) | (cell.x & 7)) as u32);
        if brick.bits[word] >> bit & 1 == 0 {
            return (brick.whole(), &[]);
        }
        (brick.whole(), self.lists.of(&brick.cells[brick.place(word, bit)]))
    }

    /// The objects that touch a cell inside the grid.
    #[inline]
    pub(crate) fn get(&self, cell: IVec3) -> impl Iterator<Item = u32> {
        let (whole, own) = self.lists(cell);
        whole.iter().chain(own).copied()
    }

    /// Calls `found` with each cell of a tile whose bit is set, which must have
    /// objects, as its bit, the objects that touch all of its brick, and its others.
    #[inline]
    pub(crate) fn for_tile(
        &self,
        brick: IVec3,
        axes: &SideAxes,
        at: i32,
        mut tile: u64,
        mut found: impl FnMut(i32, &[u32], &[u32]),
    ) {
        let brick = self.bricks.get(brick);
        let (whole, at) = (brick.whole(), at & 7);
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
                found(bit, whole, &[]);
            } else if let Some(held) = brick.cells.get(brick.place(word, bit_in_word as u32)) {
                found(bit, whole, self.lists.of(held));
            }
        }
    }

    /// The objects that touch a brick.
    #[inline]
    pub(crate) fn in_brick(&self, brick: IVec3) -> impl ExactSizeIterator<Item = u32> {
        self.bricks.get(brick).members.as_slice().iter().copied()
    }

    /// Which cells of a tile have objects.
    #[inline]
    pub(crate) fn tile(&self, brick: IVec3, axes: &SideAxes, at: i32) -> u64 {
        let brick = self.bricks.get(brick);
        if brick.whole > 0 { u64::MAX } else { tile_of(&brick.bits, axes, at) }
    }

    /// The pages that contain objects.
    pub(crate) fn pages(&self) -> &impl Pages {
        &self.bricks
    }

    /// Number of pairs of a cell and an object that touches it.
    pub fn entries(&self) -> usize {
        self.entries
    }

    /// Bytes of memory that the matrix uses.
    pub fn bytes(&self) -> usize {
        self.bricks.bytes()
            + self.bricks.iter().map(|(_, b)| b.cells.capacity() * 4 + b.members.bytes()).sum::<usize>()
            + self.lists.lists.capacity() * size_of::<SlotList>()
            + self.lists.lists.iter().map(SlotList::bytes).sum::<usize>()
            + self.lists.free.capacity() * 4
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

    /// Objects by cell, to compare the matrix with.
    fn compare(m: &IdMatrix, map: &BTreeMap<([i32; 3], u32), Mask>, bricks: &[IVec3]) {
        let mut entries = 0;
        for &b in bricks {
            let mut members: Vec<u32> = m.in_brick(b).collect();
            members.sort_unstable();
            let here: Vec<(u32, &Mask)> =
                map.iter().filter(|((at, _), _)| *at == b.to_array()).map(|((_, s), m)| (*s, m)).collect();
            assert_eq!(members, here.iter().map(|h| h.0).collect::<Vec<_>>());
            for i in 0..512usize {
                let c = b * 8 + IVec3::new(i as i32 & 7, i as i32 >> 3 & 7, i as i32 >> 6);
                let mut found: Vec<u32> = m.get(c).collect();
                found.sort_unstable();
                let expected: Vec<u32> =
                    here.iter().filter(|h| h.1[i >> 6] >> (i & 63) & 1 != 0).map(|h| h.0).collect();
                assert_eq!(found, expected, "{c}");
                entries += found.len();
                for axes in &SideAxes::ALL {
                    let bit = (c[axes.row] & 7) << 3 | c[axes.col] & 7;
                    let tile = m.tile(b, axes, c[axes.normal]);
                    assert_eq!(tile >> bit & 1 != 0, !expected.is_empty());
                    if tile >> bit & 1 != 0 {
                        m.for_tile(b, axes, c[axes.normal], 1 << bit, |at, whole, own| {
                            let mut tiled = [whole, own].concat();
                            tiled.sort_unstable();
                            assert_eq!((at, &tiled), (bit, &expected));
                        });
                    }
                }
            }
        }
        assert_eq!(m.entries(), entries);
    }

    #[test]
    fn agrees_with_a_map() {
        let bricks = [IVec3::new(1, 1, 1), IVec3::new(2, 0, 1), IVec3::new(9, 1, 2)];
        let mut m = IdMatrix::new(IVec3::new(100, 24, 24));
        let mut map = BTreeMap::<([i32; 3], u32), Mask>::new();
        let mut state = 1u32;
        let mut next = |n: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % n
        };
        for step in 0..1500 {
            let (b, slot) = (bricks[next(3) as usize], next(90));
            let new: Mask = match next(6) {
                0 => ALL,
                1 | 2 => NONE,
                3 => std::array::from_fn(|_| if next(3) == 0 { 0xff << (8 * next(8)) } else { 0 }),
                4 => std::array::from_fn(|z| if z == 4 { 1 << next(64) } else { 0 }),
                _ => std::array::from_fn(|z| if z == 3 { u64::MAX } else { 0 }),
            };
            let old = map.insert((b.to_array(), slot), new).unwrap_or(NONE);
            if new == NONE {
                map.remove(&(b.to_array(), slot));
            }
            m.change(b, &old, &new, slot);
            if step % 50 == 0 {
                compare(&m, &map, &bricks);
            }
        }
        compare(&m, &map, &bricks);
        // Removing an object from cells that it is not in changes nothing.
        m.change(bricks[0], &ALL, &NONE, 999);
        compare(&m, &map, &bricks);
        for ((b, slot), old) in &map {
            m.change(IVec3::from_array(*b), old, &NONE, *slot);
        }
        assert_eq!((m.entries(), m.bricks.iter().count()), (0, 0));
    }

    #[test]
    fn objects_that_fill_bricks_cost_them_not_their_cells() {
        let mut m = IdMatrix::new(IVec3::splat(128));
        let bare = m.bytes();
        for i in 0..4096 {
            m.change(IVec3::new(i & 15, i >> 4 & 15, i >> 8), &NONE, &ALL, 7);
        }
        assert_eq!(m.entries(), 128 * 128 * 128);
        assert!(m.bytes() - bare < 4096 * 512, "{} bytes", m.bytes());
        assert_eq!(m.get(IVec3::splat(77)).collect::<Vec<_>>(), [7]);
    }
}
