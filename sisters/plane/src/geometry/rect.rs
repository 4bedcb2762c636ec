//! Rectangles along the axes.

use glam::{DVec2, Vec2};

use crate::error::{Error, finite2};
use crate::geometry::block::Block;

/// A solid rectangle along the axes. It may have no width or no height: then it is a wall without
/// thickness.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

    /// Whether a point lies inside, and not on the border.
    pub(crate) fn surrounds(&self, p: DVec2) -> bool {
        p.cmpgt(self.min.as_dvec2()).all() && p.cmplt(self.max.as_dvec2()).all()
    }
}
