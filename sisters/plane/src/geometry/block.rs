//! Rectangles along the axes in double precision.

use glam::{DVec2, Vec2};

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
