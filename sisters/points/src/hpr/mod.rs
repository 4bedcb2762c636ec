//! Hidden point removal by the convex hull of points that are turned inside out around the eye.
//!
//! Katz, Tal & Basri 2007, "Direct Visibility of Point Sets" (spherical flipping); Katz & Tal 2015,
//! "On the Visibility of Point Clouds" (the exponential kernel).

mod flip;
mod kernel;

pub use kernel::{HprError, Kernel};

use crate::hull::{HullError, MAX_POINTS, extreme_points};
use bitvec::vec::BitVec;
use glam::DVec3;

/// A bit for each point: whether it is visible from the eye.
///
/// A point is visible if its flipped image is an extreme point of the hull of all images and the
/// eye ([`extreme_points`] has the rules for flat and equal points). The answer is an estimate, and
/// errs in both directions. The hull is exact for the images, which themselves are rounded to
/// doubles.
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
