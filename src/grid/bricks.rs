//! Sparse storage shared by all matrices: bricks of 8x8x8 cells in pages of 8x8x8 bricks, which are
//! found by a hash of their coordinates. Memory follows occupied cells, wherever they are. Full
//! bricks and full pages can be shared, so that the inside of a solid costs no more than its pages.
//!
//! This is the "recursive grid" of the thesis' future work (section 5).

use std::hash::{Hash, Hasher};

use glam::IVec3;
use hashbrown::HashMap;

use crate::grid::cell_box::CellBox;
use crate::grid::extent::Extent;
use crate::grid::mask::{ALL, Mask, NONE, cells_of};

/// The brick that all full bricks share, and the page that all full pages share.
const FULL: u32 = 1;

/// A page: where its bricks are in the store, and which are there.
#[derive(Clone)]
struct Page {
    bricks: Box<[u32; 512]>,
    /// As the cells of a brick: word z, bit 8y+x.
    there: Mask,
}

impl Page {
    fn of(brick: u32) -> Self {
        Self { bricks: Box::new([brick; 512]), there: if brick == 0 { NONE } else { ALL } }
    }
}

/// The coordinates of a page, as a key of a table.
#[derive(Clone, Copy, PartialEq, Eq)]
struct PageKey(IVec3);

impl Hash for PageKey {
    #[inline]
    fn hash<H: Hasher>(&self, state: &mut H) {
        let IVec3 { x, y, z } = self.0;
        state.write_u64(u64::from(x as u32) | u64::from(y as u32) << 32);
        state.write_u64(u64::from(z as u32));
    }
}

/// Where a page is.
#[derive(Clone, Copy)]
struct PagePlace {
    /// Its index in the list of pages that are there.
    listed: u32,
    /// The page with its bricks, which may be shared.
    page: u32,
}

/// Which pages and bricks there are: for walks that look for them.
#[derive(Clone)]
pub(crate) struct Pages {
    table: HashMap<PageKey, PagePlace>,
    /// Those with bricks, with their coordinates. Their order follows from what came and went.
    listed: Vec<(IVec3, u32)>,
    pages: Vec<Page>,
    free: Vec<u32>,
    /// The first pages, which are never written: the empty one, and the full one where there is
    /// such.
    shared: u32,
    extent: Extent,
}

impl Pages {
    fn new(shared: Vec<Page>) -> Self {
        let count = shared.len() as u32;
        let (table, listed, free) = Default::default();
        Self { table, listed, pages: shared, free, shared: count, extent: Extent::default() }
    }

    /// The page at page coordinates: 0 if it has no bricks.
    #[inline]
    fn at(&self, page: IVec3) -> u32 {
        self.table.get(&PageKey(page)).map_or(0, |place| place.page)
    }

    #[inline]
    fn place(&self, brick: IVec3) -> u32 {
        self.pages[self.at(brick >> 3i32) as usize].bricks[place_in_page(brick)]
    }

    /// Whether a page has no bricks.
    #[inline]
    pub(crate) fn is_empty(&self, page: IVec3) -> bool {
        self.at(page) == 0
    }

    /// The bricks of a page, as the cells of a brick are told: word z, bit 8y+x.
    #[inline]
    pub(crate) fn bricks(&self, page: IVec3) -> &Mask {
        &self.pages[self.at(page) as usize].there
    }

    /// The pages with bricks. Their order follows from what came and went.
    pub(crate) fn iter(&self) -> impl Iterator<Item = IVec3> {
        self.listed.iter().map(|(at, _)| *at)
    }

    /// The least block around all bricks, in bricks.
    pub(crate) fn extent(&self) -> Option<CellBox> {
        self.extent.around()
    }

