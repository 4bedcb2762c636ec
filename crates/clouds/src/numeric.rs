//! The margins and factors of the crate, each with its reason.

use glam::DVec3;

/// Origins of clouds are multiples of it, in units of the cloud: a small cloud near zero keeps the origin zero, and sums of an origin below
/// 2^39 and a position are exact in double precision. Positions up to it from the origin resolve to 6e-5 units in single precision.
const ORIGIN_STEP: f64 = 1024.0;

/// The multiple of 1,024 in each coordinate nearest to a point, or zero: no survey goes beyond 2^39 units, so such a point is an error, and
/// positions relative to it would lose all others.
pub(crate) fn origin_near(point: DVec3) -> DVec3 {
    let near = (point / ORIGIN_STEP).round() * ORIGIN_STEP;
    if near.abs().max_element() <= 549_755_813_888.0 { near } else { DVec3::ZERO }
}

/// The half side of squares over the spacing of points, for points spread at random. Of 0.3, 0.6 and 1 it had the fewest errors in streets.
pub(crate) const SQUARE_OF_SPACING: f32 = 0.6;
