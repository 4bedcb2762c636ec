//! More occluders, drawn over a copy of the buffers of a query.

use casca_slots::Slot;

use crate::method::PointOptions;
use crate::object::Bounds;
use crate::query::point::drawing::{Drawing, DrawingScratch};
use crate::query::point::run::Run;
use crate::scene::Scene;
use crate::view::View;
use crate::walk::{Shells, Start};

/// Buffers of a view with more occluders than its query drew.
#[derive(Debug, Clone, Default)]
pub(crate) struct Overlay {
    scratch: DrawingScratch,
    /// How many occluders were drawn.
    pub(crate) drawn: u32,
}

impl Overlay {
    /// Starts with the coverage of a query's buffers, and draws the occluders of some objects for
    /// the view of that. Small ones are left out, and those that rays start in.
    pub(crate) fn draw(
        &mut self,
        base: &DrawingScratch,
        scene: &Scene,
        view: &View,
        mut slots: impl Iterator<Item = Slot>,
    ) {
        self.drawn = 0;
        let Some(first) = slots.next() else { return };
        self.scratch.buffers.copy_coverage(&base.buffers);
        // The lists that refinement asks are not copied.
        let options = PointOptions::new().unrefined();
        let run = Run::new(scene, view, &options, None);
        let bricks = scene.grid().bricks();
        let begins = Shells::around_eye(&bricks, view, Start::Eye).map(|shells| shells.begins(&bricks));
        let mut drawing = Drawing::new(run, begins, &mut self.scratch);
        std::iter::once(first).chain(slots).for_each(|slot| drawing.draw(slot));
        drawing.draw_all_patches(i32::MAX);
        self.drawn = drawing.stats.occluders_drawn;
    }

    /// Whether no point of some bounds can be seen.
    pub(crate) fn hides_bounds(&self, bounds: &Bounds) -> bool {
        self.scratch.hides_bounds(bounds)
    }
}
