//! A bit for each cell, stored by rows and by columns.

use glam::UVec2;

use crate::bits::BitGrid;

/// A bit for each cell, stored twice: the sides of a shell are rows and columns, and each is read
/// as packed words.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct CrossBits {
    /// `lines[0]` has the columns of the grid: the cells of equal x. `lines[1]` has its rows.
    lines: [BitGrid; 2],
}

impl CrossBits {
    /// Clear bits. Costs two bits a cell.
    pub(crate) fn new(dims: UVec2) -> Self {
        Self { lines: [BitGrid::new(dims.y, dims.x), BitGrid::new(dims.x, dims.y)] }
    }

    /// Cells outside of the grid stay clear.
    pub(crate) fn set(&mut self, x: u32, y: u32, value: bool) {
        self.lines[0].set(y, x, value);
        self.lines[1].set(x, y, value);
    }

    /// The cells at one place of an axis: the column at an x for axis 0, the row at a y for axis 1.
    pub(crate) fn line(&self, axis: usize, at: u32) -> &[u64] {
        self.lines[axis].row(at)
    }
}
