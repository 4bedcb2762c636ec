//! The second test of objects, and its refinement.

use casca_slots::Slot;

use crate::object::Bounds;
use crate::occlusion::buffers::Verdict;
use crate::occlusion::examine::{Budget, Effort, Examination};
use crate::occlusion::magnify::{Magnifier, Patches};
use crate::occlusion::target::Target;
use crate::query::point::Walk;
use crate::query::point::scratch::Candidate;

impl Walk<'_> {
    /// Tests all candidates again, with every occluder drawn, and refines the undecided ones.
    pub(super) fn decide(&mut self) {
        let mut candidates = std::mem::take(&mut self.scratch.candidates);
        let mut left =
            Budget { squares: u64::from(self.options.refine_budget), patches: self.options.refine_patches };
        let given = left;
        self.scratch.magnifier.used.clear();
        self.begin_examinations();
        if self.coherent {
            self.decide_coherent(&mut candidates, &mut left);
            candidates.drain(..).for_each(|candidate| self.pvs.push(candidate.id));
        } else {
            let mut movers = std::mem::take(&mut self.scratch.movers);
            if !movers.is_empty() {
                self.scratch.buffers.read_clear();
            }
            let mut waiting = movers.drain(..).peekable();
            for (at, candidate) in candidates.drain(..).enumerate() {
                while let Some(mover) = waiting.next_if(|mover| mover.is_before(at)) {
                    self.decide_mover(&mover, &mut left);
                }
                if !self.examine(&candidate, &mut left) {
                    self.pvs.push(candidate.id);
                }
            }
            waiting.for_each(|mover| self.decide_mover(&mover, &mut left));
            self.scratch.movers = movers;
        }
        self.stats.refine_squares = given.squares - left.squares;
        self.stats.refine_patches = given.patches - left.patches;
        self.scratch.candidates = candidates;
    }

    /// Forgets magnified pixels: occluders were drawn.
    pub(super) fn begin_examinations(&mut self) {
        self.scratch.magnifier.begin(&self.scratch.buffers);
    }

    /// Whether a candidate turns out to be hidden.
    pub(super) fn examine(&mut self, candidate: &Candidate, left: &mut Budget) -> bool {
        let &Candidate { id, block: Some(block), is_centered, .. } = candidate else { return false };
        let middle = (block.min + block.max) * 0.5 - self.scratch.buffers.origin();
        self.stats.occlusion_tests += 1;
        // Most candidates can be seen plainly.
        if is_centered && self.scratch.buffers.shows_plainly(middle, id.slot()) {
            return false;
        }
        let before = *left;
        let bounds = self.scene.object(id.slot()).bounds();
        let mut magnifier = std::mem::take(&mut self.scratch.magnifier);
        let hidden = self.is_hidden(bounds, id.slot(), &mut magnifier, left);
        self.scratch.magnifier = magnifier;
        self.stats.refined += u32::from(*left != before);
        self.stats.refined_hidden += u32::from(hidden && *left != before);
        hidden
    }

    /// Whether no point of an object can be seen, with all occluders drawn.
    fn is_hidden(&self, bounds: &Bounds, slot: Slot, magnifier: &mut Magnifier, budget: &mut Budget) -> bool {
        let buffers = &self.scratch.buffers;
        let effort = Effort { squares: self.options.refine_squares, depth: self.options.refine_depth };
        let drawable = |id: u32| {
            let (slot, patch) = self.scratch.patches[id as usize];
            self.drawable(slot, patch)
        };
        let patches = Patches { drawable };
        let mut examination = Examination { buffers, magnifier, patches: &patches, effort, budget };
        let mut hidden = |target: &Target| {
            if effort.squares == 0 && self.options.refine_patches == 0 {
                buffers.test(target) == Verdict::Hidden
            } else {
                examination.hides(target, slot)
            }
        };
        let (origin, direction) = (buffers.origin(), buffers.direction());
        if let Some(middle) = bounds.kind().middle_of_parts() {
            if self.hides(&bounds.block()) {
                return true;
            }
            // A quick way to find objects that are plainly in sight.
            if buffers.shows(middle - origin, slot) {
                return false;
            }
        }
        // Parts of meshes cannot be grown by the uncertainty of the eye; their box can.
        let parts = if buffers.uncertainty() == 0.0 {
            // Then any examination finds it.
            if bounds.kind().any_part(origin, &mut |part| buffers.shows_plainly(part.middle(), slot)) {
                return false;
            }
            bounds.kind().all_parts(origin, &mut |part| {
                let block = part.bounds();
                buffers.hides(&block) || hidden(&Target::part(part, block, direction))
            })
        } else {
            None
        };
        parts.unwrap_or_else(|| {
            hidden(&Target::new(bounds.kind().outer(origin, buffers.uncertainty()), direction))
        })
    }
}
