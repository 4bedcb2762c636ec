//! The memory of the point method.

use casca_slots::Slot;
use glam::{DVec3, IVec3};

use crate::geometry::Block;
use crate::id::ObjectId;
use crate::mesh::surface::PatchIndex;
use crate::object::Bounds;
use crate::occlusion::buffers::{OcclusionBuffers, Verdict};
use crate::occlusion::magnify::{Hand, Magnifier, UsedFinely};
use crate::occlusion::surface::batch::Batch;
use crate::occlusion::surface::by_patch::ByPatch;
use crate::occlusion::target::{FaceTarget, Target};
use crate::query::marks::Marks;
use crate::query::point::offered::Offered;
use crate::query::point::recall::Coherence;
use crate::view::View;

/// How a patch was drawn.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct DrawnPatch {
    /// The query.
    pub(super) epoch: u32,
    /// The batch of that query.
    pub(super) batch: u32,
    /// The number in its surface of the patch that it was drawn in: itself or a group.
    pub(super) whole: PatchIndex,
}

/// An object that may be visible, with all that a test of its box takes: objects themselves are far
/// apart in memory.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    pub(super) slot: Slot,
    /// A box around its bounds; `None` if it may be anywhere.
    pub(super) block: Option<Block>,
    /// Whether the middle of that box lies in the object.
    pub(super) is_centered: bool,
    pub(super) occludes: bool,
}

/// Patches of one shell that wait.
#[derive(Debug, Clone, Default)]
pub(super) struct Waiting {
    /// Object and patch.
    pub(super) listed: Vec<(Slot, PatchIndex)>,
    /// The number of patches in those listed.
    pub(super) count: u64,
}

impl Waiting {
    pub(super) fn clear(&mut self) {
        self.listed.clear();
        self.count = 0;
    }
}

/// The memory of the point method, reused from query to query.
#[derive(Debug, Clone, Default)]
pub(crate) struct PointScratch {
    pub(crate) buffers: OcclusionBuffers,
    pub(super) bricks: Vec<IVec3>,
    /// Bricks of a shell with temporal bounding volumes that are not hidden.
    pub(super) volumes: Vec<IVec3>,
    /// Undecided objects of a brick.
    pub(super) open: Vec<Slot>,
    /// Objects of a shell.
    pub(super) objects: Vec<Candidate>,
    /// Numbers that sort them by distance, with the place of each.
    pub(super) found: Vec<u128>,
    /// Objects found visible so far.
    pub(super) candidates: Vec<Candidate>,
    /// Small moving objects that need no further test.
    pub(super) movers: Vec<ObjectId>,
    /// Zones of such objects in the frustum, with their distances.
    pub(super) zones: Vec<(f64, u32)>,
    /// Patches of visible surfaces that are yet to be drawn, by the shell that they begin in.
    pub(super) waiting: Vec<Waiting>,
    /// For each patch of the scene, how it was drawn last.
    pub(super) drawn: ByPatch<DrawnPatch>,
    pub(super) batches: u32,
    /// Memory for one of them.
    pub(super) batch: Batch<'static>,
    /// The patches drawn, in the order of first drawing: object and patch.
    pub(super) patches: Vec<(Slot, PatchIndex)>,
    /// The objects of which an occluder hid more than before.
    pub(super) useful: Marks,
    pub(super) magnifier: Magnifier,
    /// One for each thread that magnified pixels at the same time.
    pub(super) hands: Vec<Hand>,
    /// For each candidate, whether the second test found it hidden.
    pub(super) hidden: Vec<bool>,
    /// Occluders that were of use in the second test only.
    pub(super) used: UsedFinely,
    /// The objects whose occluders were offered in a run on static objects only.
    pub(crate) offered: Offered,
    pub(crate) coherence: Coherence,
}

impl PointScratch {
    /// Forgets the last query. `slots` and `patches` are the numbers of those of the scene, and
    /// `epoch` the number of the query, which starts at 1 again when it has reached its greatest
    /// value.
    pub(super) fn begin(&mut self, slots: usize, patches: usize, epoch: u32) {
        self.useful.begin(slots);
        self.candidates.clear();
        self.movers.clear();
        self.waiting.iter_mut().for_each(Waiting::clear);
        self.patches.clear();
        self.buffers.begin_patches();
        self.offered.clear();
        self.drawn.grow(patches);
        if epoch == 1 {
            self.drawn.clear();
        }
    }

    /// Whether a box in world units is hidden by the occluders drawn so far.
    pub(crate) fn hides(&self, bounds: &Block) -> bool {
        self.buffers.hides(&self.buffers.relative(bounds))
    }

    /// Whether a box relative to the origin is smaller than some pixels.
    pub(super) fn is_small(&self, b: &Block, pixels: f64) -> bool {
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
