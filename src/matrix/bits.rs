//! Bit matrices O and H: one bit a cell, 64 cells a word, read as 8x8 tiles.

use glam::IVec3;

use crate::grid::bricks::{Bricks, Pages};
use crate::grid::mask::{ALL, BRICK, Mask, NONE, span8, tile_of, without};
use crate::grid::reaches;
use crate::grid::side::SideAxes;

/// A sparse matrix of one bit per cell.
///
/// Memory follows the bricks (8x8x8 cells) with both set and clear cells: 64 bytes each. Bricks and
/// pages (64x64x64 cells) in which all cells are set share one, and empty ones take no memory.
#[derive(Clone)]
pub struct BitMatrix {
    bricks: Bricks<Mask>,
}

/// O: cells wholly inside solid geometry (an underestimate).
pub type OpacityMatrix = BitMatrix;

/// H: cells hidden from the viewer (an underestimate).
pub type OcclusionMatrix = BitMatrix;

impl Default for BitMatrix {
    /// All cells clear.
    fn default() -> Self {
        Self { bricks: Bricks::with_full(ALL) }
    }
}

impl BitMatrix {
    /// Whether the cell is set.
    pub fn get(&self, cell: IVec3) -> bool {
        self.bricks.get(cell >> 3i32)[(cell.z & 7) as usize] >> (((cell.y & 7) << 3) | (cell.x & 7)) & 1 != 0
    }

    /// Sets a cell; one farther than 2^20 cells from cell 0 is ignored.
    pub fn set(&mut self, cell: IVec3) {
        if reaches(cell) {
            self.set_run(cell.x, cell.x, cell.y, cell.z);
        }
    }

    /// Sets the cells from `x0` to `x1`, both included.
    pub(crate) fn set_run(&mut self, x0: i32, x1: i32, y: i32, z: i32) {
        for bx in x0 >> 3..=x1 >> 3 {
            let (at, z) = (IVec3::new(bx, y >> 3, z >> 3), (z & 7) as usize);
            let bits = span8(x0 - bx * BRICK, x1 - bx * BRICK) << ((y & 7) << 3);
            if self.bricks.get(at)[z] & bits == bits {
                continue;
            }
            let brick = self.bricks.get_mut(at);
            brick[z] |= bits;
            if brick[z] == u64::MAX && *brick == ALL {
                self.bricks.fill(at);
            }
        }
    }

    /// Clears a cell; the memory of an empty brick is freed.
    #[cfg(test)]
    pub(crate) fn clear_cell(&mut self, cell: IVec3) {
        self.clear_mask(cell >> 3i32, &crate::grid::mask::block_mask(cell >> 3i32, cell, cell));
    }

    /// Sets cells of a brick.
    pub(crate) fn set_mask(&mut self, brick: IVec3, mask: &Mask) {
        let old = self.bricks.get(brick);
        if without(mask, old) == NONE {
            return;
        }
        let new: Mask = std::array::from_fn(|z| old[z] | mask[z]);
        if new == ALL {
            self.bricks.fill(brick);
        } else {
            *self.bricks.get_mut(brick) = new;
        }
    }

    /// Clears cells of a brick; the memory of an empty brick is freed.
    pub(crate) fn clear_mask(&mut self, brick: IVec3, mask: &Mask) {
        let old = self.bricks.get(brick);
        let new = without(old, mask);
        if new == NONE {
            self.bricks.release(brick);
        } else if new != *old {
            *self.bricks.get_mut(brick) = new;
        }
    }

    /// The cells set in a brick.
    #[inline]
    pub(crate) fn brick(&self, brick: IVec3) -> &Mask {
        self.bricks.get(brick)
    }

    /// The bricks with cells set.
    pub(crate) fn masks(&self) -> impl Iterator<Item = (IVec3, &Mask)> {
        self.bricks.iter()
    }

    /// Sets all cells of a page of 8x8x8 bricks.
    pub(crate) fn fill_page(&mut self, page: IVec3) {
        self.bricks.fill_page(page);
    }

    /// Clears all cells of a page.
    pub(crate) fn clear_page(&mut self, page: IVec3) {
        self.bricks.release_page(page);
    }

    /// Whether a page was filled at once and nothing of it was cleared since.
    pub(crate) fn page_is_full(&self, page: IVec3) -> bool {
        self.bricks.page_is_full(page)
    }

    /// The pages that contain cells.
    pub(crate) fn pages(&self) -> &Pages {
        self.bricks.pages()
    }

    /// Clears every cell.
    pub fn clear(&mut self) {
        self.bricks.clear();
    }

    /// Number of cells set.
    pub fn count(&self) -> u64 {
        self.bricks.iter().flat_map(|(_, b)| b).map(|w| u64::from(w.count_ones())).sum()
    }

    /// All cells set, brick by brick.
    pub fn iter(&self) -> impl Iterator<Item = IVec3> {
        self.bricks.iter().flat_map(|(corner, brick)| {
            (0..512)
                .filter(move |i| brick[(i >> 6) as usize] >> (i & 63) & 1 != 0)
                .map(move |i: i32| corner * BRICK + IVec3::new(i & 7, i >> 3 & 7, i >> 6))
        })
    }

    /// Whether every cell set here is set in `other` too.
    pub fn is_subset(&self, other: &Self) -> bool {
        self.bricks.iter().all(|(at, brick)| without(brick, other.bricks.get(at)) == NONE)
    }

    /// Bytes of memory that the matrix uses.
    pub fn bytes(&self) -> usize {
        self.bricks.bytes()
    }

    /// The 8x8 tile of the brick's cells with coordinate `at` along the axis
    /// of the side: bit 8 * row + column (see [`SideAxes`]).
    #[inline]
    pub(crate) fn tile(&self, brick: IVec3, axes: &SideAxes, at: i32) -> u64 {
        tile_of(self.bricks.get(brick), axes, at)
    }
}

impl std::fmt::Debug for BitMatrix {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "BitMatrix({} cells)", self.count())
    }
}

#[cfg(test)]
mod tests;
