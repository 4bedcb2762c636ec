//! All shapes as one type.

use glam::DVec2;

use crate::error::{Error, finite2, within};
use crate::geometry::polygon::ring;
use crate::geometry::{Block, ConvexPolygon, DISC_SIDES, Disc, Polyline, Rect, Segment, orient};
use crate::numeric::ON_DISC;

/// A shape of an object: its bounds, or its occluder.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// A solid disc.
    Disc(Disc),
    /// A solid rectangle along the axes.
    Rect(Rect),
    /// A solid convex polygon.
    Polygon(ConvexPolygon),
    /// A wall without thickness.
    Segment(Segment),
    /// A chain of walls without thickness.
    Polyline(Polyline),
}

macro_rules! from {
    ($($shape:ident: $variant:ident),*) => {$(
        impl From<$shape> for Shape {
            fn from(shape: $shape) -> Self {
                Self::$variant(shape)
            }
        }
    )*};
}

from!(Disc: Disc, Rect: Rect, ConvexPolygon: Polygon, Segment: Segment, Polyline: Polyline);

impl Shape {
    /// Refuses shapes that are not finite, inverted or of negative size.
    pub(crate) fn check(&self, what: &'static str) -> Result<(), Error> {
        match self {
            Self::Disc(disc) => {
                finite2(what, disc.center)?;
                within("the radius", disc.radius.into(), [0.0, f32::MAX.into()]).map(drop)
            }
            Self::Rect(rect) => rect.check(what),
            Self::Segment(s) => [s.a, s.b].into_iter().try_for_each(|p| finite2(what, p)),
            // Checked when they were made.
            Self::Polygon(_) | Self::Polyline(_) => Ok(()),
        }
    }

    /// The rectangle around it, in world units, rounded to single precision.
    pub fn bounds(&self) -> Rect {
        let Block { min, max } = self.block();
        Rect::new(min.as_vec2(), max.as_vec2())
    }

    /// The rectangle around it.
    pub(crate) fn block(&self) -> Block {
        match self {
            Self::Disc(disc) => {
                let (center, radius) = (disc.center.as_dvec2(), DVec2::splat(disc.radius.into()));
                Block { min: (center - radius).map(f64::next_down), max: (center + radius).map(f64::next_up) }
            }
            Self::Rect(rect) => rect.block(),
            Self::Polygon(polygon) => Block::around(polygon.corners()),
            Self::Segment(s) => Block::around(&[s.a, s.b]),
            Self::Polyline(line) => Block::around(line.points()),
        }
    }

    /// How many sides it has.
    pub(crate) fn sides(&self) -> usize {
        match self {
            Self::Disc(_) => DISC_SIDES,
            Self::Rect(_) => 4,
            Self::Polygon(polygon) => polygon.corners().len(),
            Self::Segment(_) => 1,
            Self::Polyline(polyline) => polyline.points().len() - 1,
        }
    }

    /// Whether a point belongs to the shape, the border included. Exact but for discs: there in
    /// doubt, yes.
    pub(crate) fn contains(&self, p: DVec2) -> bool {
        let is_on = |s: Segment| {
            Block::around(&[s.a, s.b]).contains(p) && orient(s.a.as_dvec2(), s.b.as_dvec2(), p) == 0.0
        };
        match self {
            Self::Disc(disc) => {
                (p - disc.center.as_dvec2()).length() * (1.0 - ON_DISC) <= f64::from(disc.radius)
            }
            Self::Rect(rect) => rect.block().contains(p),
            Self::Polygon(polygon) => ring(polygon.corners()).all(|(a, b)| orient(a, b, p) >= 0.0),
            Self::Segment(s) => is_on(*s),
            Self::Polyline(line) => line.segments().any(is_on),
        }
    }

    /// Whether a point lies inside a solid, and not on its border; in doubt, yes. Walls without
    /// thickness have no inside.
    pub(crate) fn surrounds(&self, p: DVec2) -> bool {
        match self {
            Self::Disc(_) => self.contains(p),
            Self::Rect(Rect { min, max }) => p.cmpgt(min.as_dvec2()).all() && p.cmplt(max.as_dvec2()).all(),
            Self::Polygon(polygon) => ring(polygon.corners()).all(|(a, b)| orient(a, b, p) > 0.0),
            Self::Segment(_) | Self::Polyline(_) => false,
        }
    }

    /// The sides that turn to an eye outside, all of a wall's. The sides of a disc are those of its
    /// [polygon](Disc::polygon). No ray from the eye reaches a point of the shape (of the polygon)
    /// before one of these sides.
    pub(crate) fn front_sides(&self, eye: DVec2, mut side: impl FnMut(DVec2, DVec2)) {
        match self {
            Self::Disc(disc) => turned_to(ring(&disc.polygon()), eye, side),
            Self::Rect(rect) => front_of_block(&rect.block(), eye, side),
            Self::Polygon(polygon) => turned_to(ring(polygon.corners()), eye, side),
            Self::Segment(s) => side(s.a.as_dvec2(), s.b.as_dvec2()),
            Self::Polyline(line) => line.segments().for_each(|s| side(s.a.as_dvec2(), s.b.as_dvec2())),
        }
    }
}

/// The sides of a ring that have the eye on their outer side.
fn turned_to(sides: impl Iterator<Item = (DVec2, DVec2)>, eye: DVec2, mut side: impl FnMut(DVec2, DVec2)) {
    sides.filter(|&(a, b)| orient(a, b, eye) < 0.0).for_each(|(a, b)| side(a, b));
}

/// The sides of a rectangle that have the eye on their outer side: two at most.
fn front_of_block(block: &Block, eye: DVec2, mut side: impl FnMut(DVec2, DVec2)) {
    let Block { min, max } = *block;
    let (right, left) = (DVec2::new(max.x, min.y), DVec2::new(min.x, max.y));
    if eye.y < min.y {
        side(min, right);
    }
    if eye.x > max.x {
        side(right, max);
    }
    if eye.y > max.y {
        side(max, left);
    }
    if eye.x < min.x {
        side(left, min);
    }
}
