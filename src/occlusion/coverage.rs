//! The covered pixels of a window, tile by tile.

use crate::occlusion::face::{Linear, Rect};
use crate::occlusion::pixels::{PixelRect, Window};
use crate::occlusion::target::FaceTarget;
use crate::occlusion::tiles::{TILE, Tile, columns_from, columns_up_to, rows_from, rows_up_to};

/// Planes kept for a tile.
const SHADES: usize = 2;

/// Pixels of a tile in which everything behind a plane is hidden. Says more than one depth for the
/// tile.
#[derive(Debug, Clone, Copy)]
struct Shade {
    mask: u64,
    near: Linear,
}

/// The planes of a tile that cover most of its pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shades([Shade; SHADES]);

impl Shades {
    const NONE: Self = Self([Shade { mask: 0, near: Linear { a: 0.0, b: 0.0, c: 0.0 } }; SHADES]);

    /// Keeps a plane if it covers more pixels than one that is kept.
    fn add(&mut self, mask: u64, near: Linear) {
        let least = self.0.iter_mut().min_by_key(|s| s.mask.count_ones());
        if let Some(least) = least.filter(|s| s.mask.count_ones() < mask.count_ones()) {
            *least = Shade { mask, near };
        }
    }

    /// The pixels of `open` that no plane hides, where all of the target in the tile lies behind
    /// it.
    #[inline]
    pub(crate) fn open(&self, mut open: u64, target: &FaceTarget, tile: &Rect) -> u64 {
        for shade in &self.0 {
            if open & shade.mask != 0 && target.is_behind_plane(&shade.near, tile) {
                open &= !shade.mask;
            }
        }
        open
    }

    /// Whether one pixel of the tile is hidden by a plane.
    #[inline]
    pub(crate) fn hide_pixel(&self, bit: i64, target: &FaceTarget, pixel: &Rect) -> bool {
        self.0.iter().any(|s| s.mask >> bit & 1 == 1 && target.is_behind_plane(&s.near, pixel))
    }

    /// Whether a point in one of the pixels given is hidden by a plane.
    fn hide_point(&self, bits: u64, (u, v): (f64, f64), near: f64) -> bool {
        self.0.iter().any(|s| s.mask & bits != 0 && s.near.at(u, v) >= near)
    }
}

/// The tiles of a window.
#[derive(Debug, Clone, Default)]
pub(crate) struct Coverage {
    tiles: Vec<Tile>,
    /// For each tile, the nearness down to which all of its pixels are covered.
    closed: Vec<f32>,
    shades: Vec<Shades>,
    /// Whether any tile has planes.
    shaded: bool,
}

impl Coverage {
    /// Takes over the pixels of another window.
    pub(crate) fn copy(&mut self, from: &Self) {
        self.tiles.clone_from(&from.tiles);
        self.closed.clone_from(&from.closed);
        self.shades.clone_from(&from.shades);
        self.shaded = from.shaded;
    }

    /// Starts anew with this number of open tiles.
    pub(crate) fn clear(&mut self, count: usize) {
        self.tiles.clear();
        self.tiles.resize(count, Tile::EMPTY);
        self.closed.clear();
        self.closed.resize(count, f32::NEG_INFINITY);
        if self.shaded {
            self.shades.clear();
            self.shaded = false;
        }
        self.shades.resize(count, Shades::NONE);
    }

    /// Opens all pixels of a tile.
    pub(crate) fn open(&mut self, tile: usize) {
        self.tiles[tile] = Tile::EMPTY;
        self.closed[tile] = f32::NEG_INFINITY;
        self.shades[tile] = Shades::NONE;
    }

    /// The nearness down to which all pixels of a tile are covered.
    #[inline]
    pub(crate) fn closed(&self, tile: usize) -> f32 {
        self.closed[tile]
    }

    /// Whether all pixels of the tiles from `first` to `last` are covered nearer than a nearness.
    #[inline]
    pub(crate) fn all_closed(&self, first: usize, last: usize, near: f32) -> bool {
        self.closed[first..last + 1].iter().all(|&c| c >= near)
    }

