//! Which shapes a view may see, and the part of it inside a box.

use glam::DVec3;
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::geometry::clip::{clip, sides_of_box};
use crate::numeric::view::CLIP;
use crate::object::Bounds;
use crate::view::View;

impl View {
    /// Whether bounds may have points in each half-space of the view, or may contain the eye: in
    /// front of a near plane that is known to a few digits only, that is doubt enough.
    pub(crate) fn may_see(&self, bounds: &Bounds) -> bool {
        let holds_eye = |at| self.eye_box() != DVec3::ZERO || bounds.kind().contains_point(at);
        bounds.kind().may_reach(&self.planes)
            || self.may_be_in(&bounds.block()) && self.eye().is_some_and(holds_eye)
    }

    /// Whether the eye may be in a box.
    fn may_be_in(&self, b: &Block) -> bool {
        let room = self.eye_box();
        self.eye().is_some_and(|at| Block { min: b.min - room, max: b.max + room }.contains_point(at))
    }

    /// As [`Self::may_see`], for an object anywhere in a box.
    pub(crate) fn may_see_volume(&self, b: &Block) -> bool {
        self.may_see_block(b) || self.may_be_in(b)
    }

    /// Whether a box may have points in each half-space of the view; in doubt, yes.
    pub(crate) fn may_see_block(&self, b: &Block) -> bool {
        b.may_reach(&self.planes)
    }

    /// Whether all points that `other` sees inside the box from `min` to `max` lie in
    /// this view's half-spaces. Exact up to rounding; in doubt, no.
    pub(crate) fn contains(&self, other: &Self, min: DVec3, max: DVec3) -> bool {
        let mut shared = self.planes.iter().map(|plane| other.planes.contains(plane));
        if shared.all(|shared| shared) {
            return true;
        }
        let corners = other.corners(min, max);
        let reach = min.abs().max(max.abs()).max_element();
        self.planes.iter().all(|plane| {
            other.planes.contains(plane) || corners.iter().all(|&c| plane.distance(c) >= plane.margin(reach))
        })
    }

    /// The corners of the view's half-spaces clipped to a box, and some points of its surface: the
    /// region lies in their hull. Rounded outwards.
    pub(crate) fn corners(&self, min: DVec3, max: DVec3) -> SmallVec<[DVec3; 64]> {
        let reach = min.abs().max(max.abs()).max_element();
        let mut faces = sides_of_box(min, max);
        for plane in &self.planes {
            let slack = CLIP * (reach + plane.offset.abs());
            clip(&mut faces, plane, slack);
        }
        faces.into_iter().flatten().collect()
    }
}
