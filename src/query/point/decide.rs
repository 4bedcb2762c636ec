//! The second test of objects, and its refinement.

use casca_slots::Slot;

use crate::geometry::Block;
use crate::occlusion::buffers::Verdict;
use crate::occlusion::examine::{Effort, Examination};
use crate::occlusion::magnify::budget::{Budget, Purse};
use crate::occlusion::magnify::{Hand, Magnifier, UsedFinely};
use crate::occlusion::target::Target;
use crate::query::point::drawing::Drawing;

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

/// The second test of objects: owns the magnified pixels, and what was found in them.
#[derive(Debug, Clone, Default)]
pub(super) struct SecondTest {
    pub(super) magnifier: Magnifier,
    /// One for each thread that magnified pixels at the same time.
    pub(super) hands: Vec<Hand>,
    /// For each candidate, whether the test found it hidden.
    pub(super) hidden: Vec<bool>,
    /// Occluders that were of use in this test only.
    pub(super) used: UsedFinely,
    /// The slots of those in sight before this test, though the last run hid them.
    came: Vec<Slot>,
}

impl SecondTest {
    /// Tests all candidates again, with every occluder drawn, and refines the undecided ones.
    pub(super) fn decide(&mut self, drawing: &mut Drawing, candidates: &[Candidate]) {
        let given = u64::from(drawing.run.options.refine_budget);
        let mut left = Budget { squares: given, patches: Purse::Own(drawing.run.options.refine_patches) };
        self.used.clear();
        if drawing.run.coherent {
            self.draw_waiting(drawing, candidates);
        }
        self.begin(drawing);
        self.examine_all(drawing, candidates, &mut left);
        if drawing.run.coherent {
            self.decide_again(drawing, candidates, &mut left);
        }
        self.end(drawing);
        drawing.stats.refine_squares = given - left.squares;
    }

    /// The candidates that the test found visible, in the order in which they were found.
    pub(super) fn seen<'c>(&self, candidates: &'c [Candidate]) -> impl Iterator<Item = &'c Candidate> {
        // One that was not examined is visible.
        candidates.iter().enumerate().filter(|(at, _)| self.hidden.get(*at) != Some(&true)).map(|seen| seen.1)
    }

    /// Draws occluders that wait before suspicious objects, which were there when the last run hid
    /// them: before those whose middles are in sight now.
    fn draw_waiting(&mut self, drawing: &mut Drawing, candidates: &[Candidate]) {
        self.came.clear();
        if !drawing.coherence().has_waiting() {
            return;
        }
        let came = |c: &&Candidate| drawing.coherence().hid(c.slot, c.block.as_ref()) && shows(drawing, c);
        let came: Vec<&Candidate> = candidates.iter().filter(came).collect();
        self.came.extend(came.iter().map(|candidate| candidate.slot));
        self.came.sort_unstable();
        let blocks: Vec<Block> = came.iter().filter_map(|candidate| candidate.block).collect();
        drawing.draw_before(&blocks);
    }

    /// Tests suspicious objects once more that were found visible, with what waits before them drawn.
    fn decide_again(&mut self, drawing: &mut Drawing, candidates: &[Candidate], left: &mut Budget) {
        if !drawing.coherence().has_waiting() {
            return;
        }
        let is_suspicious = |&at: &usize| {
            let Candidate { slot, block, .. } = &candidates[at];
            let again = self.hidden.get(at) != Some(&true) && drawing.coherence().hid(*slot, block.as_ref());
            again && self.came.binary_search(slot).is_err()
        };
        let again: Vec<usize> = (0..candidates.len()).filter(is_suspicious).collect();
        let blocks: Vec<Block> = again.iter().filter_map(|&at| candidates[at].block).collect();
        if blocks.is_empty() || !drawing.draw_before(&blocks) {
            return;
        }
        self.end(drawing);
        self.begin(drawing);
        let first = std::mem::take(&mut self.hidden);
        let tested: Vec<Candidate> = again.iter().map(|&at| candidates[at]).collect();
        self.examine_all(drawing, &tested, left);
        let second = std::mem::replace(&mut self.hidden, first);
        again.iter().zip(second).for_each(|(&at, hidden)| self.hidden[at] = hidden);
    }

    /// Forgets magnified pixels: occluders were drawn.
    fn begin(&mut self, drawing: &Drawing) {
        if self.hands.is_empty() {
            self.hands.push(Hand::default());
        }
        self.magnifier.clear(&mut self.hands, drawing.buffers());
    }

    /// Notes which occluders were of use in magnified pixels, before those are forgotten.
    fn end(&mut self, drawing: &mut Drawing) {
        drawing.stats.refine_patches += self.magnifier.cost(&self.hands);
        if drawing.run.coherent {
            self.magnifier.used(&self.hands, drawing.buffers(), &mut self.used);
        }
    }

    /// Tests candidates again, and notes which of them are hidden.
    fn examine_all(&mut self, drawing: &mut Drawing, candidates: &[Candidate], left: &mut Budget) {
        self.hidden.clear();
        #[cfg(feature = "rayon")]
        if drawing.run.is_parallel() {
            self.share(drawing, candidates, left);
        }
        self.examine_rest(drawing, candidates, left);
    }

    /// Tests the rest of the candidates by this thread: those not noted as hidden or not.
    pub(super) fn examine_rest(
        &mut self,
        drawing: &mut Drawing,
        candidates: &[Candidate],
        left: &mut Budget,
    ) {
        let Some(hand) = self.hands.last_mut() else { return };
        for candidate in &candidates[self.hidden.len()..] {
            let before = (left.squares, left.patches.left());
            let is_hidden = examine(drawing, candidate, (&self.magnifier, hand), left);
            count(drawing, candidate, is_hidden, before != (left.squares, left.patches.left()));
            self.used.solids.append(&mut hand.compared);
            self.hidden.push(is_hidden);
        }
    }
}

