//! Shapes in the plane.

pub(crate) mod block;
mod disc;
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

/// The sign of the area of the triangle `a`, `b`, `c`: positive if it runs counterclockwise. Exact, for all finite coordinates of
/// single precision and for those of a grid.
#[inline]
pub(crate) fn orient(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}