    /// Writes a page into the table.
    fn set(&mut self, at: IVec3, page: u32) {
        match (self.table.get_mut(&PageKey(at)), page) {
            (Some(place), 0) => {
                let gone = place.listed;
                self.table.remove(&PageKey(at));
                self.listed.swap_remove(gone as usize);
                if let Some((moved, _)) = self.listed.get(gone as usize)
                    && let Some(place) = self.table.get_mut(&PageKey(*moved))
                {
                    place.listed = gone;
                }
            }
            (Some(place), page) => {
                place.page = page;
                self.listed[place.listed as usize].1 = page;
            }
            (None, 0) => {}
            (None, page) => {
                let listed = self.listed.len() as u32;
                self.table.insert(PageKey(at), PagePlace { listed, page });
                self.listed.push((at, page));
            }
        }
    }

    /// The page of a brick, which is created if it is absent and copied if it is shared.
    fn own(&mut self, at: IVec3) -> u32 {
        let id = self.at(at);
        if id >= self.shared {
            return id;
        }
        let page = self.pages[id as usize].clone();
        let id = match self.free.pop() {
            Some(i) => {
                self.pages[i as usize] = page;
                i
            }
            None => {
                self.pages.push(page);
                self.pages.len() as u32 - 1
            }
        };
        self.set(at, id);
        id
    }

    /// Writes where a brick of a page of its own is in the store; 0 takes it away. Gives where it
    /// was, and whether the page is empty now.
    fn put(&mut self, id: u32, brick: IVec3, place: u32) -> (u32, bool) {
        let page = &mut self.pages[id as usize];
        let old = std::mem::replace(&mut page.bricks[place_in_page(brick)], place);
        let (slice, bit) = ((brick.z & 7) as usize, 1 << ((brick.y & 7) << 3 | brick.x & 7));
        page.there[slice] = if place == 0 { page.there[slice] & !bit } else { page.there[slice] | bit };
        let empty = page.there == NONE;
        if (old == 0) != (place == 0) {
            self.extent.change(brick, old == 0);
        }
        (old, empty)
    }

    fn clear(&mut self) {
        self.table.clear();
        self.listed.clear();
        self.pages.truncate(self.shared as usize);
        self.free.clear();
        self.extent = Extent::default();
    }

    fn bytes(&self) -> usize {
        self.table.allocation_size()
            + self.extent.bytes()
            + self.listed.capacity() * size_of::<(IVec3, u32)>()
            + self.pages.capacity() * size_of::<Page>()
            + self.pages.len() * size_of::<[u32; 512]>()
            + self.free.capacity() * 4
    }
}

#[inline]
fn place_in_page(brick: IVec3) -> usize {
    (((brick.z & 7) << 6) | ((brick.y & 7) << 3) | (brick.x & 7)) as usize
}

/// A sparse 3D array of bricks. Absent bricks read as the default brick.
#[derive(Clone)]
pub(crate) struct Bricks<T> {
    pages: Pages,
    /// Brick 0 is the default one.
    store: Vec<T>,
    free: Vec<u32>,
}

impl<T: Default + Clone> Default for Bricks<T> {
    /// No bricks.
    fn default() -> Self {
        Self { pages: Pages::new(vec![Page::of(0)]), store: vec![T::default()], free: Vec::new() }
    }
}

impl<T: Default + Clone> Bricks<T> {
    /// No bricks; those that are made full share one.
    pub(crate) fn with_full(full: T) -> Self {
        let pages = Pages::new(vec![Page::of(0), Page::of(FULL)]);
        Self { pages, store: vec![T::default(), full], free: Vec::new() }
    }

    /// Which pages and bricks there are.
    #[inline]
    pub(crate) fn pages(&self) -> &Pages {
        &self.pages
    }

    /// The brick at brick coordinates.
    #[inline]
    pub(crate) fn get(&self, brick: IVec3) -> &T {
        &self.store[self.pages.place(brick) as usize]
    }

    /// Whether a page was made full as a whole.
    pub(crate) fn page_is_full(&self, page: IVec3) -> bool {
        self.pages.shared > FULL && self.pages.at(page) == FULL
    }

    /// The brick at brick coordinates, made if absent.
    #[inline]
    pub(crate) fn get_mut(&mut self, brick: IVec3) -> &mut T {
        let place = self.pages.place(brick);
        let place = if place < self.pages.shared { self.own_brick(brick) } else { place };
        &mut self.store[place as usize]
    }

