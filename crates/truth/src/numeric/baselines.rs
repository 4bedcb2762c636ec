//! Margins of the methods of engines. They are in single precision and not conservative, as those
//! methods are.

/// A box counts as nearer by this share, so that rounding does not hide it behind its own surface.
pub(crate) const BIAS: f32 = 1e-5;
/// The near plane of a projection that tells none, in metres.
pub(crate) const NEAR: f32 = 1e-3;
/// Larger than any coordinate in pixels that matters.
pub(crate) const BEYOND: f32 = 1e9;
/// Twice the area in pixels below which a triangle counts as seen edge-on.
pub(crate) const EDGE_ON: f32 = 1e-12;
