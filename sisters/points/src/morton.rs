//! The order of cells along a curve (Morton 1966).

/// The Morton code of a cell: the lower 21 bits of three numbers in turns, that of the first number
/// foremost. Codes of near cells are often near.
pub(crate) fn morton(at: [u32; 3]) -> u64 {
    // Each step moves the upper half of every group of bits away from the lower.
    let spread = |x: u32| {
        let x = u64::from(x) & 0x1f_ffff;
        let x = (x | x << 32) & 0x001f_0000_0000_ffff;
        let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
        let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
        let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
        (x | x << 2) & 0x1249_2492_4924_9249
    };
    at.into_iter().fold(0, |key, x| key << 1 | spread(x))
}
