//! Hidden point removal by the convex hull of points that are turned inside out around the eye.
//!
//! Katz, Tal & Basri 2007, "Direct Visibility of Point Sets" (spherical flipping); Katz & Tal 2015, "On the Visibility of Point
//! Clouds" (the exponential kernel).

mod flip;

use crate::hull::{HullError, MAX_POINTS, extreme_points};
use bitvec::vec::BitVec;
use glam::DVec3;

/// The function that turns near points into far ones.
///
/// A larger radius, or a gamma nearer to 0, makes more points visible: fewer are falsely hidden in hollows, and more are falsely
/// visible through gaps between points. The best value depends on the distance between points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kernel {
    /// A point at distance `r` goes to the distance `2 R - r`, where `R` is `10^log10_radius` times the largest distance of a point
    /// from the eye. The value is at least 0; 2 to 3.5 are usual.
    Relative {
        /// The decimal logarithm of the radius, as a multiple of the largest distance.
        log10_radius: f64,
    },
    /// The same with `R` in units of the points' coordinates. It must not be less than the largest distance.
    Absolute {
        /// The radius of the sphere around the eye in which all points lie.
        radius: f64,
    },
    /// A point at distance `r` goes to the distance `r^gamma`. Gamma is below 0; -0.001 is usual.
    Exponential {
        /// The exponent.
        gamma: f64,
    },
}

/// Why points have no answer.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HprError {
    /// A coordinate is infinite or not a number.
    #[error("point {index} has a coordinate that is not finite")]
    PointNotFinite {
        /// The first such point.
        index: usize,
    },
    /// A coordinate of the eye is infinite or not a number.
    #[error("the eye has a coordinate that is not finite")]
    EyeNotFinite,
    /// The difference of a point and the eye is more than a double can hold.
    #[error("point {index} is too far from the eye")]
    TooFar {
        /// The first such point.
        index: usize,
    },
    /// There are more points than indices.
    #[error("{count} points are too many: at most {}", MAX_POINTS - 1)]
    TooMany {
        /// The number of points.
        count: usize,
    },
    /// A logarithm below 0 or above 300, or not a number.
    #[error("log10_radius is {log10_radius}, and must be from 0 to 300")]
    LogRadius {
        /// The given value.
        log10_radius: f64,
    },
    /// A radius that is not finite, or less than the largest distance of a point.
    #[error(
        "the radius is {radius}, and must be finite and at least {farthest}, the largest distance of a point from the eye"
    )]
    Radius {
        /// The given value.
        radius: f64,
        /// The largest distance of a point from the eye.
        farthest: f64,
    },
    /// An exponent that is not below 0, or not finite.
    #[error("gamma is {gamma}, and must be finite and below 0")]
    Gamma {
        /// The given value.
        gamma: f64,
    },
}

/// A bit for each point: whether it is visible from the eye.
///
/// A point is visible if its flipped image is an extreme point of the hull of all images and the eye
/// ([`extreme_points`] has the rules for flat and equal points). The answer is an estimate, and errs in both directions. The hull
/// is exact for the images, which themselves are rounded to doubles.
///
/// Points at the eye are visible, and hide nothing; so are points nearer than 10^-150 of the largest distance. Points at
/// the same place have the same bit. If points and eye are in one plane, this is hidden point removal in the plane; if they are on
/// one line, the nearest point on each side is visible.
///
/// Costs the hull, `O(n log n)` on usual inputs, and about 150 bytes for each point.
///
/// # Errors
///
/// [`HprError`] names the point or the value at fault.
pub fn visible_points(points: &[DVec3], eye: DVec3, kernel: Kernel) -> Result<BitVec, HprError> {
    let count = points.len();
    if count >= MAX_POINTS {
        return Err(HprError::TooMany { count });
    }
    let mut flipped = flip::flip(points, eye, kernel)?;
    flipped.push(DVec3::ZERO);
    let mut visible = extreme_points(&flipped).map_err(|error| match error {
        HullError::NotFinite { index } => HprError::TooFar { index },
        HullError::TooMany { .. } => HprError::TooMany { count },
    })?;
    visible.truncate(count);
    // The images of points at the eye are at the eye.
    for (index, _) in flipped[..count].iter().enumerate().filter(|(_, p)| **p == DVec3::ZERO) {
        visible.set(index, true);
    }
    Ok(visible)
}

#[cfg(test)]
mod tests;
