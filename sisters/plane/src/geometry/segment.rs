//! Line segments: walls without thickness.

use glam::{DVec2, Vec2};

use crate::error::{Error, finite2};
use crate::geometry::block::Block;
use crate::geometry::orient;

/// A line segment between two points: a wall without thickness. The points may be the same.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

    pub(crate) fn check(&self, what: &'static str) -> Result<(), Error> {
        finite2(what, self.a)?;
        finite2(what, self.b)
    }

    pub(crate) fn block(&self) -> Block {
        Block::around(&[self.a, self.b])
    }

    /// Whether a point lies on the segment. Exact.
    pub(crate) fn contains(&self, p: DVec2) -> bool {
        self.block().contains(p) && orient(self.a.as_dvec2(), self.b.as_dvec2(), p) == 0.0
    }
}
