//! The cells of a brick, or the bricks of a page, as bits.

use glam::IVec3;

use crate::grid::side::SideAxes;

/// Edge length of a brick in cells, and of a page in bricks.
pub(crate) const BRICK: i32 = 8;

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