    /// Gives a brick that has none a place of its own.
    #[cold]
    fn own_brick(&mut self, brick: IVec3) -> u32 {
        let shared = self.pages.place(brick);
        let own = self.store[shared as usize].clone();
        let place = match self.free.pop() {
            Some(i) => {
                self.store[i as usize] = own;
                i
            }
            None => {
                self.store.push(own);
                self.store.len() as u32 - 1
            }
        };
        let id = self.pages.own(brick >> 3i32);
        self.pages.put(id, brick, place);
        place
    }

    /// The brick, if it is there.
    #[inline]
    pub(crate) fn get_existing_mut(&mut self, brick: IVec3) -> Option<&mut T> {
        if self.pages.place(brick) == 0 { None } else { Some(self.get_mut(brick)) }
    }

    /// Gives the brick back. Its storage is reused by the next one made.
    pub(crate) fn release(&mut self, brick: IVec3) {
        if self.pages.place(brick) != 0 {
            self.put(brick, 0);
        }
    }

    /// Makes a brick the full one, of [`Bricks::with_full`].
    pub(crate) fn fill(&mut self, brick: IVec3) {
        debug_assert!(self.pages.shared > FULL, "there is a full brick");
        if !self.page_is_full(brick >> 3i32) {
            self.put(brick, FULL);
        }
    }

    /// Puts a shared brick in the place of another.
    fn put(&mut self, brick: IVec3, shared: u32) {
        let id = self.pages.own(brick >> 3i32);
        let (old, empty) = self.pages.put(id, brick, shared);
        self.give_back(old);
        if empty {
            self.pages.set(brick >> 3i32, 0);
            self.pages.free.push(id);
        }
    }

    fn give_back(&mut self, place: u32) {
        if place >= self.pages.shared {
            self.store[place as usize] = T::default();
            self.free.push(place);
        }
    }

    /// Makes all 512 bricks of a page the full one.
    pub(crate) fn fill_page(&mut self, page: IVec3) {
        debug_assert!(self.pages.shared > FULL, "there is a full page");
        self.put_page(page, FULL);
    }

    /// Gives all bricks of a page back.
    pub(crate) fn release_page(&mut self, page: IVec3) {
        self.put_page(page, 0);
    }

    fn put_page(&mut self, page: IVec3, shared: u32) {
        let id = self.pages.at(page);
        for brick in cells_of(page, &self.pages.pages[id as usize].there) {
            self.pages.extent.change(brick, false);
        }
        self.pages.set(page, shared);
        for brick in cells_of(page, &self.pages.pages[shared as usize].there) {
            self.pages.extent.change(brick, true);
        }
        if id >= self.pages.shared {
            for place in *self.pages.pages[id as usize].bricks.clone() {
                self.give_back(place);
            }
            self.pages.free.push(id);
        }
    }

