//! Volumes that leave the grid: an object that stands on the floor of the grid may go below it.
//!
//! The matrices end with the grid, and so do the walks. Volumes that reach beyond are kept in buckets of
//! the size of a brick, each with a box around its volumes: a query tests the boxes first. Since these volumes are in
//! no cells, they need not be made of whole ones.

use std::collections::BTreeMap;

use crate::geometry::Block;
use crate::grid::cell_box::CellBox;
use crate::heap::in_tree;

/// Volumes whose middles lie in one brick, of the grid or beyond it.
#[derive(Debug, Clone)]
pub(crate) struct Bucket {
    /// Contains all volumes; too large after removals, for a while.
    pub(crate) around: Block,
    pub(crate) slots: Vec<u32>,
    /// Removals since `around` was exact.
    removed: usize,
}

/// The volumes that reach beyond the grid.
#[derive(Debug, Clone, Default)]
pub(super) struct Outer {
    /// Ordered, so that results do not depend on a hash.
    buckets: BTreeMap<[i32; 3], Bucket>,
    /// By slot: its place in its bucket, and its volume.
    placed: Vec<(u32, Block)>,
}

fn key(cells: &CellBox) -> [i32; 3] {
    ((cells.lo + cells.hi) >> 4i32).to_array()
}

fn union(a: Block, b: Block) -> Block {
    Block { min: a.min.min(b.min), max: a.max.max(b.max) }
}

impl Outer {
    /// Adds a volume, and the cells that it touches.
    pub(super) fn insert(&mut self, volume: &Block, cells: &CellBox, slot: u32) {
        let empty = || Bucket { around: *volume, slots: Vec::new(), removed: 0 };
        let bucket = self.buckets.entry(key(cells)).or_insert_with(empty);
        bucket.around = union(bucket.around, *volume);
        if self.placed.len() <= slot as usize {
            self.placed.resize(slot as usize + 1, (0, *volume));
        }
        self.placed[slot as usize] = (bucket.slots.len() as u32, *volume);
        bucket.slots.push(slot);
    }

    /// Takes a volume out.
    pub(super) fn remove(&mut self, cells: &CellBox, slot: u32) {
        let key = key(cells);
        let Some(bucket) = self.buckets.get_mut(&key) else { return };
        let place = self.placed[slot as usize].0;
        bucket.slots.swap_remove(place as usize);
        if let Some(&moved) = bucket.slots.get(place as usize) {
            self.placed[moved as usize].0 = place;
        }
        bucket.removed += 1;
        if bucket.removed > bucket.slots.len() {
            bucket.removed = 0;
            match bucket.slots.iter().map(|&s| self.placed[s as usize].1).reduce(union) {
                Some(exact) => bucket.around = exact,
                None => {
                    self.buckets.remove(&key);
                }
            }
        }
    }

    /// The volume of an object that is here.
    pub(super) fn block(&self, slot: u32) -> Block {
        self.placed[slot as usize].1
    }

    pub(super) fn buckets(&self) -> impl Iterator<Item = &Bucket> {
        self.buckets.values()
    }

    pub(super) fn bytes(&self) -> usize {
        in_tree::<([i32; 3], Bucket)>(self.buckets.len())
            + self.buckets.values().map(|b| b.slots.capacity() * 4).sum::<usize>()
            + self.placed.capacity() * size_of::<(u32, Block)>()
    }
}

#[cfg(test)]
mod tests {
    use glam::IVec3;

    use super::*;

    #[test]
    fn buckets_contain_the_volumes_that_were_inserted_and_no_more() {
        let mut outer = Outer::default();
        let volume = |slot: u32| {
            let lo = IVec3::new(slot as i32 % 7 * 9 - 20, -3, slot as i32 % 5 * 4);
            let cells = CellBox { lo, hi: lo + IVec3::new(slot as i32 % 11, 6, 2) };
            (cells, Block { min: cells.lo.as_dvec3() + 0.25, max: cells.hi.as_dvec3() + 0.5 })
        };
        let volumes: Vec<(CellBox, Block)> = (0..200).map(volume).collect();
        let mut inside: Vec<u32> = (0..200).collect();
        for &s in &inside {
            let (cells, block) = &volumes[s as usize];
            outer.insert(block, cells, s);
        }
        while !inside.is_empty() {
            let gone = inside.swap_remove(inside.len() * 7 / 11);
            outer.remove(&volumes[gone as usize].0, gone);
            let mut found: Vec<u32> = outer.buckets().flat_map(|b| b.slots.clone()).collect();
            found.sort_unstable();
            let mut expected = inside.clone();
            expected.sort_unstable();
            assert_eq!(found, expected);
            for bucket in outer.buckets() {
                assert!(bucket.slots.iter().all(|&s| bucket.around.contains(&volumes[s as usize].1)));
                assert!(bucket.slots.iter().all(|&s| outer.block(s) == volumes[s as usize].1));
            }
        }
        assert_eq!(outer.buckets().count(), 0);
    }
}
