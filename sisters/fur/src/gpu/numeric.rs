//! Constants of the pictures, each with its reason.

/// Tubes of a strand of the reference, each a part of a cone: a bent strand leaves the chord of a
/// 32nd by less than 1/1000 of its height.
pub(crate) const TUBES: u32 = 32;

/// Boxes of the reference's hierarchy are wider by this share of their coordinates, and hits count
/// as so much farther, so that rays in single precision lose nothing.
pub(crate) const WIDER: f64 = 4e-6;

/// The highlight of bald skin, for the reference; the same as in the shader. Eyes and noses look
/// dull without one.
pub(crate) const WET: f32 = 0.7;
/// How narrow that highlight is.
pub(crate) const WET_EXPONENT: f32 = 140.0;
