//! Lists of drawn occluders by place on a face.

use crate::occlusion::pixels::{PixelRect, Window};
use crate::occlusion::tiles::TILE;

/// Tiles along each side of a bin.
pub(crate) const BIN: i64 = 2;

/// One list for each square of 2x2 tiles of a window.
#[derive(Debug, Clone)]
pub(crate) struct Bins<T> {
    lists: Vec<Vec<T>>,
    /// First tile of the window.
    first: (i64, i64),
    /// Bins in a row.
    across: i64,
}

impl<T: Copy> Bins<T> {
    /// No lists, until the first [`Bins::clear`].
    pub(crate) fn new() -> Self {
        Self { lists: Vec::new(), first: (0, 0), across: 0 }
    }

    /// Empties all lists, for another window. Keeps their memory.
    pub(crate) fn clear(&mut self, window: &Window) {
        let (nx, ny) = window.tile_count();
        self.first = window.first_tile();
        self.across = (nx - 1) / BIN + 1;
        let count = (self.across * ((ny - 1) / BIN + 1)) as usize;
        self.lists.iter_mut().for_each(Vec::clear);
        if self.lists.len() < count {
            self.lists.resize_with(count, Vec::new);
        }
    }

    /// The number of the list for a pixel of the window.
    #[inline]
    pub(crate) fn index(&self, x: i64, y: i64) -> usize {
        let (bx, by) = ((x / TILE - self.first.0) / BIN, (y / TILE - self.first.1) / BIN);
        (by * self.across + bx) as usize
    }

    /// A list by its number.
    #[inline]
    pub(crate) fn list(&self, index: usize) -> &[T] {
        &self.lists[index]
    }

    /// The first and last bin along x and along y of a rectangle of pixels of the window.
    #[inline]
    fn range(&self, pixels: &PixelRect) -> ((i64, i64), (i64, i64)) {
        let (x, y) = (pixels.tiles_x(), pixels.tiles_y());
        let bin = |tile: i64, first: i64| (tile - first) / BIN;
        ((bin(x.0, self.first.0), bin(x.1, self.first.0)), (bin(y.0, self.first.1), bin(y.1, self.first.1)))
    }

    /// Appends an item to the lists for a rectangle of pixels.
    #[inline]
    pub(crate) fn push(&mut self, pixels: &PixelRect, item: T) {
        let ((x0, x1), (y0, y1)) = self.range(pixels);
        for by in y0..=y1 {
            for bx in x0..=x1 {
                self.lists[(by * self.across + bx) as usize].push(item);
            }
        }
    }

    /// Calls `found` with the items in all lists for a rectangle of pixels, with some of them more
    /// than once.
    #[inline]
    pub(crate) fn for_around(&self, pixels: &PixelRect, mut found: impl FnMut(&T)) {
        let ((x0, x1), (y0, y1)) = self.range(pixels);
        for by in y0..=y1 {
            for bx in x0..=x1 {
                self.lists[(by * self.across + bx) as usize].iter().for_each(&mut found);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::occlusion::face::Rect;

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
            assert_eq!(bins.list(bins.index(x, y)), expected, "{x} {y}");
        }
        let all = |bins: &Bins<u32>| {
            let mut all = Vec::new();
            bins.for_around(window.pixels(), |&item| all.push(item));
            all
        };
        assert_eq!(all(&bins), [7, 7, 8]);
        bins.clear(&window);
        assert!(all(&bins).is_empty());
    }
}
