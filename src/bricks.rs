//! Sparse storage shared by all matrices: bricks of 8x8x8 cells in pages of
//! 8x8x8 bricks. Memory follows occupied cells; only the page table (one word
//! for 64x64x64 cells) grows with the volume.
//!
//! This is the "recursive grid" of the thesis' future work (section 5).

use glam::IVec3;

/// Edge length of a brick in cells.
pub(crate) const BRICK: i32 = 8;

const PAGE_SHIFT: i32 = 6;

#[derive(Clone)]
struct Page {
    bricks: Box<[u32; 512]>,
    used: u32,
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
}

impl<T: Default> Bricks<T> {
    /// No bricks, for a grid of `dims` cells.
    pub(crate) fn new(dims: IVec3) -> Self {
        let pages_per_axis = (dims + (1 << PAGE_SHIFT) - 1) >> PAGE_SHIFT;
        let pages = pages_per_axis.to_array().iter().map(|&n| n as usize).product();
        Self {
            pages_per_axis,
            table: vec![0; pages],
            pages: vec![Page { bricks: Box::new([0; 512]), used: 0 }],
            free_pages: Vec::new(),
            store: vec![T::default()],
            free: Vec::new(),
        }
    }

    #[inline]
    fn page_index(&self, brick: IVec3) -> usize {
        let p = brick >> 3i32;
        ((p.z * self.pages_per_axis.y + p.y) * self.pages_per_axis.x + p.x) as usize
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

    /// The brick at brick coordinates inside the grid, made if absent.
    pub(crate) fn get_mut(&mut self, brick: IVec3) -> &mut T {
        let index = self.page_index(brick);
        if self.table[index] == 0 {
            let page = Page { bricks: Box::new([0; 512]), used: 0 };
            self.table[index] = match self.free_pages.pop() {
                Some(i) => {
                    self.pages[i as usize] = page;
                    i
                }
                None => {
                    self.pages.push(page);
                    self.pages.len() as u32 - 1
                }
            };
        }
        let page = &mut self.pages[self.table[index] as usize];
        let place = &mut page.bricks[Self::place_in_page(brick)];
        if *place == 0 {
            page.used += 1;
            *place = match self.free.pop() {
                Some(i) => i,
                None => {
                    self.store.push(T::default());
                    self.store.len() as u32 - 1
                }
            };
        }
        &mut self.store[*place as usize]
    }

    /// The brick, if it is there.
    pub(crate) fn get_existing_mut(&mut self, brick: IVec3) -> Option<&mut T> {
        let page = self.table[self.page_index(brick)];
        let place = self.pages[page as usize].bricks[Self::place_in_page(brick)];
        (place != 0).then(|| &mut self.store[place as usize])
    }

    /// Gives the brick back. Its storage is reused by the next one made.
    pub(crate) fn release(&mut self, brick: IVec3) {
        let index = self.page_index(brick);
        let page_id = self.table[index];
        let page = &mut self.pages[page_id as usize];
        let place = &mut page.bricks[Self::place_in_page(brick)];
        if *place == 0 {
            return;
        }
        self.store[*place as usize] = T::default();
        self.free.push(*place);
        *place = 0;
        page.used -= 1;
        if page.used == 0 {
            self.table[index] = 0;
            self.free_pages.push(page_id);
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
        self.pages.truncate(1);
        self.free_pages.clear();
        self.store.truncate(1);
        self.free.clear();
    }

    /// Bytes held, without what bricks hold on the heap.
    pub(crate) fn bytes(&self) -> usize {
        self.table.capacity() * 4
            + self.pages.capacity() * size_of::<Page>()
            + (self.pages.len() + self.free_pages.len()) * size_of::<[u32; 512]>()
            + self.store.capacity() * size_of::<T>()
            + (self.free.capacity() + self.free_pages.capacity()) * 4
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
