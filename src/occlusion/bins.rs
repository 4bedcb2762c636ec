//! Lists of drawn occluders by place on a face.

use crate::occlusion::pixels::{PixelRect, Window};
use crate::occlusion::tiles::TILE;

/// Tiles along each side of a bin.
const BIN: i64 = 4;

/// One list for each square of 4x4 tiles of a window.
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

    /// The numbers of the lists for a rectangle of pixels of the window.
    fn indices(&self, pixels: &PixelRect) -> impl Iterator<Item = usize> + use<T> {
        let (first, across) = (self.first, self.across);
        let (x, y) = (pixels.tiles_x(), pixels.tiles_y());
        let (bx0, bx1) = ((x.0 - first.0) / BIN, (x.1 - first.0) / BIN);
        let (by0, by1) = ((y.0 - first.1) / BIN, (y.1 - first.1) / BIN);
        (by0..=by1).flat_map(move |by| (bx0..=bx1).map(move |bx| (by * across + bx) as usize))
    }

    /// Appends an item to the lists for a rectangle of pixels.
    #[inline]
    pub(crate) fn push(&mut self, pixels: &PixelRect, item: T) {
        self.indices(pixels).for_each(|i| self.lists[i].push(item));
    }

    /// The items in all lists for a rectangle of pixels: some may come twice.
    pub(crate) fn around(&self, pixels: &PixelRect) -> impl Iterator<Item = &T> {
        self.indices(pixels).flat_map(|i| &self.lists[i])
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
        for (x, y, expected) in [(0, 0, vec![7]), (40, 31, vec![7]), (64, 0, vec![]), (96, 96, vec![8])] {
            assert_eq!(bins.list(bins.index(x, y)), expected, "{x} {y}");
        }
        assert_eq!(bins.around(window.pixels()).copied().collect::<Vec<_>>(), [7, 7, 8]);
        bins.clear(&window);
        assert_eq!(bins.around(window.pixels()).count(), 0);
    }
}
