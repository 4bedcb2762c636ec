//! Bit matrices O and H: one bit a cell, 64 cells a word, read as 8x8 tiles.

use crate::grid::bricks::{BRICK, Bricks, Pages};
use crate::grid::cell_box::CellBox;
use crate::grid::side::SideAxes;
use glam::IVec3;

/// Cells of a brick: word z is the slice z, with cell (x, y) at bit 8y+x.
pub(crate) type Mask = [u64; 8];

/// No cell of a brick, and all of them.
pub(crate) const NONE: Mask = [0; 8];
pub(crate) const ALL: Mask = [u64::MAX; 8];

/// The cells of one mask that are not in another.
pub(crate) fn without(a: &Mask, b: &Mask) -> Mask {
    std::array::from_fn(|z| a[z] & !b[z])
}

/// The cells of either mask.
pub(crate) fn either(a: &Mask, b: &Mask) -> Mask {
    std::array::from_fn(|z| a[z] | b[z])
}

/// The cells that two masks share.
pub(crate) fn both(a: &Mask, b: &Mask) -> Mask {
    std::array::from_fn(|z| a[z] & b[z])
}

/// The cells whose neighbour one up or down along an axis is in a mask, or in that of the next
/// brick there.
pub(crate) fn beside(mask: &Mask, next: &Mask, axis: usize, up: bool) -> Mask {
    // The columns x = 0 of all rows.
    const FIRST: u64 = 0x0101_0101_0101_0101;
    std::array::from_fn(|z| match (axis, up) {
        (0, true) => (mask[z] & !FIRST) >> 1 | (next[z] & FIRST) << 7,
        (0, false) => mask[z] << 1 & !FIRST | next[z] >> 7 & FIRST,
        (1, true) => mask[z] >> 8 | next[z] << 56,
        (1, false) => mask[z] << 8 | next[z] >> 56,
        (_, true) => *mask.get(z + 1).unwrap_or(&next[0]),
        (_, false) => {
            if z > 0 {
                mask[z - 1]
            } else {
                next[7]
            }
        }
    })
}

/// The cells of a brick that are in a mask.
pub(crate) fn cells_of(brick: IVec3, mask: &Mask) -> impl Iterator<Item = IVec3> + use<> {
    places_of(mask).map(move |i| {
        let i = i as i32;
        brick * BRICK + IVec3::new(i & 7, i >> 3 & 7, i >> 6)
    })
}

/// The places of a mask's cells in their brick: 64z + 8y + x.
pub(crate) fn places_of(mask: &Mask) -> impl Iterator<Item = usize> + use<> {
    let mask = *mask;
    (0..8).flat_map(move |z| {
        let mut rest = mask[z];
        std::iter::from_fn(move || {
            let bit = (rest != 0).then(|| rest.trailing_zeros() as usize)?;
            rest &= rest - 1;
            Some(64 * z + bit)
        })
    })
}

/// The cells of a brick inside the block from `lo` to `hi`, both included.
pub(crate) fn block_mask(brick: IVec3, lo: IVec3, hi: IVec3) -> Mask {
    let (lo, hi) = (lo - brick * BRICK, hi - brick * BRICK);
    let row = span8(lo.x, hi.x);
    let slice = (0..8).filter(|y| (lo.y..=hi.y).contains(y)).map(|y| row << (8 * y)).sum();
    std::array::from_fn(|z| if (lo.z..=hi.z).contains(&(z as i32)) { slice } else { 0 })
}

/// A sparse matrix of one bit per cell.
///
/// Memory follows the bricks (8x8x8 cells) with both set and clear cells: 64 bytes each. Bricks and
/// pages (64x64x64 cells) in which all cells are set share one, and empty ones take no memory but
/// the table of pages, one word each.
#[derive(Clone)]
pub struct BitMatrix {
    dims: IVec3,
    bricks: Bricks<Mask>,
}

/// O: cells wholly inside solid geometry (an underestimate).
pub type OpacityMatrix = BitMatrix;

/// H: cells hidden from the viewer (an underestimate).
pub type OcclusionMatrix = BitMatrix;

impl BitMatrix {
    /// All cells clear, for a grid of `dims` cells.
    pub fn new(dims: IVec3) -> Self {
        let dims = dims.max(IVec3::ONE);
        Self { dims, bricks: Bricks::with_full(dims, ALL) }
    }

