//! A depth buffer with levels of farthest depths.

/// Pixels along each side of a tile.
const TILE: usize = 8;

/// Nearness (1 / depth) of each pixel, and of the farthest pixel of each tile of 8x8. Tiles
/// are brought up to date when they are asked for.
#[derive(Debug, Clone)]
pub struct DepthPyramid {
    width: usize,
    height: usize,
    stride: usize,
    near: Vec<f32>,
    tiles: Vec<f32>,
    stale: Vec<bool>,
    tiles_x: usize,
}

impl DepthPyramid {
    /// A buffer of `width` by `height` pixels, all infinitely far.
    pub fn new(width: usize, height: usize) -> Self {
        let (tiles_x, tiles_y) = (width.div_ceil(TILE), height.div_ceil(TILE));
        let stride = tiles_x * TILE;
        Self {
            width,
            height,
            stride,
            near: vec![0.0; stride * tiles_y * TILE],
            tiles: vec![0.0; tiles_x * tiles_y],
            stale: vec![false; tiles_x * tiles_y],
            tiles_x,
        }
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
    pub fn at(&self, x: usize, y: usize) -> f32 {
        self.near[y * self.stride + x]
    }

    pub(super) fn clear(&mut self) {
        self.near.fill(0.0);
        self.tiles.fill(0.0);
        self.stale.fill(false);
    }

    /// The pixels `x0..x1` of a row, to be drawn on.
    pub(super) fn row(&mut self, y: usize, x0: usize, x1: usize) -> &mut [f32] {
        let tiles = y / TILE * self.tiles_x;
        self.stale[tiles + x0 / TILE..=tiles + (x1 - 1) / TILE].fill(true);
        &mut self.near[y * self.stride + x0..y * self.stride + x1]
    }

    /// Farthest pixel of a tile, of those inside the buffer.
    fn tile(&mut self, tx: usize, ty: usize) -> f32 {
        let t = ty * self.tiles_x + tx;
        if std::mem::take(&mut self.stale[t]) {
            let columns = tx * TILE..((tx + 1) * TILE).min(self.width);
            let rows = ty * TILE..((ty + 1) * TILE).min(self.height);
            self.tiles[t] = rows
                .flat_map(|y| &self.near[y * self.stride + columns.start..y * self.stride + columns.end])
                .fold(f32::INFINITY, |far, &n| far.min(n));
        }
        self.tiles[t]
    }

    /// Whether a rectangle of pixels, upper ends excluded, lies behind the buffer everywhere.
    pub(super) fn hides(&mut self, (x0, x1): (usize, usize), (y0, y1): (usize, usize), near: f32) -> bool {
        for ty in y0 / TILE..=(y1 - 1) / TILE {
            for tx in x0 / TILE..=(x1 - 1) / TILE {
                if self.tile(tx, ty) >= near {
                    continue;
                }
                let columns = (tx * TILE).max(x0)..((tx + 1) * TILE).min(x1);
                for y in (ty * TILE).max(y0)..((ty + 1) * TILE).min(y1) {
                    let row = &self.near[y * self.stride + columns.start..y * self.stride + columns.end];
                    if row.iter().any(|&n| n < near) {
                        return false;
                    }
                }
            }
        }
        true
    }

    /// Tests a box on the screen by its rectangle. Off the screen nothing is visible.
    pub(super) fn sees(&mut self, r: &super::ScreenBox) -> bool {
        let clamp = |(lo, hi): (f32, f32), size: usize| {
            let lo = lo.floor().max(0.0) as usize;
            let hi = hi.ceil().clamp(0.0, size as f32) as usize;
            (lo < hi).then_some((lo, hi))
        };
        match (clamp(r.x, self.width), clamp(r.y, self.height)) {
            (Some(x), Some(y)) => !self.hides(x, y, r.near),
            _ => false,
        }
    }
}
