//! More occluders, drawn over a copy of the buffers of a query.

use casca_slots::Slot;

use crate::method::PointOptions;
use crate::object::Bounds;
use crate::pvs::Pvs;
use crate::query::marks::Marks;
use crate::query::point::PointWalk;
use crate::query::point::scratch::PointScratch;
use crate::scene::Scene;
use crate::view::View;

/// Buffers of a view with more occluders than its query drew.
#[derive(Debug, Clone, Default)]
pub(crate) struct Overlay {
    scratch: PointScratch,
    marks: Marks,
    /// Stays empty.
    pvs: Pvs,
    /// How many occluders were drawn.
    pub(crate) drawn: u32,
}

impl Overlay {
    /// Starts with the coverage of a query's buffers, and draws the occluders of some objects for
    /// the view of that. Small ones are left out, and those that rays start in.
    pub(crate) fn draw(
        &mut self,
        base: &PointScratch,
        scene: &Scene,
        view: &View,
        mut slots: impl Iterator<Item = Slot>,
    ) {
        self.drawn = 0;
        let Some(first) = slots.next() else { return };
        let Self { scratch, marks, pvs, drawn } = self;
        scratch.buffers.copy_coverage(&base.buffers);
        // The lists that refinement asks are not copied.
        let options = PointOptions::new().unrefined();
        let walk = PointWalk::new(scene, view, &options, pvs, marks, scratch);
        *drawn = walk.draw_over(std::iter::once(first).chain(slots));
    }

    /// Whether no point of some bounds can be seen.
    pub(crate) fn hides_bounds(&self, bounds: &Bounds) -> bool {
        self.scratch.hides_bounds(bounds)
    }
}
