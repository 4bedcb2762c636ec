//! Margins of the scene and of the answers derived from its results: expiry times, extents across a
//! light.
//!
//! A margin in units in the last place (ulp) is relative: one ulp of a double is at most 2.3e-16 of
//! its value.

/// The rectangle across a directional light is widened by this share of the greatest coordinate in
/// it, 4,500 units in the last place (ulp) of that, and so is the range of a point light.
///
/// It covers the transform into the frame of the light: a scalar product with an axis errs by less
/// than 16 ulp of the greatest coordinate, and the axes are of length 1 and at right angles to as
/// much, so that two points of one ray seem to lie beside each other by a few ulp of the greater
/// coordinate of both; those of the farther point are in the margin with which the view tests
/// bounds. It covers a distance from a point light, too. The factor of about 200 that is left is
/// not needed; it costs nothing, since a pixel of the buffers is far wider.
pub(crate) const LIGHT_EXTENT: f64 = 1e-12;

/// The time before which an object that is somewhere `now` has not moved by a distance: seconds
/// from world units and world units per second. Infinity for an object that does not move.
///
/// The distance, the quotient and the sum are each rounded by at most half an ulp, and each result
/// is taken down by one, so that rounding promises no more time than the distance gives.
pub(crate) fn earliest_arrival(now: f64, distance: f64, speed: f64) -> f64 {
    if speed > 0.0 {
        (now + (distance.next_down().max(0.0) / speed).next_down().max(0.0)).next_down()
    } else {
        f64::INFINITY
    }
}

/// The box of a sphere in single precision is larger on all sides by this share of the greatest
/// coordinate of the centre and the radius together, and by [`f32::MIN_POSITIVE`].
///
/// Centre less radius is rounded by at most half a unit in the last place (ulp), which is at most
/// 2^-24 of that, and the next sum by as much again; the box in double precision is larger than the
/// sphere by 4e-15 of it ([`crate::numeric::shape::DISTANCE`]). Twice the sum of these is left. Of
/// numbers that are so small that the share vanishes, sums are exact.
pub(crate) const BOX_OF_SPHERE: f32 = 1.0 / (1 << 22) as f32;

/// Solids that fill a cell have boxes whose common parts with it make up this share of its volume
/// at least: all of it, less the roundings of the parts and of their sum (300 units in the last
/// place, 1e-13). A cell that is wrongly found not filled only hides less.
pub(crate) const FILLED: f64 = 1.0 - 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_arrives_before_its_time() {
        for (now, distance, speed) in
            [(0.0, 1.0, 3.0), (1e6, 0.1, 0.7), (-5.0, 1e-300, 1e-9), (7.0, 2.0, 1e-3)]
        {
            let at = earliest_arrival(now, distance, speed);
            assert!(at < now + distance / speed, "{now} {distance} {speed}");
            assert!((at - now) * speed <= distance, "{now} {distance} {speed}");
        }
        assert!(earliest_arrival(3.0, -1.0, 1.0) < 3.0, "outside its volume it is due at once");
        assert!(earliest_arrival(3.0, f64::NAN, 1.0) <= 3.0);
        assert_eq!(earliest_arrival(3.0, 1.0, 0.0), f64::INFINITY);
    }
}
