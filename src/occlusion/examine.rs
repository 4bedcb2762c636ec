//! The second test of a target, when all occluders are drawn.
//!
//! Each pixel that the buffers leave open is magnified, and the convex occluders in those of its
//! finer pixels that stay open are compared with the target.
//!
//! The answer follows from the target and the occluders drawn: the buffers do not change meanwhile,
//! and magnified pixels do not depend on the targets that asked for them. So the order of targets
//! does not matter, until a budget of the whole query is used up, and several threads may examine
//! targets at once, each with a [`Hand`] of its own.

use casca_slots::Slot;

use crate::geometry::polytope::Part;
use crate::method::PointOptions;
use crate::object::Bounds;
use crate::occlusion::buffers::OcclusionBuffers;
use crate::occlusion::magnify::budget::Budget;
use crate::occlusion::magnify::{Hand, Magnifier};
use crate::occlusion::refine::Search;
use crate::occlusion::target::Target;

/// The limits of refinement for one target.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Effort {
    /// Directions and squares examined for one target, at most.
    pub(crate) squares: u32,
    /// How often a pixel is halved, at most.
    pub(crate) depth: u32,
}

impl Effort {
    /// Whether a mesh may well turn out to be hidden: in a box with few open pixels, or in parts
    /// that have no corner in an open one.
    pub(crate) fn is_worth(self, buffers: &OcclusionBuffers, bounds: &Bounds) -> bool {
        let block = buffers.relative(&bounds.block());
        let most = self.pixels(FEW_OPEN) as u64;
        let mut is_closed = |part: &Part| part.corners().all(|corner| !buffers.leaves_open(corner));
        buffers.faces().all(|face| face.few_open(&block, most))
            || bounds.kind().all_parts(buffers.origin(), &mut is_closed) == Some(true)
    }

    /// The most open pixels of a target on one face, if `most` are for the default squares.
    fn pixels(&self, most: usize) -> usize {
        most.max(most.saturating_mul(self.squares as usize) / SQUARES as usize)
    }
}

/// Directions tried for one target on one face.
const DIRECTIONS: u32 = 8;

/// A target with more open pixels than this on one face is taken to be visible, even if none of
/// them shows it for certain. With many squares, [`SQUARES`] decides.
const PIXELS: usize = 64;

/// So is one with more open pixels than this where patches of triangles were drawn: to magnify
/// those costs more.
const PATCHED: usize = 12;

/// A mesh with `n` open pixels among the `m` of the rectangle around its box turns out to be hidden
/// about once in `1 + n * n / m` times. Those with a greater `n * n / m` than this are taken to be
/// visible: it is about what a hidden object is worth, over what an examination costs.
const FEW_OPEN: usize = 6;

/// These squares for one target, the default, allow it [`PIXELS`] open pixels, and more squares
/// allow more in proportion. The finer pixels that go with more squares are also more in number for
/// the same part of a target.
const SQUARES: u32 = PointOptions::new().refine_squares;

/// The examination of one target.
pub(crate) struct Examination<'a, 'p> {
    pub(crate) buffers: &'a OcclusionBuffers,
    pub(crate) magnifier: &'a Magnifier,
    pub(crate) hand: &'a mut Hand,
    pub(crate) effort: Effort,
    pub(crate) budget: &'a mut Budget<'p>,
}

impl Examination<'_, '_> {
    /// Whether a target is hidden for certain. `owner` is its object.
    pub(crate) fn hides(&mut self, target: &Target, owner: Slot) -> bool {
        if self.buffers.is_close(target.bounds()) {
            return false;
        }
        let buffers = self.buffers;
        let mut left = self.effort.squares;
        let (mut on_face, mut open) =
            (std::mem::take(&mut self.hand.on_face), std::mem::take(&mut self.hand.open));
        let hidden = buffers.faces().enumerate().all(|(face, buffer)| {
            if !target.on_face(buffer.face(), &mut on_face) {
                return true;
            }
            let rest = self.budget.squares.min(u64::from(u32::MAX)) as u32;
            let mut search = Search::new(buffer, &on_face, owner, left.min(rest), self.effort.depth);
            let before = search.squares;
            let hidden = self.hides_on_face(&mut search, face, &mut open);
            left -= before - search.squares;
            self.budget.squares = self.budget.squares.saturating_sub(search.spent);
            hidden
        });
        (self.hand.on_face, self.hand.open) = (on_face, open);
        hidden
    }

    fn hides_on_face(&mut self, search: &mut Search, face: usize, open: &mut Vec<(i64, i64)>) -> bool {
        self.find_open(search, open) && open.iter().all(|&pixel| self.hides_in_pixel(search, face, pixel))
    }

