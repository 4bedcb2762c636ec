//! Hidden point removal by the convex hull of points that are turned inside out around the eye.
//!
//! Katz, Tal & Basri 2007, "Direct Visibility of Point Sets": a point at the distance `r` goes to
//! the distance `2 R - r` (spherical flipping).

use crate::hull::{MAX_POINTS, extreme_points};
use crate::numeric::{AT_EYE, power_of_two_for};
use bitvec::vec::BitVec;
use glam::DVec3;

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
}

/// A bit for each point: whether it is visible from the eye.
///
/// The sphere around the eye has the radius `R`, which is `10^log10_radius` times the largest
/// distance of a point from the eye; the logarithm is at least 0, and 2 to 3.5 are usual. A larger
/// one makes more points visible: fewer are falsely hidden in hollows, and more are falsely visible
/// through gaps between points. The best value depends on the distance between points.
///
/// A point is visible if its flipped image is an extreme point of the hull of all images and the
/// eye: not within the hull of the others. The answer is an estimate, and errs in both directions.
/// The hull is exact for the images, which themselves are rounded to doubles.
///
/// Points at the eye are visible, and hide nothing; so are points nearer than 10^-150 of the
/// largest distance. Points at the same place have the same bit. If the images and the eye are in
/// one plane, this is hidden point removal in the plane; if they are on one line, the nearest point
/// on each side is visible. For sure that is so along the axes of coordinates only: elsewhere
/// images are rounded off the line, and a point right behind another may be visible, too.
///
/// Costs the hull, `O(n log n)` on usual inputs, and about 155 bytes for each point.
///
/// # Errors
/// [`HprError`] names the point or the value at fault.
pub fn visible_points(points: &[DVec3], eye: DVec3, log10_radius: f64) -> Result<BitVec, HprError> {
    let count = points.len();
    if count >= MAX_POINTS {
        return Err(HprError::TooMany { count });
    }
    if !eye.is_finite() {
        return Err(HprError::EyeNotFinite);
    }
    if !(0.0..=300.0).contains(&log10_radius) {
        return Err(HprError::LogRadius { log10_radius });
    }
    let mut largest = 0.0_f64;
    for (index, &p) in points.iter().enumerate() {
        if !p.is_finite() {
            return Err(HprError::PointNotFinite { index });
        }
        let offset = p - eye;
        if !offset.is_finite() {
            return Err(HprError::TooFar { index });
        }
        largest = largest.max(offset.abs().max_element());
    }
    let (scale, radius) = (power_of_two_for(largest), 10_f64.powf(log10_radius));
    let farthest = points.iter().map(|&p| ((p - eye) * scale).length()).fold(0.0, f64::max);
    let flip_one = |&p: &DVec3| {
        let offset = (p - eye) * scale;
        let distance = offset.length();
        // All distances are 0 if all points are at the eye.
        let share = if farthest > 0.0 { distance / farthest } else { 0.0 };
        if share < AT_EYE { DVec3::ZERO } else { offset / distance * (1.0 - share / radius / 2.0) }
    };
    // The images are relative to the eye, all within a distance of 1.
    let flipped: Vec<DVec3> = points.iter().map(flip_one).chain([DVec3::ZERO]).collect();
    let mut visible = extreme_points(&flipped);
    visible.truncate(count);
    visible.iter_mut().zip(&flipped).for_each(|(mut visible, image)| *visible |= *image == DVec3::ZERO);
    Ok(visible)
}

#[cfg(test)]
mod tests;
