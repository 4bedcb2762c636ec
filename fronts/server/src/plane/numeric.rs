//! Margins and limits of maps.

/// Maps are at most so wide and high, in tiles: beyond, single precision tells places in a tile
/// apart by a sixteenth of it.
pub(crate) const WIDEST: u32 = 1 << 20;

/// Reaches are longer by this, in tiles: sums of double precision on the widest map are off by
/// less than 2^-30, and positions of casca-plane are rounded to 2^-28.
pub(crate) const MARGIN: f64 = 1e-6;
