//! Drawing occluders: convex ones ([`occluders`]), surfaces of triangles
//! ([`surfaces`], [`drawables`]), those of the last run first ([`coherence`]).

mod coherence;
mod drawables;
mod occluders;
mod recall;
mod surfaces;

use casca_slots::Slot;
use glam::DVec3;

use crate::geometry::Block;
use crate::grid::Grid;
use crate::mesh::surface::PatchIndex;
use crate::method::PointOptions;
use crate::object::Bounds;
use crate::occlusion::buffers::{OcclusionBuffers, Verdict};
use crate::occlusion::surface::batch::Batch;
use crate::occlusion::target::{FaceTarget, Target};
use crate::pvs::Stats;
use crate::query::marks::Marks;
use crate::query::point::drawing::recall::Coherence;
use crate::query::point::run::Run;
use crate::query::start::Starts;
use crate::scene::Scene;
use crate::view::View;
use crate::walk::{Shells, Start};

/// Draws the occluders that the walk offers: owns the buffers, what waits to be drawn and what was
/// drawn.
pub(super) struct Drawing<'a> {
    pub(super) run: Run<'a>,
    scratch: &'a mut DrawingScratch,
    /// The grid of bricks.
    pub(super) bricks: Grid,
    /// The shells of bricks around the eye's brick, if the walk goes in shells.
    pub(super) around: Option<Shells>,
    /// Where rays start beside the eye.
    starts: Starts,
    /// A box around the eye and those regions; `None` for parallel rays.
    around_starts: Option<Block>,
    /// The counts of the run: the rest of the walk adds its own.
    pub(super) stats: Stats,
}

/// The objects on whose occluders a kept result may rest: all that were not hidden when they were
/// found, whether their occluders were drawn, waited or were too small. The occluders of others are
/// hidden: no ray of the view reaches them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Offered(Vec<Slot>);

impl Offered {
    /// Takes over the objects of a run, and puts all in order.
    pub(crate) fn append(&mut self, other: &Self) {
        self.0.extend_from_slice(&other.0);
        self.0.sort_unstable();
        self.0.dedup();
    }

    /// Whether an object is among them, which are in order.
    pub(crate) fn has(&self, slot: Slot) -> bool {
        self.0.binary_search(&slot).is_ok()
    }

    /// Forgets objects, whose slots are in order.
    pub(crate) fn forget(&mut self, slots: &[Slot]) {
        self.0.retain(|slot| slots.binary_search(slot).is_err());
    }

    /// The slots of all.
    pub(super) fn slots(&self) -> impl Iterator<Item = Slot> {
        self.0.iter().copied()
    }
}

/// The buffers, and the memory of drawing in them.
#[derive(Debug, Clone, Default)]
pub(crate) struct DrawingScratch {
    pub(crate) buffers: OcclusionBuffers,
    /// Objects in sight whose surfaces are yet to be drawn.
    waiting: Vec<Slot>,
    /// Memory for patches that are drawn together.
    batch: Batch<'static>,
    /// The patches drawn, in the order of first drawing: object and patch.
    patches: Vec<(Slot, PatchIndex)>,
    /// The objects of which an occluder hid more than before. Their epoch numbers the queries.
    useful: Marks,
    /// The objects whose occluders were offered in a run on static objects only.
    pub(crate) offered: Offered,
    pub(crate) coherence: Coherence,
}

impl<'a> Drawing<'a> {
    /// Empties all lists of the last run; the buffers stay as they are.
    pub(super) fn new(run: Run<'a>, scratch: &'a mut DrawingScratch) -> Self {
        let Run { scene, view, .. } = run;
        let (slots, patches) = (scene.slot_count(), scene.seams().patches());
        scratch.useful.begin(slots);
        scratch.waiting.clear();
        scratch.patches.clear();
        scratch.buffers.begin_patches();
        scratch.offered.0.clear();
        if run.keeps_memory {
            scratch.coherence.begin(scene.tag(), slots, patches);
        }
        let starts = Starts::of(scene, view);
        let around_starts = view.eye().map(|eye| starts.around(eye));
        let bricks = scene.grid().bricks();
        let around = Shells::around_eye(&bricks, run.scene.extent_in_bricks(), view, Start::Eye);
        let stats = Stats::default();
        Self { run, scratch, bricks, around, starts, around_starts, stats }
    }

