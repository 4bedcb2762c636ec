//! Shapes in the plane.

pub(crate) mod block;
mod disc;
pub(crate) mod expansion;
pub(crate) mod polygon;
mod polyline;
mod rect;
mod segment;
mod shape;

pub use disc::{DISC_SIDES, Disc};
pub use polygon::ConvexPolygon;
pub use polyline::Polyline;
pub use rect::Rect;
pub use segment::Segment;
pub use shape::Shape;

use glam::DVec2;
use robust::{Coord, orient2d};

use crate::numeric::DIRECTION;

/// A point that lies away from an eye along a direction of length 1, to within 2^-40 radians. Its
/// coordinates are multiples of 2^-149 if the eye's are, as all numbers of single precision.
pub(crate) fn point_along(eye: DVec2, direction: DVec2) -> DVec2 {
    // A power of two: products with it are exact.
    let length = 2f64.powi(eye.abs().max_element().max(1.0).log2().ceil() as i32);
    eye + (direction / DIRECTION).round() * DIRECTION * length
}

/// The sign of the area of the triangle `a`, `b`, `c`: positive if it runs counterclockwise. Exact,
/// for all finite coordinates of single precision and for those of a grid.
#[inline]
pub(crate) fn orient(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}
