//! Boxes in double precision.

use glam::DVec3;

use crate::geometry::primitives::Aabb;

/// A box in `f64`: what shapes are compared with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Block {
    pub(crate) min: DVec3,
    pub(crate) max: DVec3,
}

impl Block {
    pub(crate) fn new((min, max): (DVec3, DVec3)) -> Self {
        Self { min, max }
    }

    pub(crate) fn contains(&self, other: &Self) -> bool {
        self.min.cmple(other.min).all() && self.max.cmpge(other.max).all()
    }

    pub(crate) fn contains_point(&self, p: DVec3) -> bool {
        self.min.cmple(p).all() && self.max.cmpge(p).all()
    }

    /// Whether they share a point, if only on their surfaces.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && self.max.cmpge(other.min).all()
    }

    /// The eight corners; bit 0 of the index is the greater x, bit 1 the greater y, bit 2 the greater z.
    pub(crate) fn corners(&self) -> [DVec3; 8] {
        let Self { min, max } = *self;
        std::array::from_fn(|i| {
            DVec3::new(
                if i & 1 == 0 { min.x } else { max.x },
                if i & 2 == 0 { min.y } else { max.y },
                if i & 4 == 0 { min.z } else { max.z },
            )
        })
    }

    /// Whether the interiors meet.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.min.cmplt(other.max).all() && self.max.cmpgt(other.min).all()
    }
}

impl From<Aabb> for Block {
    fn from(b: Aabb) -> Self {
        Self { min: b.min.as_dvec3(), max: b.max.as_dvec3() }
    }
}