    /// Whether all pixels of all tiles are covered nearer than a nearness.
    pub(crate) fn is_closed(&self, near: f32) -> bool {
        self.closed.iter().all(|&c| c >= near)
    }

    /// A tile by its place.
    #[inline]
    pub(crate) fn tile(&self, tile: usize) -> &Tile {
        &self.tiles[tile]
    }

    /// The planes kept for a tile.
    #[inline]
    pub(crate) fn shades(&self, tile: usize) -> &Shades {
        &self.shades[tile]
    }

    /// Covers pixels of a tile at a nearness. Returns whether that hides more than before.
    #[inline]
    pub(crate) fn cover(&mut self, tile: usize, mask: u64, near: f32) -> bool {
        let changed = self.tiles[tile].cover(mask, near);
        if changed {
            self.closed[tile] = self.tiles[tile].closed();
        }
        changed
    }

    /// As [`Coverage::closed`], of four tiles that follow each other, if there are that many.
    #[inline(always)]
    pub(crate) fn closed_four(&self, first: usize) -> Option<&[f32]> {
        self.closed.get(first..first.wrapping_add(4))
    }

    /// As [`Coverage::cover`], if not all of the tile is covered nearer, and keeps the plane behind
    /// which the pixels are hidden.
    #[inline(always)]
    pub(crate) fn cover_behind(&mut self, tile: usize, mask: u64, near: f32, plane: Option<Linear>) -> bool {
        let is_nearer = self.closed[tile] < near;
        if is_nearer && let Some(plane) = plane {
            self.shades[tile].add(mask, plane);
            self.shaded = true;
        }
        is_nearer && self.cover(tile, mask, near)
    }

    /// Whether all pixels of a rectangle are covered for targets nowhere nearer than `near`.
    #[inline]
    pub(crate) fn hides(&self, window: &Window, pixels: &PixelRect, near: f32) -> bool {
        self.open_pixels(window, pixels, near, |open| open == 0)
    }

    /// Whether few pixels of a rectangle are open for targets nowhere nearer than `near`: their
    /// number squared is at most `most` times that of all.
    pub(crate) fn few_open(&self, window: &Window, pixels: &PixelRect, near: f32, most: u64) -> bool {
        let most = if pixels.is_empty() { 0 } else { most.saturating_mul(pixels.count()) };
        let mut sum = 0;
        self.open_pixels(window, pixels, near, |open| {
            sum += u64::from(open.count_ones());
            sum * sum <= most
        })
    }

    /// Passes the open pixels of a rectangle in each tile to a test, until that fails; whether it
    /// never did. Tiles without any may be left out.
    #[inline(always)]
    fn open_pixels(
        &self,
        window: &Window,
        pixels: &PixelRect,
        near: f32,
        mut test: impl FnMut(u64) -> bool,
    ) -> bool {
        if pixels.is_empty() {
            return true;
        }
        let ((tx0, tx1), (ty0, ty1)) = (pixels.tiles_x(), pixels.tiles_y());
        let last = (tx1 - tx0) as usize;
        let (left, right) = (columns_from(pixels.x.0), columns_up_to(pixels.x.1));
        for ty in ty0..=ty1 {
            let rows = if ty == ty0 { rows_from(pixels.y.0) } else { u64::MAX }
                & if ty == ty1 { rows_up_to(pixels.y.1) } else { u64::MAX };
            let start = window.tile_index(tx0, ty);
            let tiles = &self.tiles[start..start + last + 1];
            for (i, (&closed, tile)) in self.closed[start..].iter().zip(tiles).enumerate() {
                if closed >= near {
                    continue;
                }
                let columns = if i == 0 { left } else { u64::MAX } & if i == last { right } else { u64::MAX };
                if !test(rows & columns & !tile.hidden(near)) {
                    return false;
                }
            }
        }
        true
    }

