//! A depth buffer with a level of farthest depths above it.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, f32x8};

/// Pixels along each side of a tile.
pub(super) const TILE: usize = 8;

/// Rows of pixels that lie together in memory.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Tile([[f32; TILE]; TILE]);

/// Pixels from the first ends to the second ones, which are excluded, and the greatest nearness
/// there.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelRect {
    /// Columns.
    pub(super) x: [u16; 2],
    /// Rows.
    pub(super) y: [u16; 2],
    /// 1 / depth.
    pub(super) near: f32,
}

impl PixelRect {
    /// Whether it has no pixel.
    fn is_empty(&self) -> bool {
        self.x[0] >= self.x[1] || self.y[0] >= self.y[1]
    }
}

/// Nearness (1 / depth) of each pixel, and of the farthest pixel of each tile of 8x8. Tiles
/// are brought up to date when they are asked for.
#[derive(Debug, Clone)]
pub struct DepthPyramid {
    width: usize,
    height: usize,
    /// Tiles in a row.
    columns: usize,
    tiles: Vec<Tile>,
    far: Vec<f32>,
    stale: Vec<bool>,
    level: Level,
}

impl DepthPyramid {
    /// A buffer of `width` by `height` pixels, at most 65,535 each, all infinitely far.
    pub fn new(width: usize, height: usize) -> Self {
        assert!(width <= 65_535 && height <= 65_535, "at most 65,535 pixels a side");
        let (columns, rows) = (width.div_ceil(TILE), height.div_ceil(TILE));
        let mut depth = Self {
            width,
            height,
            columns,
            tiles: vec![Tile([[0.0; TILE]; TILE]); columns * rows],
            far: vec![0.0; columns * rows],
            stale: vec![false; columns * rows],
            level: Level::new(),
        };
        depth.clear();
        depth
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// 1 / depth of a pixel; 0 where nothing is.
    #[cfg(test)]
    pub fn at(&self, x: usize, y: usize) -> f32 {
        self.tiles[y / TILE * self.columns + x / TILE].0[y % TILE][x % TILE]
    }

    /// The vectors of this machine.
    pub(super) fn level(&self) -> Level {
        self.level
    }

    /// Empties the buffer.
    pub fn clear(&mut self) {
        self.tiles.fill(Tile([[0.0; TILE]; TILE]));
        self.far.fill(0.0);
        self.stale.fill(false);
        // Pixels beyond the border hide everything, so that they never decide.
        let (right, bottom) = (self.width % TILE, self.height % TILE);
        if right > 0 {
            for tile in self.tiles.iter_mut().skip(self.columns - 1).step_by(self.columns) {
                tile.0.iter_mut().for_each(|row| row[right..].fill(f32::INFINITY));
            }
        }
        if bottom > 0 {
            let last = self.tiles.len() - self.columns;
            for tile in &mut self.tiles[last..] {
                tile.0[bottom..].fill([f32::INFINITY; TILE]);
            }
        }
    }

    /// The number of a tile.
    #[inline(always)]
    pub(super) fn tile(&self, column: usize, row: usize) -> usize {
        row * self.columns + column
    }

    /// No pixel of the tile is farther; it may be that all are nearer.
    #[inline(always)]
    pub(super) fn least(&self, tile: usize) -> f32 {
        self.far[tile]
    }

    /// The rows of a tile, to be drawn on.
    #[inline(always)]
    pub(super) fn rows(&mut self, tile: usize) -> &mut [[f32; TILE]; TILE] {
        self.stale[tile] = true;
        &mut self.tiles[tile].0
    }

    /// Nearness of the farthest pixel of a tile.
    #[inline(always)]
    fn farthest<S: Simd>(&mut self, simd: S, tile: usize) -> f32 {
        if std::mem::take(&mut self.stale[tile]) {
            let rows = self.tiles[tile].0.each_ref().map(|row| f32x8::from_slice(simd, row));
            let [a, b, c, d, e, f, g, h] = rows;
            self.far[tile] = (a.min(b).min(c.min(d))).min(e.min(f).min(g.min(h))).reduce_min();
        }
        self.far[tile]
    }

    /// Whether the buffer is at least as near as a rectangle everywhere: by tiles, and by pixels
    /// where those leave it open. Without pixels nothing is open.
    #[inline(always)]
    pub(super) fn hides_in<S: Simd>(&mut self, simd: S, rect: &PixelRect) -> bool {
        if rect.is_empty() {
            return true;
        }
        let ([x0, x1], [y0, y1]) = (rect.x.map(usize::from), rect.y.map(usize::from));
        let lanes = f32x8::from_slice(simd, &LANES);
        let near = f32x8::splat(simd, rect.near);
        for row in y0 / TILE..=(y1 - 1) / TILE {
            let rows = (row * TILE).max(y0) - row * TILE..((row + 1) * TILE).min(y1) - row * TILE;
            for column in x0 / TILE..=(x1 - 1) / TILE {
                let tile = self.tile(column, row);
                if self.farthest(simd, tile) >= rect.near {
                    continue;
                }
                let first = lanes + (column * TILE) as f32;
                let within = first.simd_ge(x0 as f32) & first.simd_lt(x1 as f32);
                for pixels in &self.tiles[tile].0[rows.clone()] {
                    if (f32x8::from_slice(simd, pixels).simd_lt(near) & within).any_true() {
                        return false;
                    }
                }
            }
        }
        true
    }
}

/// The numbers of lanes.
pub(super) const LANES: [f32; TILE] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
