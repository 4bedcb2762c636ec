//! Boxes in double precision.

use glam::DVec3;

use crate::geometry::plane::HalfSpace;
use crate::geometry::primitives::Aabb;
use crate::numeric::shape::REGION;

/// The least number in single precision that is not less.
pub(crate) fn above(v: f64) -> f32 {
    let single = v as f32;
    if f64::from(single) < v { single.next_up() } else { single }
}

/// The greatest number in single precision that is not greater.
pub(crate) fn below(v: f64) -> f32 {
    -above(-v)
}

/// An axis-aligned box in `f64`, in world units unless said otherwise.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Block {
    pub(crate) min: DVec3,
    pub(crate) max: DVec3,
}

impl Block {
    pub(crate) fn new((min, max): (DVec3, DVec3)) -> Self {
        Self { min, max }
    }

    /// The least box around points; inverted without points.
    pub(crate) fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        let none = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };
        points.into_iter().fold(none, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// By how much another box sticks out of this one along an axis, at most; negative if by
    /// nothing.
    pub(crate) fn beyond(&self, other: &Self) -> f64 {
        (self.min - other.min).max(other.max - self.max).max_element()
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

    /// Whether they may share a point, with room for the rounding of the tests that follow; in
    /// doubt, yes.
    pub(crate) fn may_meet(&self, other: &Self) -> bool {
        let largest = |b: &Self| b.min.abs().max(b.max.abs()).max_element();
        let room = 2.0 * REGION * (1.0 + largest(self) + largest(other));
        // Also if a number is NaN.
        !((self.min - room).cmpgt(other.max).any() || (self.max + room).cmplt(other.min).any())
    }

    /// The eight corners; bit 0 of the index is the greater x, bit 1 the greater y, bit 2 the
    /// greater z.
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

    /// The least box around both.
    pub(crate) fn join(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The part that both have in common; inverted if there is none.
    pub(crate) fn intersection(&self, other: &Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// The box larger by a length on all sides.
    pub(crate) fn grown(&self, by: f64) -> Self {
        Self { min: self.min - by, max: self.max + by }
    }

    /// The least box in single precision around it: infinite where it ends beyond the range of
    /// that.
    pub(crate) fn to_aabb(self) -> Aabb {
        Aabb {
            min: self.min.to_array().map(|v| -above(-v)).into(),
            max: self.max.to_array().map(above).into(),
        }
    }

    /// The volume of a box that is not inverted.
    pub(crate) fn volume(&self) -> f64 {
        (self.max - self.min).element_product()
    }

    /// Whether the interiors intersect.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.min.cmplt(other.max).all() && self.max.cmpgt(other.min).all()
    }
}

impl Block {
    /// Whether it may have points in each of the half-spaces; in doubt, yes.
    pub(crate) fn may_reach(&self, planes: &[HalfSpace]) -> bool {
        let largest = self.min.abs().max(self.max.abs()).max_element();
        planes.iter().all(|p| {
            let farthest = DVec3::select(p.normal.cmpge(DVec3::ZERO), self.max, self.min);
            p.distance(farthest) >= -p.margin(largest)
        })
    }

    /// How far its nearest point is from an eye; 0 inside.
    pub(crate) fn distance_from(&self, eye: DVec3) -> f64 {
        (self.min - eye).max(eye - self.max).max(DVec3::ZERO).length()
    }

    /// The least coordinate of its points along a direction.
    pub(crate) fn distance_along(&self, direction: DVec3) -> f64 {
        let half = (self.max - self.min) * 0.5;
        ((self.min + self.max) * 0.5).dot(direction) - half.dot(direction.abs())
    }

    /// Centre and radius of the ball around it.
    pub(crate) fn ball(&self) -> (DVec3, f64) {
        ((self.min + self.max) * 0.5, ((self.max - self.min) * 0.5).length())
    }
}

impl From<Aabb> for Block {
    fn from(b: Aabb) -> Self {
        Self { min: b.min.as_dvec3(), max: b.max.as_dvec3() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_that_rounding_may_bring_together_may_meet() {
        let block = |min: f64, max: f64| Block { min: DVec3::splat(min), max: DVec3::splat(max) };
        for at in [0.0, 1.0, -3e4, 1e12] {
            let room = REGION * (1.0 + f64::abs(at));
            let below = block(at - 1.0, at);
            assert!(below.may_meet(&block(at + room, at + 1.0 + room)), "{at}");
            assert!(!below.may_meet(&block(at + 9.0 * room, at + 1.0 + 9.0 * room)), "{at}");
        }
        let not_known = Block { min: DVec3::new(f64::NAN, 0.0, 0.0), max: DVec3::ONE };
        assert!(not_known.may_meet(&block(0.5, 2.0)) && block(0.5, 2.0).may_meet(&not_known));
        assert!(block(f64::NEG_INFINITY, f64::INFINITY).may_meet(&block(0.5, 2.0)));
    }
}
