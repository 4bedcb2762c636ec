//! Shapes in the plane.

mod disc;
pub(crate) mod expansion;
pub(crate) mod polygon;
mod shape;

pub use disc::{DISC_SIDES, Disc};
pub use polygon::{ConvexPolygon, Polyline};
pub use shape::Shape;

use glam::{DVec2, Vec2};
use robust::{Coord, orient2d};

use crate::error::{Error, finite2};
use crate::numeric::DIRECTION;

/// A point that lies away from an eye along a direction of length 1, to within 2^-40 radians. Its
/// coordinates are multiples of 2^-149 if the eye's are, as all numbers of single precision.
pub(crate) fn point_along(eye: DVec2, direction: DVec2) -> DVec2 {
    // The next power of two, of which all digits are zero: products with it are exact.
    const DIGITS: u64 = (1 << (f64::MANTISSA_DIGITS - 1)) - 1;
    let length = f64::from_bits((eye.abs().max_element().max(1.0).to_bits() + DIGITS) & !DIGITS);
    eye + (direction / DIRECTION).round() * DIRECTION * length
}

/// The sign of the area of the triangle `a`, `b`, `c`: positive if it runs counterclockwise. Exact,
/// for all finite coordinates of single precision and for those of a grid.
#[inline]
pub(crate) fn orient(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// A closed rectangle along the axes; empty if inverted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Block {
    pub(crate) min: DVec2,
    pub(crate) max: DVec2,
}

impl Block {
    /// The block that contains nothing.
    pub(crate) const EMPTY: Self = Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };

    /// The least block around some points.
    pub(crate) fn around(points: &[Vec2]) -> Self {
        points.iter().fold(Self::EMPTY, |block, p| block.with(p.as_dvec2()))
    }

    /// The least block around this one and a point.
    pub(crate) fn with(self, p: DVec2) -> Self {
        Self { min: self.min.min(p), max: self.max.max(p) }
    }

    /// Whether a point lies inside or on the border.
    pub(crate) fn contains(&self, p: DVec2) -> bool {
        p.cmpge(self.min).all() && p.cmple(self.max).all()
    }
}

/// A solid rectangle along the axes. It may have no width or no height: then it is a wall without
/// thickness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rect {
    /// Least corner in world units.
    pub min: Vec2,
    /// Greatest corner in world units.
    pub max: Vec2,
}

impl Rect {
    /// The rectangle between two corners, the least and the greatest.
    pub const fn new(min: Vec2, max: Vec2) -> Self {
        Self { min, max }
    }

    pub(crate) fn check(&self, what: &'static str) -> Result<(), Error> {
        finite2(what, self.min)?;
        finite2(what, self.max)?;
        if self.min.cmpgt(self.max).any() {
            return Err(Error::InvertedRect { what, min: self.min, max: self.max });
        }
        Ok(())
    }

    /// Its corners, counterclockwise from the least.
    pub fn corners(&self) -> [Vec2; 4] {
        let Self { min, max } = *self;
        [min, Vec2::new(max.x, min.y), max, Vec2::new(min.x, max.y)]
    }

    pub(crate) fn block(&self) -> Block {
        Block { min: self.min.as_dvec2(), max: self.max.as_dvec2() }
    }
}

/// A line segment between two points: a wall without thickness. The points may be the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// One end in world units.
    pub a: Vec2,
    /// The other end in world units.
    pub b: Vec2,
}

impl Segment {
    /// The segment from `a` to `b`.
    pub const fn new(a: Vec2, b: Vec2) -> Self {
        Self { a, b }
    }
}