    /// The buffers with all that was drawn so far.
    #[inline]
    pub(super) fn buffers(&self) -> &OcclusionBuffers {
        &self.scratch.buffers
    }

    /// As [`Drawing::buffers`], to be emptied, opened again or made ready for questions.
    pub(super) fn buffers_mut(&mut self) -> &mut OcclusionBuffers {
        &mut self.scratch.buffers
    }

    /// The memory of coherent runs.
    pub(super) fn coherence(&self) -> &Coherence {
        &self.scratch.coherence
    }

    /// Whether a box in world units is hidden by the occluders drawn so far.
    pub(super) fn hides(&self, bounds: &Block) -> bool {
        self.scratch.hides(bounds)
    }

    /// Whether the view may see a temporal bounding volume.
    pub(super) fn sees_volume(&self, volume: &Block) -> bool {
        self.scratch.sees_volume(self.run.view, volume)
    }
}

impl DrawingScratch {
    /// Starts with the coverage of a query's buffers, and draws the occluders of some objects for
    /// the view of that. Small ones are left out, and those that rays start in. Returns how many
    /// were drawn.
    pub(crate) fn draw_over(
        &mut self,
        base: &Self,
        scene: &Scene,
        view: &View,
        slots: impl Iterator<Item = Slot>,
    ) -> u32 {
        let mut slots = slots.peekable();
        if slots.peek().is_none() {
            return 0;
        }
        self.buffers.copy_coverage(&base.buffers);
        // The lists that refinement asks are not copied.
        let options = PointOptions::new().unrefined();
        let mut drawing = Drawing::new(Run::new(scene, view, &options, None), self);
        slots.for_each(|slot| drawing.draw(slot));
        drawing.draw_patches();
        drawing.stats.occluders_drawn
    }

    /// Whether a box in world units is hidden by the occluders drawn so far.
    pub(crate) fn hides(&self, bounds: &Block) -> bool {
        self.buffers.hides(&self.buffers.relative(bounds))
    }

    /// Whether a box relative to the origin is smaller than some pixels.
    fn is_small(&self, b: &Block, pixels: f64) -> bool {
        let radius = self.buffers.pixel_angle() * pixels;
        let distance = b.min.max(-b.max).max(DVec3::ZERO).length_squared();
        self.buffers.direction().is_none()
            && (b.max - b.min).length_squared() * 0.25 < radius * radius * distance
    }

    /// Whether no point of some bounds can be seen before the occluders drawn so far. Meshes are
    /// tested as one convex shape.
    pub(crate) fn hides_bounds(&self, bounds: &Bounds) -> bool {
        let buffers = &self.buffers;
        let block = bounds.block();
        if self.hides(&block) {
            return true;
        }
        // Most objects in sight are seen at their middle.
        let middle = (block.min + block.max) * 0.5 - buffers.origin();
        if bounds.kind().is_centered() && buffers.leaves_open(middle) {
            return false;
        }
        let outer = bounds.kind().outer(buffers.origin(), buffers.uncertainty());
        buffers.test(&Target::new(&outer, buffers.direction()), &mut FaceTarget::default()) == Verdict::Hidden
    }

    /// Whether the view that the buffers are of may see a temporal bounding volume.
    pub(crate) fn sees_volume(&self, view: &View, volume: &Block) -> bool {
        // The surface of a volume in which rays start does not come before the objects in it.
        let starts = self.buffers.direction().is_some_and(|d| view.cuts_front(d, volume));
        view.may_see_volume(volume) && (starts || !self.hides(volume))
    }
}
