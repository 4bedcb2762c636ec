//! Eyes on the ball of a reach.

use crate::numeric::attack::LAST_PLACE;
use glam::DVec3;

/// The eye that is as far as may be from another, in a direction.
pub fn outermost(eye: DVec3, way: DVec3, reach: f64) -> DVec3 {
    // Rounding may take it out by a little: some units in the last place are taken off, then more
    // and more.
    let shares =
        std::iter::once(1.0).chain((0..50).map(|i| 1.0 - LAST_PLACE * f64::from(1 << (i / 2)).powi(2)));
    let places = shares.map(|share| eye + way * (reach * share));
    places.into_iter().find(|at| (*at - eye).length() <= reach).unwrap_or(eye)
}
