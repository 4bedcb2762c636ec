//! I: which objects touch each cell (a superset).

use std::sync::OnceLock;

use casca_slots::Slot;
use glam::IVec3;

use crate::grid::bricks::{Bricks, Pages};
use crate::grid::side::SideAxes;
use crate::matrix::bits::{ALL, Mask, NONE};
use crate::matrix::cell_ids::CellIds;
use crate::matrix::slots::SlotList;

/// The objects that touch a brick.
#[derive(Clone, Default)]
struct Members {
    /// How many of the first touch every cell of the brick. They are in no list of a cell.
    whole: u32,
    all: SlotList,
}

impl Members {
    fn join(&mut self, slot: Slot, whole: bool) {
        self.all.push(slot);
        if whole {
            self.all.swap(self.all.as_slice().len() - 1, self.whole as usize);
            self.whole += 1;
        }
    }

    fn leave(&mut self, mut at: usize) {
        if at < self.whole as usize {
            self.whole -= 1;
            self.all.swap(at, self.whole as usize);
            at = self.whole as usize;
        }
        self.all.swap_remove(at);
    }
}

/// I: the objects that touch each cell, as indices of the scene's slots.
///
/// The objects of each brick are listed always, those of single cells from the first time that they
/// are asked for: only [`crate::Method::Cell`] asks.
#[derive(Clone)]
pub struct IdMatrix {
    bricks: Bricks<Members>,
    cells: OnceLock<CellIds>,
    dims: IVec3,
}

impl IdMatrix {
    pub(crate) fn new(dims: IVec3) -> Self {
        Self { bricks: Bricks::new(dims), cells: OnceLock::new(), dims }
    }

    /// Moves an object inside a brick: it leaves the cells of `old`, which are all that it is in,
    /// and enters those of `new`, which are inside the grid.
    pub(crate) fn change(&mut self, brick: IVec3, old: &Mask, new: &Mask, slot: Slot) {
        if old == new {
            return;
        }
        let at = brick;
        let brick = self.bricks.get_mut(at);
        // An object that comes is not looked for.
        let found = if *old == NONE { None } else { brick.all.find(slot) };
        let old = if found.is_some() { old } else { &NONE };
        let was_whole = found.is_some_and(|i| i < brick.whole as usize);
        if let Some(cells) = self.cells.get_mut() {
            let old = if was_whole { &NONE } else { old };
            cells.change(at, old, if *new == ALL { &NONE } else { new }, slot);
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
        if brick.all.as_slice().is_empty() {
            self.bricks.release(at);
        }
    }

    /// An object that is listed in no brick leaves some cells of one.
    pub(crate) fn leave_cells(&mut self, brick: IVec3, old: &Mask, slot: Slot) {
        if let Some(cells) = self.cells.get_mut() {
            cells.change(brick, old, &NONE, slot);
        }
    }

    /// The objects by cell. If they were never asked for, `fill` must tell them: the cells of each
    /// object, brick by brick.
    pub(crate) fn by_cell(&self, fill: impl FnOnce(&mut dyn FnMut(IVec3, &Mask, Slot))) -> ByCell<'_> {
        let cells = self.cells.get_or_init(|| {
            let mut cells = CellIds::new(self.dims);
            fill(&mut |brick, mask, slot| {
                // Those that are known to fill a brick are in no list of a cell.
                if *mask != ALL || !self.whole(brick).contains(&slot) {
                    cells.change(brick, &NONE, mask, slot);
                }
            });
            cells
        });
        ByCell { ids: self, cells }
    }

    /// The objects that touch every cell of a brick.
    #[inline]
    fn whole(&self, brick: IVec3) -> &[Slot] {
        let members = self.bricks.get(brick);
        &members.all.as_slice()[..members.whole as usize]
    }

    /// The objects that touch a brick.
    #[inline]
    pub(crate) fn in_brick(&self, brick: IVec3) -> impl ExactSizeIterator<Item = Slot> {
        self.bricks.get(brick).all.as_slice().iter().copied()
    }

    /// The pages that contain objects.
    pub(crate) fn pages(&self) -> &impl Pages {
        &self.bricks
    }

    /// The pages with cells that objects are listed in one by one, once they are. Objects may be
    /// there that are in no brick.
    pub(crate) fn cell_pages(&self) -> Option<&impl Pages> {
        self.cells.get().map(CellIds::pages)
    }

    /// Whether objects are listed by cell, too.
    pub(crate) fn is_by_cell(&self) -> bool {
        self.cells.get().is_some()
    }

    /// Number of pairs of a cell and an object that touches it, once objects are listed by cell.
    pub fn entries(&self) -> usize {
        let whole: usize = self.bricks.iter().map(|(_, members)| 512 * members.whole as usize).sum();
        self.cells.get().map_or(0, |cells| cells.entries() + whole)
    }

    /// Bytes of memory that the matrix uses.
    pub fn bytes(&self) -> usize {
        self.bricks.bytes()
            + self.bricks.iter().map(|(_, b)| b.all.bytes()).sum::<usize>()
            + self.cells.get().map_or(0, CellIds::bytes)
    }
}

