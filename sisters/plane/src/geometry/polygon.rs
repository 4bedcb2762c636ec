//! Convex polygons.

use std::sync::Arc;

use glam::{DVec2, Vec2};

use crate::error::{Error, finite2};
use crate::geometry::{Block, orient};

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

    pub(crate) fn block(&self) -> Block {
        Block::around(&self.corners)
    }

    /// Whether a point lies inside, and not on the border. Exact.
    pub(crate) fn surrounds(&self, p: DVec2) -> bool {
        ring(&self.corners).all(|(a, b)| orient(a, b, p) > 0.0)
    }

    /// Whether a point lies inside or on the border. Exact.
    pub(crate) fn contains(&self, p: DVec2) -> bool {
        ring(&self.corners).all(|(a, b)| orient(a, b, p) >= 0.0)
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

    #[test]
    fn hulls_have_no_points_inside_or_on_sides() {
        let points = [(0, 0), (4, 0), (2, 0), (4, 4), (2, 2), (0, 4), (0, 0), (0, 2)];
        let points = points.map(|(x, y)| Vec2::new(x as f32, y as f32));
        let square = ConvexPolygon::new(&points).unwrap();
        assert_eq!(square.corners(), [points[0], points[1], points[3], points[5]]);
        let at = |x, y| DVec2::new(x, y);
        assert!(square.surrounds(at(1.0, 3.0)) && square.contains(at(4.0, 1.0)));
        assert!(!square.surrounds(at(4.0, 1.0)) && !square.contains(at(4.5, 1.0)));
        for flat in [&points[..3], &points[..1], &[], &[points[0]; 5]] {
            assert_eq!(ConvexPolygon::new(flat), Err(Error::FlatPolygon { points: flat.len() }));
        }
        assert!(ConvexPolygon::new(&[Vec2::NAN; 3]).is_err());
    }
}