    /// Finds the pixels that leave the target undecided. Returns false if it is seen, or if they are
    /// too many.
    fn find_open(&self, search: &mut Search, open: &mut Vec<(i64, i64)>) -> bool {
        open.clear();
        let (mut seen, mut tries) = (false, 0);
        let (buffer, on_face) = (search.buffer, search.target);
        let (most, most_patched) = (self.effort.pixels(PIXELS), self.effort.pixels(PATCHED));
        buffer.uncovered(on_face, |x, y, rect| {
            let (u, v) = ((rect.u0 + rect.u1) * 0.5, (rect.v0 + rect.v1) * 0.5);
            if tries < DIRECTIONS && on_face.silhouette.holds(u, v) {
                tries += 1;
                seen = search.direction_is_seen(u, v, (x, y));
            }
            open.push((x, y));
            let patched = open.len() > most_patched && buffer.has_patches((x, y));
            seen |= patched || open.len() > most;
            seen
        });
        !seen
    }

    /// Whether the target is hidden in a pixel, which is magnified.
    fn hides_in_pixel(&mut self, search: &mut Search, face: usize, pixel: (i64, i64)) -> bool {
        let with = (&mut *self.hand, &mut self.budget.patches);
        let magnified = self.magnifier.magnify(self.buffers, (face, search.buffer), pixel, with);
        let Some(open) = magnified.search(search.target) else { return true };
        if search.squares == 0 || magnified.solids.is_empty() {
            return false;
        }
        let mut candidates = std::mem::take(&mut self.hand.candidates);
        let contest = search.contest(magnified.solids, &open, &mut candidates);
        let hidden = search.is_covered(&open, &contest);
        if hidden {
            self.hand.compared.extend(contest.owners());
        }
        self.hand.candidates = candidates;
        hidden
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::Block;
    use crate::geometry::body::Body;
    use crate::occlusion::magnify::budget::Purse;
    use crate::occlusion::pitch::Pitch;
    use crate::occlusion::target::FaceTarget;
    use crate::random::Random;
    use crate::view::View;

    /// Three shares of one.
    fn shares(random: &mut Random) -> DVec3 {
        DVec3::new(random.next(), random.next(), random.next())
    }

    /// A box in front of the eye, between two depths.
    fn block_at(random: &mut Random, (near, far): (f64, f64), size: f64) -> Block {
        let depth = random.within(near, far);
        let at = (shares(random) - 0.5) * DVec3::new(0.8, 0.8, 0.0) * depth + DVec3::Z * depth;
        let half = shares(random) * size * depth + 0.001;
        Block { min: at - half, max: at + half }
    }

    /// Whether a segment from the origin meets a box before its end.
    fn meets(b: &Block, end: DVec3) -> bool {
        let (x, y) = (b.min / end, b.max / end);
        x.min(y).max_element().max(0.0) <= x.max(y).min_element().min(1.0)
    }

    #[test]
    fn shared_pixels_hide_only_what_rays_find_behind_occluders() {
        let view = View::omnidirectional(glam::Vec3::ZERO).unwrap();
        let pitch = Pitch { pixels: 32.0, least: 0.0, nearest: 1e-3, radius: 40.0, middle: DVec3::ZERO };
        let effort = Effort { squares: 256, depth: 6 };
        let mut random = Random::new(11);
        let (mut buffers, mut magnifier) = (OcclusionBuffers::default(), Magnifier::default());
        let mut hand = Hand::default();
        let (mut hidden, mut gained) = (0, 0);
        for _ in 0..30 {
            buffers.begin(&view, &pitch);
            let occluders: Vec<Block> = (0..60).map(|_| block_at(&mut random, (2.0, 6.0), 0.12)).collect();
            for (i, block) in occluders.iter().enumerate() {
                buffers.draw_body(&Body::Block(*block), Slot::new(i as u32)).unwrap();
            }
            magnifier.clear(std::slice::from_mut(&mut hand), &buffers);
            let mut budget = Budget { squares: 1 << 20, patches: Purse::Own(0) };
            for _ in 0..200 {
                let block = block_at(&mut random, (6.5, 12.0), 0.03);
                let target = Target::block(block, None);
                let coarse = buffers.test(&target, &mut FaceTarget::default())
                    == crate::occlusion::buffers::Verdict::Hidden;
                let mut examination = Examination {
                    buffers: &buffers,
                    magnifier: &magnifier,
                    hand: &mut hand,
                    effort,
                    budget: &mut budget,
                };
                let proven = examination.hides(&target, Slot::new(u32::MAX));
                assert!(proven || !coarse, "{block:?}");
                if !proven {
                    continue;
                }
                hidden += 1;
                gained += u32::from(!coarse);
                for _ in 0..40 {
                    let end = block.min + shares(&mut random) * (block.max - block.min);
                    assert!(occluders.iter().any(|o| meets(o, end)), "{block:?} {end}");
                }
            }
        }
        assert!(hidden > 1000 && gained > 200, "{hidden} {gained}");
    }
}