    /// Whether a point of a pixel is hidden: by the tile at `tile_near`, or by a plane at `near`.
    pub(crate) fn hides_point(
        &self,
        window: &Window,
        (x, y): (i64, i64),
        at: (f64, f64),
        tile_near: f32,
        near: f64,
    ) -> bool {
        let t = window.tile_index(x / TILE, y / TILE);
        let bit = 1u64 << (y % TILE * TILE + x % TILE);
        self.tiles[t].hidden(tile_near) & bit != 0 || self.shades[t].hide_point(bit, at, near)
    }

    /// The nearness down to which a pixel is hidden; negative infinity if it is open.
    pub(crate) fn nearness(&self, window: &Window, x: i64, y: i64) -> f32 {
        let tile = &self.tiles[window.tile_index(x / TILE, y / TILE)];
        tile.nearness((y % TILE * TILE + x % TILE) as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::occlusion::tiles::block;

    #[test]
    fn a_rectangle_is_hidden_once_all_its_pixels_are() {
        let window = Window::around(&Rect::FACE, 32);
        let mut coverage = Coverage::default();
        coverage.clear(16);
        let pixels = PixelRect { x: (6, 18), y: (3, 9) };
        let near = 0.5;
        let mut changed = false;
        for ty in 0..2 {
            for tx in 0..3 {
                assert!(!coverage.hides(&window, &pixels, near), "{tx} {ty}");
                let (x, y) = (tx * 8, ty * 8);
                let mask = block(6 - x, 18 - x, 3 - y, 9 - y);
                changed |= coverage.cover(window.tile_index(tx, ty), mask, near);
            }
        }
        assert!(changed && coverage.hides(&window, &pixels, near));
        assert!(!coverage.hides(&window, &pixels, 0.6));
        assert!(!coverage.hides(&window, &PixelRect { x: (6, 19), ..pixels }, near));
        assert_eq!(coverage.nearness(&window, 6, 3), near);
        assert_eq!(coverage.nearness(&window, 5, 3), f32::NEG_INFINITY);
        // A tile is closed when its last pixel is.
        let middle = window.tile_index(1, 0);
        assert_eq!(coverage.closed(middle), f32::NEG_INFINITY);
        coverage.cover(middle, u64::MAX, 0.25);
        assert_eq!(coverage.closed(middle), 0.25);
        assert!(!coverage.is_closed(0.25));
    }

    #[test]
    fn open_pixels_are_few_up_to_a_share() {
        let window = Window::around(&Rect::FACE, 32);
        let mut coverage = Coverage::default();
        coverage.clear(16);
        // 12 of 18 x 12 pixels stay open, in a row across a border of tiles.
        let pixels = PixelRect { x: (4, 22), y: (6, 18) };
        for tile in 0..16 {
            coverage.cover(tile, u64::MAX, 0.5);
        }
        for (tx, x) in [(0, 4..8), (1, 0..8)] {
            let tile = window.tile_index(tx, 1);
            coverage.open(tile);
            coverage.cover(tile, !block(x.start, x.end, 3, 4), 0.5);
        }
        let few = |near, most| coverage.few_open(&window, &pixels, near, most);
        assert!(few(0.5, 1) && !few(0.5, 0), "12 * 12 <= 216");
        assert!(!few(0.6, 215) && few(0.6, 216), "all 216 are open");
        assert!(coverage.few_open(&window, &PixelRect::EMPTY, 0.5, 0));
    }

    #[test]
    fn the_planes_that_cover_most_are_kept() {
        let mut shades = Shades::NONE;
        let plane = |c| Linear { a: 0.0, b: 0.0, c };
        shades.add(0b1, plane(1.0));
        shades.add(0b1111_0000, plane(2.0));
        shades.add(0b110, plane(3.0));
        assert!(!shades.hide_point(0b1, (0.0, 0.0), 0.5));
        assert!(shades.hide_point(0b10, (0.0, 0.0), 3.0) && !shades.hide_point(0b10, (0.0, 0.0), 3.5));
        assert!(shades.hide_point(0b1_0000, (0.0, 0.0), 2.0));
    }
}
