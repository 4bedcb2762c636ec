//! More occluders, drawn over a copy of the buffers of a query.

use crate::object::{Bounds, Occluder};
use crate::query::point::occluders::{SMALLEST_OCCLUDER, solid};
use crate::query::point::scratch::PointScratch;
use crate::query::start::Starts;
use crate::view::View;

/// Buffers of a view with more occluders than its query drew.
#[derive(Debug, Clone, Default)]
pub(crate) struct Overlay {
    scratch: PointScratch,
    drawn: u32,
}

impl Overlay {
    /// Starts with the coverage of a query's buffers.
    pub(crate) fn begin(&mut self, base: &PointScratch) {
        self.scratch.buffers.copy_coverage(&base.buffers);
        self.drawn = 0;
    }

    /// Counts the occluders from none again.
    pub(crate) fn reset(&mut self) {
        self.drawn = 0;
    }

    /// How many occluders were drawn since.
    pub(crate) fn drawn(&self) -> u32 {
        self.drawn
    }

    /// Draws a convex occluder of the view of the buffers, unless it is small or rays start in it. Meshes are left out.
    pub(crate) fn draw(&mut self, view: &View, starts: &Starts, occluder: &Occluder, slot: u32) {
        let block = self.scratch.buffers.relative(&occluder.block());
        if occluder.surface().is_some()
            || !view.is_ordered()
            || self.scratch.is_small(&block, SMALLEST_OCCLUDER)
            || starts.may_be_in(view, occluder)
        {
            return;
        }
        let buffers = &mut self.scratch.buffers;
        if let Some(solid) = solid(occluder, buffers) {
            self.drawn += u32::from(buffers.draw(solid, slot));
        }
    }

    /// Whether no point of some bounds can be seen.
    pub(crate) fn hides_bounds(&self, bounds: &Bounds) -> bool {
        self.scratch.hides_bounds(bounds)
    }
}
