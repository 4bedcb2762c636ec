//! More occluders, drawn over a copy of the buffers of a query.

use crate::geometry::Block;
use crate::object::{Bounds, Occluder};
use crate::query::point::occluders::{SMALLEST_OCCLUDER, solid};
use crate::query::point::scratch::PointScratch;
use crate::view::View;
use crate::view::cut::may_start_in;

/// Buffers of a view with more occluders than its query drew.
#[derive(Debug, Clone, Default)]
pub(crate) struct Overlay {
    scratch: PointScratch,
    drawn: u32,
}

/// Where rays of a view may start beside its eye.
pub(crate) struct Starts {
    cut: Vec<(View, Block)>,
    unsure: Option<(View, Block)>,
}

impl Starts {
    /// The regions as far as they lie in a box.
    pub(crate) fn of(view: &View, Block { min, max }: Block) -> Self {
        Self { cut: view.cut_regions(min, max).collect(), unsure: view.eye_region() }
    }
}

impl Overlay {
    /// Starts with what a query drew.
    pub(crate) fn begin(&mut self, base: &PointScratch) {
        self.scratch.buffers.copy_coverage(&base.buffers);
        self.drawn = 0;
    }

    /// Forgets what was drawn.
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
            || may_start_in(view, &starts.cut, starts.unsure.as_ref(), occluder)
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
