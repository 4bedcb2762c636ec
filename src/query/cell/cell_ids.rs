//! The objects of single cells.

use std::ops::Range;

use casca_slots::Slot;
use glam::IVec3;

use crate::grid::bricks::{Bricks, Pages};
use crate::grid::mask::{Mask, places_of, tile_of, without};
use crate::grid::side::SideAxes;

/// One brick: which cells have objects, and a slot for each pair of a cell and an object, with the
/// place of the cell, in the order of places.
#[derive(Clone, Default)]
struct CellBrick {
    bits: Mask,
    places: Vec<u16>,
    slots: Vec<Slot>,
}

impl CellBrick {
    #[inline]
    fn has(&self, place: usize) -> bool {
        self.bits[place >> 6] >> (place & 63) & 1 != 0
    }

    /// The pairs of a cell.
    #[inline]
    fn range(&self, place: usize) -> Range<usize> {
        let first = self.places.partition_point(|&p| usize::from(p) < place);
        let count = self.places[first..].iter().take_while(|&&p| usize::from(p) == place).count();
        first..first + count
    }

    /// The objects of a cell.
    #[inline]
    fn of(&self, place: usize) -> &[Slot] {
        if self.has(place) { &self.slots[self.range(place)] } else { &[] }
    }

    fn add(&mut self, place: usize, slot: Slot) {
        let at = self.range(place).end;
        self.places.insert(at, place as u16);
        self.slots.insert(at, slot);
        self.bits[place >> 6] |= 1 << (place & 63);
    }

    /// Takes an object out of a cell, if it is there.
    fn remove(&mut self, place: usize, slot: Slot) {
        let range = self.range(place);
        let Some(at) = self.slots[range.clone()].iter().position(|&own| own == slot) else { return };
        self.places.remove(range.start + at);
        self.slots.remove(range.start + at);
        if range.len() == 1 {
            self.bits[place >> 6] &= !(1 << (place & 63));
        }
    }
}

/// The objects that touch single cells, but not all of their brick.
#[derive(Clone, Default)]
pub(super) struct CellIds {
    bricks: Bricks<CellBrick>,
}

impl CellIds {
    /// The pages with cells that have objects.
    pub(super) fn pages(&self) -> &Pages {
        self.bricks.pages()
    }

    /// An object leaves cells of a brick and enters others.
    pub(super) fn change(&mut self, at: IVec3, old: &Mask, new: &Mask, slot: Slot) {
        let brick = self.bricks.get_mut(at);
        places_of(&without(old, new)).for_each(|place| brick.remove(place, slot));
        places_of(&without(new, old)).for_each(|place| brick.add(place, slot));
        if brick.slots.is_empty() {
            self.bricks.release(at);
        }
    }

    /// Number of pairs of a cell and an object.
    #[cfg(test)]
    pub(super) fn entries(&self) -> usize {
        self.bricks.iter().map(|(_, brick)| brick.slots.len()).sum()
    }

    /// The objects of a cell.
    #[inline]
    pub(super) fn of(&self, cell: IVec3) -> &[Slot] {
        let place = (cell.z & 7) << 6 | (cell.y & 7) << 3 | cell.x & 7;
        self.bricks.get(cell >> 3i32).of(place as usize)
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
            let place = match axes.normal {
                0 => row << 6 | col << 3 | at,
                1 => row << 6 | at << 3 | col,
                _ => at << 6 | bit,
            };
            found(bit, brick.of(place as usize));
        }
    }

    /// Which cells of a tile have objects.
    #[inline]
    pub(super) fn tile(&self, brick: IVec3, axes: &SideAxes, at: i32) -> u64 {
        tile_of(&self.bricks.get(brick).bits, axes, at)
    }
}
