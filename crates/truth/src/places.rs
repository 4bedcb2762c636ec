//! Coordinates for random tests: half of them lie on a small lattice, half anywhere. In a
//! continuum nothing is ever equal; on a lattice faces touch, eyes lie on planes and corners, and
//! boxes have no height.

use std::ops::Range;

use glam::DVec3;

/// What lies in a plane is looked at from this far to either side, where coordinates are small.
const ASIDE: f64 = 1e-11;

/// Places on the border of a box are moved into it, by this share of the way to its middle.
const INSIDE: f64 = 1e-6;

/// A coordinate of a range, by a random share from 0 to less than 1: a multiple of `step` above the
/// start of the range (up to its end) where the share is less than a half, any number elsewhere.
/// The lattice is small if the range has few steps.
pub fn coordinate(share: f64, range: Range<f32>, step: f32) -> f32 {
    let twice = 2.0 * share.clamp(0.0, 1.0);
    if twice < 1.0 {
        let steps = ((range.end - range.start) / step).floor().max(0.0);
        // Both ends belong to the lattice.
        let at = (twice * f64::from(steps + 1.0)).floor() as f32;
        range.start + at.min(steps) * step
    } else {
        range.start + (range.end - range.start) * (twice - 1.0) as f32
    }
}

/// A place in a box, by random shares from 0 to less than 1: often next to a corner, an edge or a
/// side, just inside of it. Along an axis in which the box is flat, the place is on either side: an
/// eye on the face of a wall looks from both.
pub fn place_in(min: DVec3, max: DVec3, mut share: impl FnMut() -> f64) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|i| {
        if min[i] == max[i] {
            return min[i] + if share() < 0.5 { ASIDE } else { -ASIDE };
        }
        let at = f64::from(coordinate(share(), 0.0..1.0, 0.5));
        min[i] + (at + (0.5 - at) * INSIDE) * (max[i] - min[i])
    }))
}

/// A coordinate that came about otherwise: rounded to a multiple of `step` where a random share
/// from 0 to less than 1 is less than a half.
pub fn settled(share: f64, at: f32, step: f32) -> f32 {
    if share < 0.5 { (at / step).round() * step } else { at }
}

#[cfg(feature = "proptest")]
mod strategies {
    use super::{Range, coordinate};
    use glam::Vec3;
    use proptest::prelude::Strategy;

    /// Coordinates of property tests, as [`coordinate`] has them. They shrink to the lattice.
    pub fn coordinates(range: Range<f32>, step: f32) -> impl Strategy<Value = f32> + Clone {
        (0.0..1.0f64).prop_map(move |share| coordinate(share, range.clone(), step))
    }

    /// Places of property tests, and sizes along the axes: each coordinate is on the lattice or not
    /// by itself.
    pub fn points(range: Range<f32>, step: f32) -> impl Strategy<Value = Vec3> + Clone {
        proptest::array::uniform3(coordinates(range, step)).prop_map(Vec3::from_array)
    }
}

#[cfg(feature = "proptest")]
pub use strategies::{coordinates, points};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_all_coordinates_are_on_the_lattice() {
        let all: Vec<f32> = (0..1000).map(|i| coordinate(f64::from(i) / 1000.0, -2.0..2.0, 0.5)).collect();
        let on_lattice = |v: &&f32| (**v * 2.0).fract() == 0.0;
        assert!(all.iter().filter(on_lattice).count().abs_diff(500) < 10);
        for step in 0..=8 {
            assert!(all.contains(&(step as f32 * 0.5 - 2.0)), "{step}");
        }
        assert!(all.iter().all(|v| (-2.0..=2.0).contains(v)));
        assert_eq!((settled(0.4, 1.7, 0.5), settled(0.5, 1.7, 0.5)), (1.5, 1.7));
        assert_eq!((coordinate(0.3, 0.0..1.0, 5.0), coordinate(1.0, 0.0..1.0, 0.5)), (0.0, 1.0));
    }
}
