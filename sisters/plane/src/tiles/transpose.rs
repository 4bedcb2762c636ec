//! Grids of bits with rows and columns exchanged: blocks of 64 by 64 bits, each by exchanging ever
//! smaller quarters (Warren, Hacker's Delight, section 7-3).

use std::ops::Range;

use crate::bits::BitGrid;

/// The width of a block.
const BLOCK: usize = u64::BITS as usize;

/// Exchanges the rows and columns of a block.
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