    /// All bricks that are there, with their coordinates, page by page.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (IVec3, &T)> {
        self.pages.listed.iter().flat_map(move |&(at, id)| {
            let page = &self.pages.pages[id as usize];
            cells_of(at, &page.there)
                .map(move |brick| (brick, &self.store[page.bricks[place_in_page(brick)] as usize]))
        })
    }

    /// Gives all bricks back.
    pub(crate) fn clear(&mut self) {
        self.store.truncate(self.pages.shared as usize);
        self.pages.clear();
        self.free.clear();
    }

    /// Bytes on the heap, without those that bricks themselves have there.
    pub(crate) fn bytes(&self) -> usize {
        self.pages.bytes() + self.store.capacity() * size_of::<T>() + self.free.capacity() * 4
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn bricks_come_and_go() {
        let mut b = Bricks::<u64>::default();
        let at = [IVec3::new(0, 0, 0), IVec3::new(24, 7, 12), IVec3::new(9, 3, 11)];
        for (i, &c) in at.iter().enumerate() {
            assert_eq!(*b.get(c), 0);
            *b.get_mut(c) = i as u64 + 1;
        }
        let mut seen: Vec<_> = b.iter().map(|(c, &v)| (v, c)).collect();
        seen.sort_by_key(|s| s.0);
        assert_eq!(seen, at.iter().enumerate().map(|(i, &c)| (i as u64 + 1, c)).collect::<Vec<_>>());
        let held = b.bytes();
        b.release(at[1]);
        b.release(at[1]);
        assert_eq!(*b.get(at[1]), 0);
        assert!(b.get_existing_mut(at[1]).is_none());
        *b.get_mut(at[1]) = 9;
        assert_eq!((*b.get(at[1]), *b.get(at[0])), (9, 1));
        assert!(b.bytes() <= held + 64);
    }

    #[test]
    fn full_ones_are_shared_until_they_are_written() {
        let mut b = Bricks::<u64>::with_full(7);
        let pages = [IVec3::new(0, 1, 1), IVec3::new(1, 1, 1), IVec3::new(2, 0, 1)];
        pages.iter().for_each(|&p| b.fill_page(p));
        assert_eq!((b.iter().count(), b.iter().all(|(_, &v)| v == 7)), (3 * 512, true));
        assert!(b.bytes() < 3 * 2048, "two pages, a table and counts: {}", b.bytes());
        let inside = IVec3::new(9, 10, 11);
        *b.get_mut(inside) = 3;
        assert_eq!((*b.get(inside), *b.get(inside + IVec3::X)), (3, 7));
        assert!(!b.page_is_full(pages[1]) && b.page_is_full(pages[0]));
        b.fill(inside);
        assert_eq!((*b.get(inside), b.iter().count()), (7, 3 * 512));
        b.release(IVec3::new(1, 9, 9));
        assert_eq!((*b.get(IVec3::new(1, 9, 9)), b.iter().count()), (0, 3 * 512 - 1));
        b.release_page(pages[0]);
        b.release_page(pages[1]);
        assert!(b.pages().is_empty(pages[0]) && b.iter().all(|(c, _)| c >> 3i32 == pages[2]));
        for i in 0..512 {
            b.release((pages[2] << 3i32) + IVec3::new(i & 7, i >> 3 & 7, i >> 6));
        }
        assert_eq!(b.iter().count(), 0);
    }

    #[test]
    fn pages_tell_of_their_bricks_wherever_they_are() {
        let (mut b, mut random) = (Bricks::<u64>::with_full(7), Random::new(3));
        let mut there = std::collections::BTreeMap::new();
        for step in 0..4000 {
            let i = random.below(600) as i32;
            // Four pages, two of them far away on either side.
            let page = IVec3::new([-9000, -1, 0, 16000][i as usize % 4], -1, i % 3 * 700);
            let brick = (page << 3i32) + IVec3::new(i & 7, i >> 3 & 7, i % 5);
            match random.below(if step < 3000 { 10 } else { 40 }) {
                0 => b.fill_page(page),
                1 => b.release_page(page),
                2..4 => b.fill(brick),
                4..7 => *b.get_mut(brick) = step,
                _ => b.release(brick),
            }
            for at in cells_of(page, &ALL) {
                match *b.get(at) {
                    0 => there.remove(&at.to_array()),
                    value => there.insert(at.to_array(), value),
                };
            }
            if step % 50 == 0 {
                let told: std::collections::BTreeMap<_, _> =
                    b.iter().map(|(at, &value)| (at.to_array(), value)).collect();
                assert_eq!(told, there, "step {step}");
                let bricks = b.pages().iter().flat_map(|page| cells_of(page, b.pages().bricks(page)));
                assert_eq!(bricks.count(), there.len());
                assert!(b.pages().iter().all(|page| !b.pages().is_empty(page)));
                let boxes = there.keys().map(|&at| CellBox { lo: at.into(), hi: at.into() });
                assert_eq!(b.pages().extent(), boxes.reduce(CellBox::join));
            }
        }
    }
}
