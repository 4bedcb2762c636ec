//! Which tiles of a map block sight.

use crate::bits::BitGrid;
use crate::tiles::transpose::add_transposed;

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
