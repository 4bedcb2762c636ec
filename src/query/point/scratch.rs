//! The memory of the point method.

use casca_slots::Slot;
use glam::IVec3;

use crate::geometry::Block;
use crate::id::ObjectId;
use crate::occlusion::magnify::{Hand, Magnifier, UsedFinely};
use crate::query::point::drawing::DrawingScratch;

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

/// The memory of the point method, reused from query to query.
#[derive(Debug, Clone, Default)]
pub(crate) struct PointScratch {
    pub(super) drawing: DrawingScratch,
    pub(super) walk: WalkScratch,
}

/// The memory of finding objects and of testing them again.
#[derive(Debug, Clone, Default)]
pub(crate) struct WalkScratch {
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
    pub(super) magnifier: Magnifier,
    /// One for each thread that magnified pixels at the same time.
    pub(super) hands: Vec<Hand>,
    /// For each candidate, whether the second test found it hidden.
    pub(super) hidden: Vec<bool>,
    /// Occluders that were of use in the second test only.
    pub(super) used: UsedFinely,
    /// Slots of objects that came into sight, though the last view could have seen them.
    pub(super) suspicious: Vec<Slot>,
}

impl PointScratch {
    /// The buffers of the last run, and what was drawn in them.
    pub(crate) fn drawn(&self) -> &DrawingScratch {
        &self.drawing
    }

    /// Forgets the runs that a coherent one builds on.
    pub(crate) fn reset(&mut self) {
        self.drawing.reset();
    }
}

impl WalkScratch {
    /// Forgets the last query.
    pub(super) fn begin(&mut self) {
        self.candidates.clear();
        self.movers.clear();
    }
}
