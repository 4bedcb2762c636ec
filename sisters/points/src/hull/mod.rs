//! The extreme points of a convex hull: quickhull with exact predicates.
//!
//! Barber, Dobkin & Huhdanpaa 1996, "The Quickhull Algorithm for Convex Hulls". Their program
//! merges facets to live with rounding. Here every decision is exact, so that the hull stays
//! convex, and each step ends with one more point on it.

mod flat;
mod grow;
mod mesh;
mod order;
mod start;

use crate::numeric::{normalized, power_of_two_for};
use bitvec::vec::BitVec;
use glam::DVec3;
use start::Start;

/// Why there is no hull.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum HullError {
    /// A coordinate is infinite or not a number.
    #[error("point {index} has a coordinate that is not finite")]
    NotFinite {
        /// The first such point.
        index: usize,
    },
    /// Indices have 32 bits.
    #[error("{count} points are too many: at most {MAX_POINTS}")]
    TooMany {
        /// The number of points.
        count: usize,
    },
}

/// The largest number of points. Faces are counted with 32 bits, and a hull has up to two for each
/// point.
pub const MAX_POINTS: usize = 1 << 30;

/// A bit for each point: whether it is an extreme point of the convex hull of all.
///
/// A point is extreme if it is not within the hull of the points at other places. So a point in a
/// facet or on an edge of the hull is not extreme unless it is a corner. Points at the same place
/// have the same bit. Flat, collinear and equal points are no errors: they have the corners of
/// their polygon, the two ends, and all points.
///
/// The answer is exact for the given coordinates, except those below 2^-107 of the largest one:
/// these are rounded to multiples of 2^-160 of it. It takes `O(n log n)` on usual inputs, also on
/// those with facets and points of many edges, but more can be made up; and about 125 bytes for
/// each point.
///
/// # Errors
///
/// [`HullError`] for coordinates that are not finite, and for more than [`MAX_POINTS`].
pub fn extreme_points(points: &[DVec3]) -> Result<BitVec, HullError> {
    if points.len() > MAX_POINTS {
        return Err(HullError::TooMany { count: points.len() });
    }
    if let Some(index) = points.iter().position(|p| !p.is_finite()) {
        return Err(HullError::NotFinite { index });
    }
    let largest = points.iter().fold(0.0, |most: f64, p| most.max(p.abs().max_element()));
    let scale = power_of_two_for(largest);
    let order = order::by_place(points, scale);
    let points: Vec<DVec3> = order.iter().map(|&i| normalized(points[i as usize], scale)).collect();
    let extreme = match start::find(&points) {
        Start::Empty => BitVec::new(),
        Start::Place => BitVec::repeat(true, points.len()),
        Start::Line => flat::ends(&points),
        Start::Plane { axis } => flat::corners(&points, axis),
        Start::Solid(simplex) => grow::extreme(&points, simplex),
    };
    Ok(order::undone(&extreme, &order))
}

#[cfg(test)]
pub(crate) mod tests;
