//! Rounding margins and limits of numbers: every one of them, with its name and the reason why it suffices.

/// Field of view on tiles.
///
/// Positions are whole numbers of `2^-TILE_BITS` of a tile, and the sweep only adds and compares them: it rounds nothing.
pub(crate) mod tiles {
    /// Bits of a tile: a position is a multiple of `2^-28` of a tile.
    ///
    /// That holds single precision (24 bits) exactly from 1/16 of a tile on.
    pub(crate) const TILE_BITS: u32 = 28;

    /// A tile, in units of positions.
    pub(crate) const TILE: i64 = 1 << TILE_BITS;

    /// Positions have no coordinate beyond this many tiles. Grids have at most `2^32` rows or columns, so that differences
    /// stay below `2^61` units, and sums of two of them fit into 64 bits.
    pub(crate) const FARTHEST: f64 = (1u64 << 32) as f64;

    /// The length of the whole numbers that the two directions of a sector are rounded to. Denominators of slopes are this times
    /// [`TILE`], at most `2^58`.
    pub(crate) const DIRECTION: f64 = (1u64 << 30) as f64;

    /// A sector is wider than asked for by this angle at each side, in radians. Rounding to whole numbers turns its directions by
    /// up to `2^-30.5`; angles in double precision err by far less.
    pub(crate) const SECTOR: f64 = 1.0 / (1u64 << 29) as f64;
}
