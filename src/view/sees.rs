//! Which shapes a view may see.

use glam::DVec3;

use crate::geometry::Block;
use crate::object::Bounds;
use crate::shape::Shape;
use crate::view::{Origin, View};

impl View {
    /// Whether bounds may have points in each half-space of the view, or may contain the eye: in front of a near plane
    /// that is known to a few digits only, that is doubt enough.
    pub(crate) fn may_see(&self, bounds: &Bounds) -> bool {
        let meets = bounds.kind().may_reach(&self.planes);
        let holds_eye = |at: DVec3, error: f64| {
            let block = bounds.block();
            let around = Block { min: block.min - error, max: block.max + error };
            around.contains_point(at) && (error > 0.0 || bounds.contains_point(at))
        };
        meets || matches!(self.origin, Origin::Eye { at, error } if holds_eye(at, error))
    }

    /// As [`Self::may_see`], for an object anywhere in a box.
    pub(crate) fn may_see_volume(&self, b: &Block) -> bool {
        let holds_eye =
            |at: DVec3, error: f64| Block { min: b.min - error, max: b.max + error }.contains_point(at);
        self.may_see_block(b) || matches!(self.origin, Origin::Eye { at, error } if holds_eye(at, error))
    }

    /// Whether a box may have points in each half-space of the view; in doubt, yes.
    pub(crate) fn may_see_block(&self, b: &Block) -> bool {
        b.may_reach(&self.planes)
    }
}
