//! Convex polygons, and chains of walls.

use std::sync::Arc;

use glam::{DVec2, Vec2};

use crate::error::{Error, finite2};
use crate::geometry::{Segment, orient};

/// A solid convex polygon.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvexPolygon {
    /// Counterclockwise, no three of them on a line.
    corners: Arc<[Vec2]>,
}

impl ConvexPolygon {
    /// The convex hull of some points, in any order. Costs their sorting (Andrew 1979).
    ///
    /// # Errors
    /// Refuses points that are not finite, and points on one line.
    pub fn new(points: &[Vec2]) -> Result<Self, Error> {
        points.iter().try_for_each(|&p| finite2("a point of the polygon", p))?;
        let mut sorted = points.to_vec();
        sorted.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        let mut corners = chain(sorted.iter().copied());
        let upper = chain(sorted.iter().rev().copied());
        corners.pop();
        corners.extend(&upper[..upper.len().saturating_sub(1)]);
        if corners.len() < 3 {
            return Err(Error::FlatPolygon { points: points.len() });
        }
        Ok(Self { corners: corners.into() })
    }

    /// Its corners, counterclockwise, no three of them on a line.
    pub fn corners(&self) -> &[Vec2] {
        &self.corners
    }
}

/// A chain of line segments: walls without thickness. It closes a ring if the last point is the
/// first; it is hollow even then.
///
/// A scene looks at all of its segments as soon as it looks at one. Cut chains that run through
/// many rooms.
#[derive(Debug, Clone, PartialEq)]
pub struct Polyline {
    points: Arc<[Vec2]>,
}

impl Polyline {
    /// The chain through some points, in their order. It may cross itself.
    ///
    /// # Errors
    /// Refuses fewer than two points, and points that are not finite.
    pub fn new(points: &[Vec2]) -> Result<Self, Error> {
        if points.len() < 2 {
            return Err(Error::ShortPolyline { points: points.len() });
        }
        points.iter().try_for_each(|&p| finite2("a point of the polyline", p))?;
        Ok(Self { points: points.into() })
    }

    /// Its points, in world units.
    pub fn points(&self) -> &[Vec2] {
        &self.points
    }

    /// Its segments, in order.
    pub fn segments(&self) -> impl Iterator<Item = Segment> {
        self.points.windows(2).map(|ends| Segment::new(ends[0], ends[1]))
    }
}

/// The sides of a ring of corners.
pub(crate) fn ring(corners: &[Vec2]) -> impl Iterator<Item = (DVec2, DVec2)> {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| (a.as_dvec2(), b.as_dvec2()))
}

/// The part of the hull that turns left around points in the order of their sorting, with both
/// ends.
fn chain(points: impl Iterator<Item = Vec2>) -> Vec<Vec2> {
    let mut chain: Vec<Vec2> = Vec::new();
    for p in points {
        while let [.., a, b] = chain[..] {
            if orient(a.as_dvec2(), b.as_dvec2(), p.as_dvec2()) > 0.0 {
                break;
            }
            chain.pop();
        }
        if chain.last() != Some(&p) {
            chain.push(p);
        }
    }
    chain
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Shape;

    #[test]
    fn hulls_have_no_points_inside_or_on_sides() {
        let points = [(0, 0), (4, 0), (2, 0), (4, 4), (2, 2), (0, 4), (0, 0), (0, 2)];
        let points = points.map(|(x, y)| Vec2::new(x as f32, y as f32));
        let square = ConvexPolygon::new(&points).unwrap();
        assert_eq!(square.corners(), [points[0], points[1], points[3], points[5]]);
        let at = |x, y| DVec2::new(x, y);
        let shape = Shape::from(square);
        assert!(shape.surrounds(at(1.0, 3.0)) && shape.contains(at(4.0, 1.0)));
        assert!(!shape.surrounds(at(4.0, 1.0)) && !shape.contains(at(4.5, 1.0)));
        for flat in [&points[..3], &points[..1], &[], &[points[0]; 5]] {
            assert_eq!(ConvexPolygon::new(flat), Err(Error::FlatPolygon { points: flat.len() }));
        }
        assert!(ConvexPolygon::new(&[Vec2::NAN; 3]).is_err());
    }
}
