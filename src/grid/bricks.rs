//! Sparse storage shared by all matrices: bricks of 8x8x8 cells in pages of 8x8x8 bricks. Memory
//! follows occupied cells; only the page table (one word for 64x64x64 cells) grows with the volume.
//! Full bricks and full pages can be shared, so that the inside of a solid costs no more than its
//! pages.
//!
//! This is the "recursive grid" of the thesis' future work (section 5).

use glam::IVec3;

/// Edge length of a brick in cells, and of a page in bricks.
pub(crate) const BRICK: i32 = 8;

const PAGE_SHIFT: i32 = 6;

/// The brick that all full bricks share, and the page that all full pages share.
const FULL: u32 = 1;

#[derive(Clone)]
struct Page {
    bricks: Box<[u32; 512]>,
    used: u32,
}

impl Page {
    fn of(brick: u32) -> Self {
        Self { bricks: Box::new([brick; 512]), used: if brick == 0 { 0 } else { 512 } }
    }
}

/// How many pages there are in each plane of pages, in each row along x and in each row along y.
#[derive(Clone)]
struct Census {
    per: IVec3,
    /// Planes across x, across y and across z, then rows along x, then rows along y.
    counts: Vec<u32>,
}

impl Census {
    fn new(per: IVec3) -> Self {
        let IVec3 { x, y, z } = per;
        Self { per, counts: vec![0; (x + y + z + y * z + x * z) as usize] }
    }

    #[inline]
    fn plane(&self, axis: usize, page: IVec3) -> usize {
        ([0, self.per.x, self.per.x + self.per.y][axis] + page[axis]) as usize
    }

    #[inline]
    fn row(&self, along: usize, page: IVec3) -> usize {
        let IVec3 { x, y, z } = self.per;
        let first = x + y + z;
        (if along == 0 { first + page.z * y + page.y } else { first + y * z + page.z * x + page.x }) as usize
    }

    fn places(&self, page: IVec3) -> [usize; 5] {
        let plane = |axis| self.plane(axis, page);
        [plane(0), plane(1), plane(2), self.row(0, page), self.row(1, page)]
    }
}

/// Which pages are empty: for walks that pass over them.
pub(crate) trait Pages {
    /// Whether a page at page coordinates inside the grid has no bricks.
    fn page_is_empty(&self, page: IVec3) -> bool;

    /// Whether no page with the same coordinate along an axis has bricks.
    fn plane_is_empty(&self, axis: usize, page: IVec3) -> bool;

    /// Whether no page in the row along x (axis 0) or y (axis 1) through a page has bricks.
    fn row_is_empty(&self, along: usize, page: IVec3) -> bool;
}

impl<T: Default + Clone> Pages for Bricks<T> {
    #[inline]
    fn page_is_empty(&self, page: IVec3) -> bool {
        self.table[self.index_of_page(page)] == 0
    }

    #[inline]
    fn plane_is_empty(&self, axis: usize, page: IVec3) -> bool {
        self.census.counts[self.census.plane(axis, page)] == 0
    }

    #[inline]
    fn row_is_empty(&self, along: usize, page: IVec3) -> bool {
        self.census.counts[self.census.row(along, page)] == 0
    }
}

/// A sparse 3D array of bricks. Absent bricks read as the default brick.
#[derive(Clone)]
pub(crate) struct Bricks<T> {
    pages_per_axis: IVec3,
    /// Index into `pages`; 0 is the empty page.
    table: Vec<u32>,
    pages: Vec<Page>,
    free_pages: Vec<u32>,
    /// Brick 0 is the default one.
    store: Vec<T>,
    free: Vec<u32>,
    /// The first pages and bricks, which are never written: the empty ones, and the full ones where
    /// there are such.
    shared: u32,
    census: Census,
}

impl<T: Default + Clone> Bricks<T> {
    /// No bricks, for a grid of `dims` cells.
    pub(crate) fn new(dims: IVec3) -> Self {
        let pages_per_axis = (dims + (1 << PAGE_SHIFT) - 1) >> PAGE_SHIFT;
        let pages = pages_per_axis.to_array().iter().map(|&n| n as usize).product();
        Self {
            pages_per_axis,
            table: vec![0; pages],
            pages: vec![Page::of(0)],
            free_pages: Vec::new(),
            store: vec![T::default()],
            free: Vec::new(),
            shared: 1,
            census: Census::new(pages_per_axis),
        }
    }

    /// No bricks; those that are made full share one.
    pub(crate) fn with_full(dims: IVec3, full: T) -> Self {
        let mut bricks = Self::new(dims);
        bricks.pages.push(Page::of(FULL));
        bricks.store.push(full);
        Self { shared: FULL + 1, ..bricks }
    }

