//! Lists of drawn occluders by place on a face.

use crate::occlusion::pixels::{PixelRect, Window};
use crate::occlusion::tiles::TILE;

/// Tiles along each side of a bin.
pub(crate) const BIN: i64 = 2;

/// Tiles along each side of a large bin.
const LARGE_BIN: i64 = 16;

/// What reaches into more bins than this is listed in large ones.
const MANY: i64 = 32;

/// Items of a list that lie side by side.
const CHUNK: usize = 4;

/// One list for each square of tiles of a window.
///
/// All lists share the memory, which outlasts them, so that queries from new places take no more.
#[derive(Debug, Clone)]
pub(crate) struct Bins<T> {
    lists: Vec<List>,
    /// Those of all lists, with the number of the next one of the same list.
    chunks: Vec<([T; CHUNK], u32)>,
    /// The chunks in use come first.
    used: usize,
    /// Tiles along each side of a bin.
    side: i64,
    /// First tile of the window.
    first: (i64, i64),
    /// Bins in a row.
    across: i64,
}

/// The list of a bin: its first and its last chunk, and how many items it has.
#[derive(Debug, Clone, Copy, Default)]
struct List {
    first: u32,
    last: u32,
    len: u32,
}

impl<T: Copy> Bins<T> {
    /// No lists, until the first [`Bins::clear`].
    pub(crate) fn new() -> Self {
        Self::with_side(BIN)
    }

    fn with_side(side: i64) -> Self {
        Self { lists: Vec::new(), chunks: Vec::new(), used: 0, side, first: (0, 0), across: 0 }
    }

    /// Empties all lists, for another window. Keeps their memory.
    pub(crate) fn clear(&mut self, window: &Window) {
        let (nx, ny) = window.tile_count();
        self.first = window.first_tile();
        self.across = (nx - 1) / self.side + 1;
        let count = (self.across * ((ny - 1) / self.side + 1)) as usize;
        self.lists.clear();
        self.lists.resize(count, List::default());
        self.used = 0;
    }

    /// The number of the list for a pixel of the window.
    #[inline]
    pub(crate) fn index(&self, x: i64, y: i64) -> usize {
        let (bx, by) = ((x / TILE - self.first.0) / self.side, (y / TILE - self.first.1) / self.side);
        (by * self.across + bx) as usize
    }

    /// The number of items of a list.
    #[inline]
    pub(crate) fn len(&self, index: usize) -> usize {
        self.lists[index].len as usize
    }

    /// Whether all items of a list pass a test, in the order in which they were listed.
    #[inline]
    pub(crate) fn all(&self, index: usize, mut test: impl FnMut(&T) -> bool) -> bool {
        let List { first: mut at, len, .. } = self.lists[index];
        let mut left = len as usize;
        while left > 0 {
            let (items, next) = &self.chunks[at as usize];
            let here = left.min(CHUNK);
            if !items[..here].iter().all(&mut test) {
                return false;
            }
            (at, left) = (*next, left - here);
        }
        true
    }

    /// The first and last bin along x and along y of a rectangle of pixels of the window.
    #[inline]
    fn range(&self, pixels: &PixelRect) -> ((i64, i64), (i64, i64)) {
        let (x, y) = (pixels.tiles_x(), pixels.tiles_y());
        let bin = |tile: i64, first: i64| (tile - first) / self.side;
        ((bin(x.0, self.first.0), bin(x.1, self.first.0)), (bin(y.0, self.first.1), bin(y.1, self.first.1)))
    }

    /// Appends an item to the lists for a rectangle of pixels.
    #[inline]
    pub(crate) fn push(&mut self, pixels: &PixelRect, item: T) {
        let ((x0, x1), (y0, y1)) = self.range(pixels);
        for by in y0..=y1 {
            for bx in x0..=x1 {
                self.append((by * self.across + bx) as usize, item);
            }
        }
    }

    #[inline]
    fn append(&mut self, index: usize, item: T) {
        let list = &mut self.lists[index];
        let place = list.len as usize % CHUNK;
        if place == 0 {
            let new = self.used as u32;
            match self.chunks.get_mut(self.used) {
                Some(chunk) => chunk.0[0] = item,
                None => self.chunks.push(([item; CHUNK], 0)),
            }
            self.used += 1;
            if list.len == 0 {
                list.first = new;
            } else {
                self.chunks[list.last as usize].1 = new;
            }
            list.last = new;
        } else {
            self.chunks[list.last as usize].0[place] = item;
        }
        list.len += 1;
    }

