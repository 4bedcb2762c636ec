//! Boxes that leave the grid: an object that stands on the floor of the grid may go below it.
//!
//! The matrices end with the grid, and so do the walks. Volumes that reach beyond, and listed
//! objects that do, are kept in buckets of the size of a brick, and these in pages of 8x8x8 of
//! them. Buckets and pages have boxes around their contents: a query tests those first. Since these
//! volumes are in no cells, they need not be made of whole ones.

use std::collections::BTreeMap;

use casca_slots::Slot;
use glam::IVec3;

use crate::geometry::Block;
use crate::grid::cell_box::CellBox;
use crate::heap::in_tree;

/// Boxes whose middles lie in one brick, of the grid or beyond it.
#[derive(Debug, Clone)]
pub(crate) struct Bucket {
    /// Contains all boxes; too large after removals, for a while.
    around: Block,
    slots: Vec<Slot>,
    /// Removals since `around` was exact.
    removed: usize,
}

/// The buckets of one page of bricks.
#[derive(Debug, Clone)]
pub(crate) struct OuterPage {
    /// Contains all boxes; too large after removals, for a while.
    around: Block,
    /// By brick. Ordered, so that results do not depend on a hash.
    buckets: BTreeMap<[i32; 3], Bucket>,
    /// Removals since `around` was exact.
    removed: usize,
}

impl Bucket {
    /// The objects whose boxes these are.
    pub(crate) fn slots(&self) -> &[Slot] {
        &self.slots
    }
}

impl OuterPage {
    /// A box that contains all boxes.
    pub(crate) fn around(&self) -> &Block {
        &self.around
    }

    pub(crate) fn buckets(&self) -> impl Iterator<Item = &Bucket> {
        self.buckets.values()
    }
}

/// The boxes that reach beyond the grid.
#[derive(Debug, Clone, Default)]
pub(crate) struct Outer {
    pages: BTreeMap<[i32; 3], OuterPage>,
    /// By slot: its place in its bucket, and its box.
    placed: Vec<(u32, Block)>,
}

/// The brick in the middle of a box of cells.
fn brick_of(cells: &CellBox) -> IVec3 {
    (cells.lo + cells.hi) >> 4i32
}

fn union(a: Block, b: Block) -> Block {
    Block { min: a.min.min(b.min), max: a.max.max(b.max) }
}

impl Outer {
    /// Adds a box, and the cells that it touches.
    pub(super) fn insert(&mut self, block: &Block, cells: &CellBox, slot: Slot) {
        let brick = brick_of(cells);
        let page = || OuterPage { around: *block, buckets: BTreeMap::new(), removed: 0 };
        let page = self.pages.entry((brick >> 3i32).to_array()).or_insert_with(page);
        page.around = union(page.around, *block);
        let bucket = || Bucket { around: *block, slots: Vec::new(), removed: 0 };
        let bucket = page.buckets.entry(brick.to_array()).or_insert_with(bucket);
        bucket.around = union(bucket.around, *block);
        if self.placed.len() <= slot.index() {
            self.placed.resize(slot.index() + 1, (0, *block));
        }
        self.placed[slot.index()] = (bucket.slots.len() as u32, *block);
        bucket.slots.push(slot);
    }

    /// Takes a box out.
    pub(super) fn remove(&mut self, cells: &CellBox, slot: Slot) {
        let brick = brick_of(cells);
        let at = (brick >> 3i32).to_array();
        let Some(page) = self.pages.get_mut(&at) else { return };
        let Some(bucket) = page.buckets.get_mut(&brick.to_array()) else { return };
        let place = self.placed[slot.index()].0;
        bucket.slots.swap_remove(place as usize);
        if let Some(&moved) = bucket.slots.get(place as usize) {
            self.placed[moved.index()].0 = place;
        }
        bucket.removed += 1;
        if bucket.removed > bucket.slots.len() {
            bucket.removed = 0;
            match bucket.slots.iter().map(|&s| self.placed[s.index()].1).reduce(union) {
                Some(exact) => bucket.around = exact,
                None => {
                    page.buckets.remove(&brick.to_array());
                }
            }
        }
        page.removed += 1;
        if page.removed > page.buckets.len() {
            page.removed = 0;
            match page.buckets().map(|bucket| bucket.around).reduce(union) {
                Some(around) => page.around = around,
                None => {
                    self.pages.remove(&at);
                }
            }
        }
    }

    /// The box of an object that is here.
    pub(super) fn block(&self, slot: Slot) -> Block {
        self.placed[slot.index()].1
    }

    pub(crate) fn pages(&self) -> impl Iterator<Item = &OuterPage> {
        self.pages.values()
    }

    pub(crate) fn buckets(&self) -> impl Iterator<Item = &Bucket> {
        self.pages().flat_map(OuterPage::buckets)
    }

    /// The objects in the buckets that pass a test of their boxes, as do the pages of those.
    pub(crate) fn slots_where(&self, mut asked: impl FnMut(&Block) -> bool, mut found: impl FnMut(Slot)) {
        for page in self.pages() {
            if !asked(&page.around) {
                continue;
            }
            for bucket in page.buckets() {
                if asked(&bucket.around) {
                    bucket.slots.iter().for_each(|&slot| found(slot));
                }
            }
        }
    }

    pub(super) fn bytes(&self) -> usize {
        let page = |page: &OuterPage| {
            in_tree::<([i32; 3], Bucket)>(page.buckets.len())
                + page.buckets().map(|b| b.slots.capacity() * size_of::<Slot>()).sum::<usize>()
        };
        in_tree::<([i32; 3], OuterPage)>(self.pages.len())
            + self.pages().map(page).sum::<usize>()
            + self.placed.capacity() * size_of::<(u32, Block)>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buckets_contain_the_volumes_that_were_inserted_and_no_more() {
        let mut outer = Outer::default();
        let volume = |slot: Slot| {
            let i = slot.get() as i32;
            let lo = IVec3::new(i % 7 * 9 - 20, -3, i % 5 * 4);
            let cells = CellBox { lo, hi: lo + IVec3::new(i % 11, 6, 2) };
            (cells, Block { min: cells.lo.as_dvec3() + 0.25, max: cells.hi.as_dvec3() + 0.5 })
        };
        let volumes: Vec<(CellBox, Block)> = Slot::below(200).map(volume).collect();
        let mut inside: Vec<Slot> = Slot::below(200).collect();
        for &s in &inside {
            let (cells, block) = &volumes[s.index()];
            outer.insert(block, cells, s);
        }
        while !inside.is_empty() {
            let gone = inside.swap_remove(inside.len() * 7 / 11);
            outer.remove(&volumes[gone.index()].0, gone);
            let mut found: Vec<Slot> = outer.buckets().flat_map(|b| b.slots.clone()).collect();
            found.sort_unstable();
            let mut expected = inside.clone();
            expected.sort_unstable();
            assert_eq!(found, expected);
            for page in outer.pages() {
                assert!(page.buckets().all(|bucket| page.around.contains(&bucket.around)));
            }
            for bucket in outer.buckets() {
                assert!(bucket.slots.iter().all(|&s| bucket.around.contains(&volumes[s.index()].1)));
                assert!(bucket.slots.iter().all(|&s| outer.block(s) == volumes[s.index()].1));
            }
        }
        assert_eq!((outer.buckets().count(), outer.pages().count()), (0, 0));
    }
}