    #[inline]
    fn index_of_page(&self, p: IVec3) -> usize {
        ((p.z * self.pages_per_axis.y + p.y) * self.pages_per_axis.x + p.x) as usize
    }

    #[inline]
    fn page_index(&self, brick: IVec3) -> usize {
        self.index_of_page(brick >> 3i32)
    }

    #[inline]
    fn place_in_page(brick: IVec3) -> usize {
        (((brick.z & 7) << 6) | ((brick.y & 7) << 3) | (brick.x & 7)) as usize
    }

    /// The brick at brick coordinates inside the grid.
    #[inline]
    pub(crate) fn get(&self, brick: IVec3) -> &T {
        let page = self.table[self.page_index(brick)];
        &self.store[self.pages[page as usize].bricks[Self::place_in_page(brick)] as usize]
    }

    /// Whether a page was made full as a whole.
    pub(crate) fn page_is_full(&self, page: IVec3) -> bool {
        self.shared > FULL && self.table[self.index_of_page(page)] == FULL
    }

    /// Writes a page into the table.
    fn set_page(&mut self, page: IVec3, id: u32) {
        let index = self.index_of_page(page);
        let old = std::mem::replace(&mut self.table[index], id);
        if (old == 0) != (id == 0) {
            for place in self.census.places(page) {
                let count = &mut self.census.counts[place];
                *count = if id == 0 { *count - 1 } else { *count + 1 };
            }
        }
    }

    /// The page of a brick, which is created if it is absent and copied if it is shared.
    fn own_page(&mut self, brick: IVec3) -> u32 {
        let id = self.table[self.page_index(brick)];
        if id >= self.shared {
            return id;
        }
        let page = self.pages[id as usize].clone();
        let id = match self.free_pages.pop() {
            Some(i) => {
                self.pages[i as usize] = page;
                i
            }
            None => {
                self.pages.push(page);
                self.pages.len() as u32 - 1
            }
        };
        self.set_page(brick >> 3i32, id);
        id
    }

    /// The brick at brick coordinates inside the grid, made if absent.
    #[inline]
    pub(crate) fn get_mut(&mut self, brick: IVec3) -> &mut T {
        let place = self.place(brick);
        let place = if place < self.shared { self.own_brick(brick) } else { place };
        &mut self.store[place as usize]
    }

    /// Where the brick is in the store: its own place, or one that bricks share.
    #[inline]
    fn place(&self, brick: IVec3) -> u32 {
        let page = self.table[self.page_index(brick)];
        self.pages[page as usize].bricks[Self::place_in_page(brick)]
    }

    /// Gives a brick that has none a place of its own.
    #[cold]
    fn own_brick(&mut self, brick: IVec3) -> u32 {
        let id = self.own_page(brick);
        let page = &mut self.pages[id as usize];
        let place = &mut page.bricks[Self::place_in_page(brick)];
        page.used += u32::from(*place == 0);
        let own = self.store[*place as usize].clone();
        *place = match self.free.pop() {
            Some(i) => {
                self.store[i as usize] = own;
                i
            }
            None => {
                self.store.push(own);
                self.store.len() as u32 - 1
            }
        };
        *place
    }

    /// The brick, if it is there.
    #[inline]
    pub(crate) fn get_existing_mut(&mut self, brick: IVec3) -> Option<&mut T> {
        if self.place(brick) == 0 { None } else { Some(self.get_mut(brick)) }
    }

    /// Gives the brick back. Its storage is reused by the next one made.
    pub(crate) fn release(&mut self, brick: IVec3) {
        let page = self.table[self.page_index(brick)];
        if self.pages[page as usize].bricks[Self::place_in_page(brick)] != 0 {
            self.put(brick, 0);
        }
    }

    /// Makes a brick the full one, of [`Bricks::with_full`].
    pub(crate) fn fill(&mut self, brick: IVec3) {
        debug_assert!(self.shared > FULL, "there is a full brick");
        if !self.page_is_full(brick >> 3i32) {
            self.put(brick, FULL);
        }
    }

    /// Puts a shared brick in the place of another.
    fn put(&mut self, brick: IVec3, shared: u32) {
        let id = self.own_page(brick);
        let page = &mut self.pages[id as usize];
        let place = &mut page.bricks[Self::place_in_page(brick)];
        let old = std::mem::replace(place, shared);
        page.used += u32::from(shared != 0);
        page.used -= u32::from(old != 0);
        let empty = page.used == 0;
        if old >= self.shared {
            self.store[old as usize] = T::default();
            self.free.push(old);
        }
        if empty {
            self.set_page(brick >> 3i32, 0);
            self.free_pages.push(id);
        }
    }

