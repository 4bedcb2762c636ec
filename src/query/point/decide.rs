//! The second test of objects, and its refinement.

use casca_slots::Slot;

use crate::object::Bounds;
use crate::occlusion::buffers::Verdict;
use crate::occlusion::examine::{Effort, Examination};
use crate::occlusion::magnify::budget::{Budget, Purse};
use crate::occlusion::magnify::{Hand, Magnifier, Redrawable};
use crate::occlusion::target::Target;
use crate::query::point::PointWalk;
use crate::query::point::scratch::{Candidate, WalkScratch};

impl PointWalk<'_> {
    /// Whether an object that was visible in the last run stays so unless the buffers hide it at
    /// once.
    fn stays(&self, candidate: &Candidate) -> bool {
        let (coherence, slot) = (self.drawing.coherence(), candidate.slot);
        self.run.coherent && coherence.saw(slot) && !coherence.is_turn(slot.get())
    }

    /// Tests all candidates again, with every occluder drawn, and refines the undecided ones.
    pub(super) fn decide(&mut self) {
        let mut candidates = std::mem::take(&mut self.scratch.candidates);
        let given = u64::from(self.run.options.refine_budget);
        let mut left = Budget { squares: given, patches: Purse::Own(self.run.options.refine_patches) };
        self.scratch.used.clear();
        self.begin_examinations();
        self.examine_all(&candidates, &mut left);
        if self.run.coherent {
            self.decide_coherent(&mut candidates, &mut left);
            candidates.iter().for_each(|candidate| self.pvs.push(self.run.scene.id(candidate.slot)));
        } else {
            self.push_seen(&candidates);
        }
        candidates.clear();
        self.end_examinations();
        self.stats.refine_squares = given - left.squares;
        self.scratch.candidates = candidates;
    }

    /// Leaves those candidates that may be seen after the second test. Some are tested once more.
    fn decide_coherent(&mut self, candidates: &mut Vec<Candidate>, left: &mut Budget) {
        let mut suspicious = std::mem::take(&mut self.scratch.suspicious);
        suspicious.clear();
        let coherence = self.drawing.coherence();
        let mut hidden = self.scratch.hidden.iter();
        candidates.retain(|candidate| {
            let seen = hidden.next() != Some(&true);
            let slot = candidate.slot;
            if seen && coherence.hid(slot, candidate.block.as_ref()) {
                suspicious.push(slot);
            }
            seen
        });
        suspicious.sort_unstable();
        let is_suspicious = |candidate: &Candidate| suspicious.binary_search(&candidate.slot).is_ok();
        let blocks = candidates.iter().filter(|c| is_suspicious(c)).filter_map(|c| c.block);
        if !suspicious.is_empty() && self.drawing.draw_before(blocks) {
            self.end_examinations();
            self.begin_examinations();
            let again: Vec<Candidate> = candidates.iter().filter(|c| is_suspicious(c)).copied().collect();
            self.examine_all(&again, left);
            let mut hidden = self.scratch.hidden.iter();
            candidates.retain(|candidate| !is_suspicious(candidate) || hidden.next() != Some(&true));
        }
        self.scratch.suspicious = suspicious;
    }

    /// Adds to the set all candidates that the last examination found visible, in the order in
    /// which they were found, and the small moving objects that needed none.
    fn push_seen(&mut self, candidates: &[Candidate]) {
        for (at, candidate) in candidates.iter().enumerate() {
            // One that was not examined is visible.
            if self.scratch.hidden.get(at) != Some(&true) {
                self.pvs.push(self.run.scene.id(candidate.slot));
            }
        }
        self.stats.occlusion_tests += self.scratch.movers.len() as u32;
        self.scratch.movers.iter().for_each(|&id| self.pvs.push(id));
    }

    /// Forgets magnified pixels: occluders were drawn.
    pub(super) fn begin_examinations(&mut self) {
        let WalkScratch { magnifier, hands, .. } = &mut *self.scratch;
        if hands.is_empty() {
            hands.push(Hand::default());
        }
        magnifier.clear(hands, self.drawing.buffers());
    }

    /// Notes which occluders were of use in magnified pixels, before those are forgotten.
    pub(super) fn end_examinations(&mut self) {
        let WalkScratch { magnifier, hands, used, .. } = &mut *self.scratch;
        self.stats.refine_patches += magnifier.cost(hands);
        if self.run.coherent {
            magnifier.used(hands, self.drawing.buffers(), used);
        }
    }

    /// Tests candidates again, and notes which of them are hidden.
    pub(super) fn examine_all(&mut self, candidates: &[Candidate], left: &mut Budget) {
        let mut hidden = std::mem::take(&mut self.scratch.hidden);
        hidden.clear();
        #[cfg(feature = "rayon")]
        if self.run.is_parallel() {
            self.share(candidates, left, &mut hidden);
        }
        self.examine_in_order(candidates, left, &mut hidden);
        self.scratch.hidden = hidden;
    }

    /// Tests candidates again by this thread, from the first on of which it is not noted whether it
    /// is hidden.
    pub(super) fn examine_in_order(
        &mut self,
        candidates: &[Candidate],
        left: &mut Budget,
        hidden: &mut Vec<bool>,
    ) {
        let Some(mut hand) = self.scratch.hands.pop() else { return };
        let magnifier = std::mem::take(&mut self.scratch.magnifier);
        for candidate in &candidates[hidden.len()..] {
            let before = (left.squares, left.patches.left());
            let is_hidden = self.examine(candidate, (&magnifier, &mut hand), left);
            self.count(candidate, is_hidden, before != (left.squares, left.patches.left()));
            self.scratch.used.solids.append(&mut hand.compared);
            hidden.push(is_hidden);
        }
        self.scratch.magnifier = magnifier;
        self.scratch.hands.push(hand);
    }

    /// Counts a candidate that was tested again.
    pub(super) fn count(&mut self, candidate: &Candidate, hidden: bool, refined: bool) {
        self.stats.occlusion_tests += u32::from(candidate.block.is_some() || self.stays(candidate));
        self.stats.refined += u32::from(refined);
        self.stats.refined_hidden += u32::from(hidden && refined);
    }

    /// Whether a candidate turns out to be hidden. Several threads may ask at once.
    pub(super) fn examine(
        &self,
        candidate: &Candidate,
        (magnifier, hand): (&Magnifier, &mut Hand),
        left: &mut Budget,
    ) -> bool {
        let &Candidate { slot, block: Some(block), is_centered, .. } = candidate else { return false };
        if self.stays(candidate) {
            return self.hides(&block);
        }
        let middle = (block.min + block.max) * 0.5 - self.drawing.buffers().origin();
        // Most candidates can be seen plainly.
        if is_centered && self.drawing.buffers().shows_plainly(middle, slot) {
            return false;
        }
        let bounds = self.run.scene.object(slot).bounds();
        self.is_hidden(bounds, slot, (magnifier, hand), left)
    }

    /// Whether no point of an object can be seen, with all occluders drawn.
    fn is_hidden(
        &self,
        bounds: &Bounds,
        slot: Slot,
        (magnifier, hand): (&Magnifier, &mut Hand),
        budget: &mut Budget,
    ) -> bool {
        let buffers = self.drawing.buffers();
        let (origin, direction) = (buffers.origin(), buffers.direction());
        let effort =
            Effort { squares: self.run.options.refine_squares, depth: self.run.options.refine_depth };
        let refines = effort.squares > 0 || self.run.options.refine_patches > 0;
        if let Some(middle) = bounds.kind().middle_of_parts() {
            if self.hides(&bounds.block()) {
                return true;
            }
            // A quick way to find objects that are plainly in sight, or hardly hidden.
            if buffers.shows(middle - origin, slot) || refines && !effort.is_worth(buffers, bounds) {
                return false;
            }
        }
        // Parts of meshes cannot be grown by the uncertainty of the eye; their box can.
        let in_parts = buffers.uncertainty() == 0.0;
        // Then any examination finds it.
        if in_parts && bounds.kind().any_part(origin, &mut |part| buffers.shows_plainly(part.middle(), slot))
        {
            return false;
        }
        let patches = Redrawable { drawable: |id: u32| self.drawing.drawn_patch(id) };
        let mut target = std::mem::take(&mut hand.target);
        let mut examination = Examination { buffers, magnifier, hand, patches: &patches, effort, budget };
        let mut hidden = |target: &Target| {
            if refines {
                return examination.hides(target, slot);
            }
            buffers.test(target, &mut examination.hand.on_face) == Verdict::Hidden
        };
        let parts = match in_parts {
            true => bounds.kind().all_parts(origin, &mut |part| {
                let block = part.bounds();
                buffers.hides(&block) || {
                    target.set_part(part, block, direction);
                    hidden(&target)
                }
            }),
            false => None,
        };
        let is_hidden = parts.unwrap_or_else(|| {
            target.set_body(&bounds.kind().outer(origin, buffers.uncertainty()), direction);
            hidden(&target)
        });
        examination.hand.target = target;
        is_hidden
    }
}
