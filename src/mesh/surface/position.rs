//! Positions told apart by their bits.

use glam::Vec3;

/// A position as a key: equal positions, the zeros included, have equal keys.
pub(crate) fn key(p: Vec3) -> [u32; 3] {
    p.to_array().map(|c| (c + 0.0).to_bits())
}