    /// Makes all 512 bricks of a page, which lie inside the grid, the full one.
    pub(crate) fn fill_page(&mut self, page: IVec3) {
        debug_assert!(self.shared > FULL, "there is a full page");
        self.put_page(page, FULL);
    }

    /// Gives all bricks of a page back.
    pub(crate) fn release_page(&mut self, page: IVec3) {
        self.put_page(page, 0);
    }

    fn put_page(&mut self, page: IVec3, shared: u32) {
        let id = self.table[self.index_of_page(page)];
        self.set_page(page, shared);
        if id >= self.shared {
            for place in *self.pages[id as usize].bricks {
                if place >= self.shared {
                    self.store[place as usize] = T::default();
                    self.free.push(place);
                }
            }
            self.free_pages.push(id);
        }
    }

    /// All bricks that are there, with their coordinates, in storage order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (IVec3, &T)> {
        self.table.iter().enumerate().filter(|&(_, &page)| page != 0).flat_map(move |(i, &page)| {
            let i = i as i32;
            let per = self.pages_per_axis;
            let corner = IVec3::new(i % per.x, i / per.x % per.y, i / (per.x * per.y)) << 3i32;
            let bricks = &self.pages[page as usize].bricks;
            bricks.iter().enumerate().filter(|&(_, &b)| b != 0).map(move |(j, &b)| {
                let j = j as i32;
                (corner + IVec3::new(j & 7, j >> 3 & 7, j >> 6), &self.store[b as usize])
            })
        })
    }

    /// Gives all bricks back.
    pub(crate) fn clear(&mut self) {
        self.table.fill(0);
        self.census.counts.fill(0);
        self.pages.truncate(self.shared as usize);
        self.free_pages.clear();
        self.store.truncate(self.shared as usize);
        self.free.clear();
    }

    /// Bytes on the heap, without those that bricks themselves have there.
    pub(crate) fn bytes(&self) -> usize {
        (self.table.capacity() + self.census.counts.capacity()) * 4
            + self.pages.capacity() * size_of::<Page>()
            + self.pages.len() * size_of::<[u32; 512]>()
            + self.store.capacity() * size_of::<T>()
            + (self.free.capacity() + self.free_pages.capacity()) * 4
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn bricks_come_and_go() {
        let mut b = Bricks::<u64>::new(IVec3::new(200, 60, 100));
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
        let mut b = Bricks::<u64>::with_full(IVec3::new(192, 128, 128), 7);
        let bare = b.bytes();
        let pages = [IVec3::new(0, 1, 1), IVec3::new(1, 1, 1), IVec3::new(2, 0, 1)];
        pages.iter().for_each(|&p| b.fill_page(p));
        assert_eq!((b.iter().count(), b.iter().all(|(_, &v)| v == 7)), (3 * 512, true));
        assert_eq!(b.bytes(), bare);
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
        assert!(b.page_is_empty(pages[0]) && b.iter().all(|(c, _)| c >> 3i32 == pages[2]));
        for i in 0..512 {
            b.release((pages[2] << 3i32) + IVec3::new(i & 7, i >> 3 & 7, i >> 6));
        }
        assert_eq!(b.iter().count(), 0);
    }

    #[test]
    fn planes_and_rows_know_whether_they_are_empty() {
        let per = IVec3::new(5, 3, 4);
        let mut b = Bricks::<u64>::new(per * 64);
        let mut random = Random::new(3);
        let mut there = std::collections::BTreeSet::new();
        for step in 0..400 {
            let i = random.below(60) as i32;
            let page = IVec3::new(i % 5, i / 5 % 3, i / 15);
            if step % 3 == 0 || step > 300 {
                if step % 2 == 0 {
                    b.release_page(page)
                } else {
                    b.release(page << 3i32)
                }
                there.remove(&page.to_array());
            } else {
                *b.get_mut(page << 3i32) = 1;
                there.insert(page.to_array());
            }
            for j in 0..60 {
                let p = IVec3::new(j % 5, j / 5 % 3, j / 15);
                let any = |same: &dyn Fn(IVec3) -> bool| there.iter().any(|&q| same(q.into()));
                assert_eq!(b.page_is_empty(p), !any(&|q| q == p));
                for axis in 0..3 {
                    assert_eq!(b.plane_is_empty(axis, p), !any(&|q| q[axis] == p[axis]));
                }
                assert_eq!(b.row_is_empty(0, p), !any(&|q| q.y == p.y && q.z == p.z));
                assert_eq!(b.row_is_empty(1, p), !any(&|q| q.x == p.x && q.z == p.z));
            }
        }
    }
}
