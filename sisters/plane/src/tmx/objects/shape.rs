//! The forms of objects.

use glam::{DMat2, DVec2, Vec2};

use super::fault::TmxFault;
use crate::error::Error;
use crate::geometry::split::check_split;
use crate::geometry::{Disc, Rect};
use crate::numeric::ROUND;
use crate::tmx::space::Space;

/// Coordinates in tiles, at most, as for tiles themselves.
const FARTHEST: f64 = (1 << 30) as f64;

/// The form of an object in tiles, column and row as the editor counts: x to the right, y down. A
/// tile is 1 by 1, whatever its size in pixels, also in isometric maps. Coordinates are at most
/// 2^30, and rounded to single precision.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum TmxShape {
    /// A place.
    Point(Vec2),
    /// A rectangle along the axes. It may have no width or no height, not both.
    Rect(Rect),
    /// A circle.
    Disc(Disc),
    /// An ellipse.
    Ellipse {
        /// Its centre.
        center: Vec2,
        /// Two half diameters: the ellipse is `center + axes[0] cos t + axes[1] sin t`.
        axes: [Vec2; 2],
    },
    /// The corners of a polygon in order, in either direction; of a rectangle that is turned, too.
    Polygon(Vec<Vec2>),
    /// The points of a chain of walls.
    Polyline(Vec<Vec2>),
}

/// The form of an object in the file.
#[derive(Debug)]
pub(super) enum Outline {
    /// No element: a rectangle.
    Box,
    Ellipse,
    Point,
    Polygon(Vec<DVec2>),
    Polyline(Vec<DVec2>),
}

/// Where the coordinates of an object lie.
pub(super) struct Frame<'f> {
    pub space: &'f Space,
    /// The place of the object on the screen.
    pub at: DVec2,
    /// From coordinates of the object to the screen.
    pub turn: DMat2,
    /// Its least corner and its size in its own coordinates.
    pub least: DVec2,
    pub size: DVec2,
}

impl Frame<'_> {
    fn tiles(&self, p: DVec2) -> DVec2 {
        DVec2::from_array(self.space.tiles((self.at + self.turn * p).to_array()))
    }

    /// The shape that an outline has in tiles.
    ///
    /// # Errors
    /// The reason why there is no object.
    pub fn shape(&self, outline: &Outline) -> Result<TmxShape, TmxFault> {
        let shape = match outline {
            Outline::Point => TmxShape::Point(self.tiles(DVec2::ZERO).as_vec2()),
            // Old versions of the editor have no other points.
            Outline::Box | Outline::Ellipse if self.size == DVec2::ZERO => {
                TmxShape::Point(self.tiles(self.least).as_vec2())
            }
            Outline::Box => self.rectangle(),
            Outline::Ellipse => self.ellipse(),
            Outline::Polygon(points) if points.len() < 3 => {
                return Err(TmxFault::FewPoints { points: points.len() });
            }
            Outline::Polyline(points) if points.len() < 2 => {
                return Err(TmxFault::FewPoints { points: points.len() });
            }
            Outline::Polygon(points) => TmxShape::Polygon(self.all(points)),
            Outline::Polyline(points) => TmxShape::Polyline(self.all(points)),
        };
        let near = |c: &f32| f64::from(*c).abs() <= FARTHEST;
        let far = shape.coordinates().find(|c| !near(c));
        match far {
            Some(far) => Err(TmxFault::Number { attribute: "a coordinate", value: format!("{far} tiles") }),
            None => Ok(shape),
        }
    }

    fn all(&self, points: &[DVec2]) -> Vec<Vec2> {
        points.iter().map(|&p| self.tiles(p).as_vec2()).collect()
    }

    fn rectangle(&self) -> TmxShape {
        let Self { least, size, .. } = *self;
        let corners = [least, least + DVec2::new(size.x, 0.0), least + size, least + DVec2::new(0.0, size.y)];
        let [a, b, c, d] = corners.map(|corner| self.tiles(corner).as_vec2());
        let along = |a: Vec2, b: Vec2, c: Vec2, d: Vec2| a.y == b.y && b.x == c.x && c.y == d.y && d.x == a.x;
        if along(a, b, c, d) || along(b, c, d, a) {
            TmxShape::Rect(Rect::new(a.min(c), a.max(c)))
        } else if size.min_element() > 0.0 {
            TmxShape::Polygon(vec![a, b, c, d])
        } else {
            // A wall: its other corners are the same two.
            TmxShape::Polyline(vec![a, c])
        }
    }

    fn ellipse(&self) -> TmxShape {
        let center = self.tiles(self.least + self.size / 2.0);
        let axes = [DVec2::new(self.size.x / 2.0, 0.0), DVec2::new(0.0, self.size.y / 2.0)];
        let [a, b] = axes.map(|axis| DVec2::from_array(self.space.tiles((self.turn * axis).to_array())));
        if self.size.min_element() == 0.0 {
            return TmxShape::Polyline(vec![(center - a - b).as_vec2(), (center + a + b).as_vec2()]);
        }
        let (long, short) = (a.length().max(b.length()), a.length().min(b.length()));
        match long - short <= ROUND * long && a.dot(b).abs() <= ROUND * long * long {
            true => TmxShape::Disc(Disc::new(center.as_vec2(), long as f32)),
            false => TmxShape::Ellipse { center: center.as_vec2(), axes: [a.as_vec2(), b.as_vec2()] },
        }
    }
}

impl TmxShape {
    /// The rectangle around the shape, in tiles, up to rounding.
    pub fn bounds(&self) -> Rect {
        let around = |center: Vec2, half: Vec2| Rect::new(center - half, center + half);
        match self {
            Self::Point(p) => Rect::new(*p, *p),
            Self::Rect(rect) => *rect,
            Self::Disc(disc) => around(disc.center, Vec2::splat(disc.radius)),
            Self::Ellipse { center, axes: [a, b] } => {
                around(*center, Vec2::new(a.x.hypot(b.x), a.y.hypot(b.y)))
            }
            Self::Polygon(points) | Self::Polyline(points) => {
                let first = points.first().copied().unwrap_or_default();
                let with = |r: Rect, p: &Vec2| Rect::new(r.min.min(*p), r.max.max(*p));
                points.iter().fold(Rect::new(first, first), with)
            }
        }
    }

    fn coordinates(&self) -> impl Iterator<Item = f32> {
        let (few, many): ([Vec2; 3], &[Vec2]) = match self {
            Self::Point(p) => ([*p; 3], &[]),
            Self::Rect(rect) => ([rect.min, rect.max, rect.min], &[]),
            Self::Disc(disc) => ([disc.center, disc.center, Vec2::splat(disc.radius)], &[]),
            Self::Ellipse { center, axes } => ([*center, axes[0], axes[1]], &[]),
            Self::Polygon(points) | Self::Polyline(points) => ([Vec2::ZERO; 3], points),
        };
        few.into_iter().chain(many.iter().copied()).flat_map(|p| p.to_array())
    }

    /// What is amiss with the shape, though there is an object.
    pub(super) fn fault(&self) -> Option<TmxFault> {
        let Self::Polygon(corners) = self else { return None };
        match check_split(corners).err()? {
            Error::ManyCorners { corners, .. } => Some(TmxFault::ManyCorners(corners)),
            _ => Some(TmxFault::Crossed),
        }
    }
}
