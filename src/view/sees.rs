//! Which shapes a view may see.

use glam::DVec3;

use crate::geometry::Block;
use crate::object::Bounds;
use crate::shape::Shape;
use crate::view::View;

impl View {
    /// Whether bounds may have points in each half-space of the view, or may contain the eye: in
    /// front of a near plane that is known to a few digits only, that is doubt enough.
    pub(crate) fn may_see(&self, bounds: &Bounds) -> bool {
        let meets = bounds.kind().may_reach(&self.planes);
        let room = self.eye_room();
        let holds_eye = |at: DVec3| {
            let block = bounds.block();
            let around = Block { min: block.min - room, max: block.max + room };
            around.contains_point(at) && (room > 0.0 || bounds.contains_point(at))
        };
        meets || self.eye().is_some_and(holds_eye)
    }

    /// As [`Self::may_see`], for an object anywhere in a box.
    pub(crate) fn may_see_volume(&self, b: &Block) -> bool {
        let room = self.eye_room();
        let holds_eye = |at: DVec3| Block { min: b.min - room, max: b.max + room }.contains_point(at);
        self.may_see_block(b) || self.eye().is_some_and(holds_eye)
    }

    /// Whether a box may have points in each half-space of the view; in doubt, yes.
    pub(crate) fn may_see_block(&self, b: &Block) -> bool {
        b.may_reach(&self.planes)
    }
}