    /// Whether the cell is set; cells outside the grid are not.
    pub fn get(&self, cell: IVec3) -> bool {
        if cell.cmplt(IVec3::ZERO).any() || cell.cmpge(self.dims).any() {
            return false;
        }
        self.bricks.get(cell >> 3i32)[(cell.z & 7) as usize] >> (((cell.y & 7) << 3) | (cell.x & 7)) & 1 != 0
    }

    /// Sets a cell; one outside the grid is ignored.
    pub fn set(&mut self, cell: IVec3) {
        if cell.cmpge(IVec3::ZERO).all() && cell.cmplt(self.dims).all() {
            self.set_run(cell.x, cell.x, cell.y, cell.z);
        }
    }

    /// Sets the cells from `x0` to `x1`, both included and inside the grid.
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

    /// Clears a cell inside the grid; the memory of an empty brick is freed.
    #[cfg(test)]
    pub(crate) fn clear_cell(&mut self, cell: IVec3) {
        self.clear_mask(cell >> 3i32, &block_mask(cell >> 3i32, cell, cell));
    }

    /// Sets cells of a brick that are inside the grid.
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

    /// Clears cells of a brick inside the grid; the memory of an empty brick is freed.
    pub(crate) fn clear_mask(&mut self, brick: IVec3, mask: &Mask) {
        let old = self.bricks.get(brick);
        let new = without(old, mask);
        if new == NONE {
            self.bricks.release(brick);
        } else if new != *old {
            *self.bricks.get_mut(brick) = new;
        }
    }

    /// The cells set in a brick inside the grid.
    #[inline]
    pub(crate) fn brick(&self, brick: IVec3) -> &Mask {
        self.bricks.get(brick)
    }

    /// The bricks with cells set.
    pub(crate) fn masks(&self) -> impl Iterator<Item = (IVec3, &Mask)> {
        self.bricks.iter()
    }

    /// Sets all cells of a page of 8x8x8 bricks that is inside the grid.
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
    pub(crate) fn pages(&self) -> &impl Pages {
        &self.bricks
    }

    /// Whether all cells from `lo` to `hi`, both included and inside the grid, are set.
    pub(crate) fn holds_block(&self, lo: IVec3, hi: IVec3) -> bool {
        CellBox { lo: lo >> 3i32, hi: hi >> 3i32 }
            .cells()
            .all(|b| without(&block_mask(b, lo, hi), self.bricks.get(b)) == NONE)
    }

    /// Clears every cell. Its cost is that of the table of pages.
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
        self.dims == other.dims
            && self
                .bricks
                .iter()
                .all(|(at, brick)| brick.iter().zip(other.bricks.get(at)).all(|(a, b)| a & !b == 0))
    }

    /// Cells along each axis.
    pub fn dims(&self) -> IVec3 {
        self.dims
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

/// The bits `lo..=hi` of a byte; bounds outside 0..8 are cut off.
#[inline]
pub(crate) fn span8(lo: i32, hi: i32) -> u64 {
    let (lo, hi) = (lo.max(0), hi.min(7));
    if lo > hi { 0 } else { (0xff >> (7 - hi)) & (0xff << lo) & 0xff }
}

/// Reads a tile out of a brick whose word z is slice z (bit 8y+x).
#[inline]
pub(crate) fn tile_of(brick: &Mask, axes: &SideAxes, at: i32) -> u64 {
    let at = (at & 7) as u32;
    match axes.normal {
        2 => brick[at as usize],
        1 => {
            let mut tile = 0;
            for (z, &word) in brick.iter().enumerate() {
                tile |= (word >> (8 * at) & 0xff) << (8 * z);
            }
            tile
        }
        _ => {
            let mut tile = 0;
            for (z, &word) in brick.iter().enumerate() {
                // Gathers bit 0 of each byte into one byte, lowest first.
                let column = (word >> at & 0x0101_0101_0101_0101).wrapping_mul(0x0102_0408_1020_4080) >> 56;
                tile |= column << (8 * z);
            }
            tile
        }
    }
}

impl std::fmt::Debug for BitMatrix {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "BitMatrix({} of {} cells)", self.count(), self.dims())
    }
}

#[cfg(test)]
mod tests;