/// I, by cell.
#[derive(Clone, Copy)]
pub(crate) struct ByCell<'a> {
    pub(crate) ids: &'a IdMatrix,
    cells: &'a CellIds,
}

impl<'a> ByCell<'a> {
    /// The objects that touch a cell inside the grid.
    #[inline]
    pub(crate) fn get(&self, cell: IVec3) -> impl Iterator<Item = Slot> + use<'a> {
        self.ids.whole(cell >> 3i32).iter().chain(self.cells.of(cell)).copied()
    }

    /// Calls `found` with each cell of a tile whose bit is set, which must have
    /// objects, as its bit, the objects that touch all of its brick, and its others.
    #[inline]
    pub(crate) fn for_tile(
        &self,
        brick: IVec3,
        axes: &SideAxes,
        at: i32,
        tile: u64,
        mut found: impl FnMut(i32, &[Slot], &[Slot]),
    ) {
        let whole = self.ids.whole(brick);
        self.cells.for_tile(brick, axes, at, tile, |bit, own| found(bit, whole, own));
    }

    /// Which cells of a tile have objects.
    #[inline]
    pub(crate) fn tile(&self, brick: IVec3, axes: &SideAxes, at: i32) -> u64 {
        if self.ids.whole(brick).is_empty() { self.cells.tile(brick, axes, at) } else { u64::MAX }
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
    use crate::random::Random;

    /// A matrix that lists objects by cell from the start.
    fn matrix(dims: IVec3) -> IdMatrix {
        let m = IdMatrix::new(dims);
        m.by_cell(|_| ());
        m
    }

    /// Objects by cell, to compare the matrix with.
    fn compare(m: &IdMatrix, map: &BTreeMap<([i32; 3], Slot), Mask>, bricks: &[IVec3]) {
        let mut entries = 0;
        let none = |_: &mut dyn FnMut(IVec3, &Mask, Slot)| unreachable!("it is filled");
        for &b in bricks {
            let mut members: Vec<Slot> = m.in_brick(b).collect();
            members.sort_unstable();
            let here: Vec<(Slot, &Mask)> =
                map.iter().filter(|((at, _), _)| *at == b.to_array()).map(|((_, s), m)| (*s, m)).collect();
            assert_eq!(members, here.iter().map(|h| h.0).collect::<Vec<_>>());
            for i in 0..512usize {
                let c = b * 8 + IVec3::new(i as i32 & 7, i as i32 >> 3 & 7, i as i32 >> 6);
                let mut found: Vec<Slot> = m.by_cell(none).get(c).collect();
                found.sort_unstable();
                let expected: Vec<Slot> =
                    here.iter().filter(|h| h.1[i >> 6] >> (i & 63) & 1 != 0).map(|h| h.0).collect();
                assert_eq!(found, expected, "{c}");
                entries += found.len();
                for axes in &SideAxes::ALL {
                    let bit = (c[axes.row] & 7) << 3 | c[axes.col] & 7;
                    let tile = m.by_cell(none).tile(b, axes, c[axes.normal]);
                    assert_eq!(tile >> bit & 1 != 0, !expected.is_empty());
                    if tile >> bit & 1 != 0 {
                        m.by_cell(none).for_tile(b, axes, c[axes.normal], 1 << bit, |at, whole, own| {
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
        let mut m = matrix(IVec3::new(100, 24, 24));
        let mut map = BTreeMap::<([i32; 3], Slot), Mask>::new();
        let mut random = Random::new(1);
        let mut next = |n: u32| random.below(n);
        for step in 0..1500 {
            let (b, slot) = (bricks[next(3) as usize], Slot::new(next(90)));
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
        // Listed by cell later, they are the same.
        let mut late = IdMatrix::new(IVec3::new(100, 24, 24));
        for ((b, slot), mask) in &map {
            late.change(IVec3::from_array(*b), &NONE, mask, *slot);
        }
        late.by_cell(|add| map.iter().for_each(|((b, slot), mask)| add(IVec3::from_array(*b), mask, *slot)));
        compare(&late, &map, &bricks);
        // Removing an object from cells that it is not in changes nothing.
        m.change(bricks[0], &ALL, &NONE, Slot::new(999));
        compare(&m, &map, &bricks);
        for ((b, slot), old) in &map {
            m.change(IVec3::from_array(*b), old, &NONE, *slot);
        }
        assert_eq!((m.entries(), m.bricks.iter().count()), (0, 0));
    }

    #[test]
    fn objects_that_fill_bricks_cost_them_not_their_cells() {
        let mut m = matrix(IVec3::splat(128));
        let bare = m.bytes();
        for i in 0..4096 {
            m.change(IVec3::new(i & 15, i >> 4 & 15, i >> 8), &NONE, &ALL, Slot::new(7));
        }
        assert_eq!(m.entries(), 128 * 128 * 128);
        assert!(m.bytes() - bare < 4096 * 512, "{} bytes", m.bytes());
        assert_eq!(m.by_cell(|_| ()).get(IVec3::splat(77)).collect::<Vec<_>>(), [Slot::new(7)]);
    }
}
