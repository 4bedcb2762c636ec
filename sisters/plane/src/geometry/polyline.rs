//! Polylines: chains of walls without thickness.

use std::sync::Arc;

use glam::{DVec2, Vec2};

use crate::error::{Error, finite2};
use crate::geometry::{Block, Segment};

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

    pub(crate) fn block(&self) -> Block {
        Block::around(&self.points)
    }

    /// Whether a point lies on one of the segments. Exact.
    pub(crate) fn contains(&self, p: DVec2) -> bool {
        self.segments().any(|s| s.contains(p))
    }
}
