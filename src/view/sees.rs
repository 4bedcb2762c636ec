//! Which shapes a view may see.

use glam::DVec3;

use crate::geometry::{Block, Obb, Sphere};
use crate::object::Bounds;
use crate::shape::Shape;
use crate::view::{Origin, View};

impl View {
    /// Whether the box or sphere may meet every half-space of the view, or holds
    /// the eye: before a near plane that is known to a few digits only, that is doubt enough.
    pub(crate) fn may_see(&self, bounds: &Bounds) -> bool {
        let meets = match bounds {
            Bounds::Sphere(s) => self.may_see_sphere(s),
            Bounds::Oriented(b) => self.may_see_oriented(b),
            other => self.may_see_block(&other.block()),
        };
        let holds_eye = |at: DVec3, error: f64| {
            let block = bounds.block();
            let around = Block { min: block.min - error, max: block.max + error };
            around.contains_point(at) && (error > 0.0 || bounds.contains_point(at))
        };
        meets || matches!(self.origin, Origin::Eye { at, error } if holds_eye(at, error))
    }

    /// As [`Self::may_see`], for something anywhere in a box.
    pub(crate) fn may_see_volume(&self, b: &Block) -> bool {
        let holds_eye =
            |at: DVec3, error: f64| Block { min: b.min - error, max: b.max + error }.contains_point(at);
        self.may_see_block(b) || matches!(self.origin, Origin::Eye { at, error } if holds_eye(at, error))
    }

    pub(crate) fn may_see_sphere(&self, s: &Sphere) -> bool {
        let (c, r) = (s.center.as_dvec3(), f64::from(s.radius));
        let reach = c.abs().max_element() + r;
        self.planes.iter().all(|p| p.distance(c) >= -(r + p.margin(reach)))
    }

    pub(crate) fn may_see_oriented(&self, b: &Obb) -> bool {
        let (c, axes, _) = b.parts();
        let reach = c.abs().max_element() + b.half.as_dvec3().element_sum();
        self.planes.iter().all(|p| {
            let half: f64 = (0..3).map(|i| axes.col(i).dot(p.normal).abs()).sum();
            p.distance(c) >= -(half + p.margin(reach))
        })
    }

    pub(crate) fn may_see_block(&self, b: &Block) -> bool {
        let reach = b.min.abs().max(b.max.abs()).max_element();
        self.planes.iter().all(|p| {
            let farthest = DVec3::select(p.normal.cmpge(DVec3::ZERO), b.max, b.min);
            p.distance(farthest) >= -p.margin(reach)
        })
    }
}
