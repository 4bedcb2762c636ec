//! Which tiles of a map block sight, and where such tiles lie in a scene.

use std::ops::Range;

use glam::{DVec2, Vec2};

use crate::bits::BitGrid;
use crate::error::{Error, LEAST, finite2, within};
use crate::geometry::Rect;

/// The tiles of a map that block sight, by rows and by columns, since a sweep to the east or west
/// reads columns.
///
/// Tile `(x, y)` is the closed square from `(x, y)` to `(x + 1, y + 1)`. Nothing outside of the map
/// blocks.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct OpaqueTiles {
    rows: BitGrid,
    columns: BitGrid,
}

impl OpaqueTiles {
    /// Tiles that block sight where bits are set. Costs a pass over the words of the grid.
    pub fn new(opaque: BitGrid) -> Self {
        let mut columns = BitGrid::new(opaque.height(), opaque.width());
        add_transposed(&opaque, &mut columns, 0..opaque.width(), 0..opaque.height());
        Self { rows: opaque, columns }
    }

    /// The number of tiles of a row.
    pub fn width(&self) -> u32 {
        self.rows.width()
    }

    /// The number of rows.
    pub fn height(&self) -> u32 {
        self.rows.height()
    }

    /// Whether a tile blocks sight. Tiles outside of the map do not.
    pub fn get(&self, x: u32, y: u32) -> bool {
        self.rows.get(x, y)
    }

    /// Lets a tile block sight, or not. Does nothing outside of the map.
    pub fn set(&mut self, x: u32, y: u32, opaque: bool) {
        self.rows.set(x, y, opaque);
        self.columns.set(y, x, opaque);
    }

    /// The tiles, a bit for each.
    pub fn bits(&self) -> &BitGrid {
        &self.rows
    }

    /// The tiles with x and y exchanged.
    pub(super) fn columns(&self) -> &BitGrid {
        &self.columns
    }
}

/// Square tiles in a scene, some of which block sight.
///
/// Tile `(x, y)` covers the square from `origin + (x, y) * tile_size` to `origin + (x + 1, y + 1) *
/// tile_size`.
#[derive(Debug, Clone, PartialEq)]
pub struct TileLayer {
    origin: Vec2,
    tile_size: f32,
    opaque: OpaqueTiles,
}

impl TileLayer {
    /// A layer whose tile `(0, 0)` has its least corner at `origin`.
    ///
    /// # Errors
    /// An origin or a size that is not finite, a size that is not greater than zero, a layer that
    /// reaches beyond the numbers of single precision.
    pub fn new(origin: Vec2, tile_size: f32, opaque: BitGrid) -> Result<Self, Error> {
        finite2("the origin of a tile layer", origin)?;
        let most = f64::from(f32::MAX);
        within("the size of a tile", tile_size.into(), [LEAST, most])?;
        let layer = Self { origin, tile_size, opaque: OpaqueTiles::new(opaque) };
        for part in layer.corner(layer.opaque.width(), layer.opaque.height()).to_array() {
            within("the far corner of a tile layer", part, [-most, most])?;
        }
        Ok(layer)
    }

    /// The side of a tile.
    pub fn tile_size(&self) -> f32 {
        self.tile_size
    }

    /// The tiles that block sight.
    pub fn opaque(&self) -> &OpaqueTiles {
        &self.opaque
    }

    /// The least corner of a tile, in the scene.
    pub(crate) fn corner(&self, x: u32, y: u32) -> DVec2 {
        self.origin.as_dvec2() + DVec2::new(x.into(), y.into()) * f64::from(self.tile_size)
    }

    /// The rectangle of all tiles, in the scene, rounded to single precision: for
    /// [`GridSpec::covering`](crate::GridSpec::covering), for example.
    pub fn bounds(&self) -> Rect {
        let max = self.corner(self.opaque.width(), self.opaque.height());
        Rect::new(self.origin, max.as_vec2())
    }
}

/// The width of a block of bits.
const BLOCK: usize = u64::BITS as usize;

/// Exchanges the rows and columns of a block, by exchanging ever smaller quarters (Warren, Hacker's
/// Delight, section 7-3).
fn transpose_block(block: &mut [u64; BLOCK]) {
    let mut width = BLOCK / 2;
    let mut mask = u64::MAX >> width;
    while width != 0 {
        for start in (0..BLOCK).step_by(2 * width) {
            for row in start..start + width {
                let exchanged = (block[row] >> width ^ block[row + width]) & mask;
                block[row] ^= exchanged << width;
                block[row + width] ^= exchanged;
            }
        }
        width /= 2;
        mask ^= mask << width;
    }
}

/// Sets the bits `(y, x)` of `to` for the bits `(x, y)` of `from` in some columns and rows. Also
/// takes other bits of the blocks that these lie in. Costs the words of these blocks.
pub(super) fn add_transposed(from: &BitGrid, to: &mut BitGrid, columns: Range<u32>, rows: Range<u32>) {
    let blocks = |range: Range<u32>| range.start as usize / BLOCK..(range.end as usize).div_ceil(BLOCK);
    if columns.is_empty() || rows.is_empty() {
        return;
    }
    for block_y in blocks(rows) {
        for block_x in blocks(columns.clone()) {
            let mut block = [0; BLOCK];
            let mut any = 0;
            for (row, word) in block.iter_mut().enumerate() {
                *word = from.row((block_y * BLOCK + row) as u32).get(block_x).copied().unwrap_or(0);
                any |= *word;
            }
            if any == 0 {
                continue;
            }
            transpose_block(&mut block);
            for (row, word) in block.into_iter().enumerate().filter(|&(_, word)| word != 0) {
                to.row_mut((block_x * BLOCK + row) as u32)[block_y] |= word;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_changes_places() {
        for (width, height) in [(1, 1), (64, 64), (65, 3), (130, 70)] {
            let mut grid = BitGrid::new(width, height);
            for y in 0..height {
                for x in 0..width {
                    grid.set(x, y, (x * 7 + y * 13 + x * y) % 5 == 0);
                }
            }
            let mut turned = BitGrid::new(height, width);
            add_transposed(&grid, &mut turned, 0..width, 0..height);
            assert_eq!(turned.count(), grid.count());
            assert!(grid.cells().all(|(x, y)| turned.get(y, x)));
        }
    }
}