/// Whether an object that was visible in the last run stays so unless the buffers hide it at once.
/// Not in results that are kept: these are found so seldom that it would stay for hundreds of frames.
fn stays(drawing: &Drawing, candidate: &Candidate) -> bool {
    drawing.run.coherent && !drawing.run.fixed_only && drawing.coherence().stays(candidate.slot)
}

/// Whether the middle of a candidate, or of one of its parts, is in an open pixel.
fn shows(drawing: &Drawing, candidate: &Candidate) -> bool {
    let &Candidate { slot, block: Some(block), is_centered, .. } = candidate else { return false };
    let of_parts = || drawing.run.scene.object(slot).bounds().kind().middle_of_parts();
    let middle = if is_centered { Some((block.min + block.max) * 0.5) } else { of_parts() };
    middle.is_some_and(|middle| drawing.buffers().shows(middle - drawing.buffers().origin(), slot))
}

/// Counts a candidate that was tested again.
pub(super) fn count(drawing: &mut Drawing, candidate: &Candidate, hidden: bool, refined: bool) {
    drawing.stats.occlusion_tests += u32::from(candidate.block.is_some() || stays(drawing, candidate));
    drawing.stats.refined += u32::from(refined);
    drawing.stats.refined_hidden += u32::from(hidden && refined);
}

/// Whether no point of a candidate can be seen, with all occluders drawn. Several threads may ask
/// at once.
pub(super) fn examine(
    drawing: &Drawing,
    candidate: &Candidate,
    (magnifier, hand): (&Magnifier, &mut Hand),
    left: &mut Budget,
) -> bool {
    let &Candidate { slot, block: Some(block), is_centered, .. } = candidate else { return false };
    if stays(drawing, candidate) {
        return drawing.hides(&block);
    }
    let buffers = drawing.buffers();
    let (origin, direction) = (buffers.origin(), buffers.direction());
    // Most candidates can be seen plainly.
    if is_centered && buffers.shows((block.min + block.max) * 0.5 - origin, slot) {
        return false;
    }
    let bounds = drawing.run.scene.object(slot).bounds();
    let options = drawing.run.options;
    let effort = Effort { squares: options.refine_squares, depth: options.refine_depth };
    let refines = effort.squares > 0 || options.refine_patches > 0;
    if bounds.kind().middle_of_parts().is_some() {
        if drawing.hides(&bounds.block()) {
            return true;
        }
        if refines && !effort.is_worth(buffers, bounds) {
            return false;
        }
    }
    // Parts of meshes cannot be grown by the uncertainty of the eye; their box can.
    let in_parts = buffers.uncertainty() == 0.0;
    let mut target = std::mem::take(&mut hand.target);
    let mut examination = Examination { buffers, magnifier, hand, effort, budget: left };
    let mut hidden = |target: &Target| {
        if refines {
            return examination.hides(target, slot);
        }
        buffers.test(target, &mut examination.hand.on_face) == Verdict::Hidden
    };
    let parts = match in_parts {
        true => bounds.kind().all_parts(origin, &mut |part| {
            let block = part.bounds();
            buffers.hides(&block)
                // Without refinement an open pixel shows the part, and a corner finds one fastest.
                || (refines || !part.corners().any(|corner| buffers.leaves_open(corner))) && {
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