    /// Calls `found` with the items in all lists for a rectangle of pixels, with some of them more
    /// than once.
    #[inline]
    pub(crate) fn for_around(&self, pixels: &PixelRect, mut found: impl FnMut(&T)) {
        let ((x0, x1), (y0, y1)) = self.range(pixels);
        for by in y0..=y1 {
            for bx in x0..=x1 {
                self.all((by * self.across + bx) as usize, |item| {
                    found(item);
                    true
                });
            }
        }
    }
}

/// Lists of items that may reach far: those that do are listed in larger squares.
#[derive(Debug, Clone)]
pub(crate) struct WideBins<T> {
    near: Bins<T>,
    far: Bins<T>,
}

impl<T: Copy> WideBins<T> {
    /// No lists, until the first [`WideBins::clear`].
    pub(crate) fn new() -> Self {
        Self { near: Bins::new(), far: Bins::with_side(LARGE_BIN) }
    }

    /// As [`Bins::clear`].
    pub(crate) fn clear(&mut self, window: &Window) {
        self.near.clear(window);
        self.far.clear(window);
    }

    /// As [`Bins::push`].
    #[inline]
    pub(crate) fn push(&mut self, pixels: &PixelRect, item: T) {
        let ((x0, x1), (y0, y1)) = self.near.range(pixels);
        let bins = if (x1 - x0 + 1) * (y1 - y0 + 1) > MANY { &mut self.far } else { &mut self.near };
        bins.push(pixels, item);
    }

    /// Whether any item that may reach to a pixel of the window, or some beside it, passes a test.
    #[inline]
    pub(crate) fn any_around(&self, x: i64, y: i64, mut test: impl FnMut(&T) -> bool) -> bool {
        let Self { near, far } = self;
        !near.all(near.index(x, y), |item| !test(item)) || !far.all(far.index(x, y), |item| !test(item))
    }

    /// As [`Bins::for_around`].
    #[inline]
    pub(crate) fn for_around(&self, pixels: &PixelRect, mut found: impl FnMut(&T)) {
        self.near.for_around(pixels, &mut found);
        self.far.for_around(pixels, found);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::occlusion::face::Rect;

    fn list(bins: &Bins<u32>, x: i64, y: i64) -> Vec<u32> {
        let (index, mut items) = (bins.index(x, y), Vec::new());
        bins.all(index, |&item| {
            items.push(item);
            true
        });
        assert_eq!(items.len(), bins.len(index));
        items
    }

    #[test]
    fn items_are_listed_wherever_they_reach() {
        let window = Window::around(&Rect::FACE, 100);
        let mut bins: Bins<u32> = Bins::new();
        bins.clear(&window);
        bins.push(&PixelRect { x: (31, 33), y: (0, 1) }, 7);
        bins.push(&PixelRect { x: (99, 100), y: (99, 100) }, 8);
        for (x, y, expected) in
            [(20, 0, vec![7]), (40, 15, vec![7]), (64, 0, vec![]), (0, 0, vec![]), (96, 96, vec![8])]
        {
            assert_eq!(list(&bins, x, y), expected, "{x} {y}");
        }
        let all = |bins: &Bins<u32>| {
            let mut all = Vec::new();
            bins.for_around(window.pixels(), |&item| all.push(item));
            all
        };
        assert_eq!(all(&bins), [7, 7, 8]);
        (9..20).for_each(|item| bins.push(&PixelRect { x: (0, 1), y: (0, 1) }, item));
        assert!(list(&bins, 0, 0).into_iter().eq(9..20), "lists of several chunks");
        bins.clear(&window);
        assert!(all(&bins).is_empty());
    }

    #[test]
    fn items_that_reach_far_are_listed_a_few_times() {
        let window = Window::around(&Rect::FACE, 400);
        let mut bins: WideBins<u32> = WideBins::new();
        bins.clear(&window);
        bins.push(&PixelRect { x: (31, 33), y: (0, 1) }, 7);
        bins.push(&PixelRect { x: (20, 320), y: (40, 300) }, 8);
        let at = |x: i64, y: i64| {
            let mut items = Vec::new();
            bins.any_around(x, y, |&item| {
                items.push(item);
                false
            });
            items
        };
        assert_eq!((at(31, 0), at(200, 200), at(399, 0)), (vec![7, 8], vec![8], vec![]));
        let mut all = Vec::new();
        bins.for_around(window.pixels(), |&item| all.push(item));
        assert!(all.iter().filter(|&&item| item == 8).count() == 9 && all.contains(&7), "{all:?}");
    }
}
