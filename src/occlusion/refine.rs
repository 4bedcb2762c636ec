//! Local refinement: in undecided pixels, silhouettes are compared directly.
//!
//! A direction that hits the target before any occluder proves the target visible and ends the
//! search. A square of directions is covered if one silhouette contains it and hides the target
//! there, or if the target does not reach it; otherwise it is cut into four. The budget counts
//! directions and squares, not time, so that results are the same on all machines.

use casca_slots::Slot;

use crate::numeric::occlusion::below;
use crate::occlusion::face::Rect;
use crate::occlusion::face_buffer::{DrawnSolid, FaceBuffer, Listed};
use crate::occlusion::silhouette::LocalSilhouette;
use crate::occlusion::target::FaceTarget;

/// Going through this many listed occluders costs as much as a square, so that the budget bounds
/// the time also where thousands are listed in one place.
const LISTED: usize = 64;

/// Candidates are numbered by the bits of a word.
const CANDIDATES: usize = u64::BITS as usize;

/// One occluder that may hide the target in a pixel.
#[derive(Debug)]
pub(crate) struct PixelOccluder {
    /// Its number among those drawn on the face.
    drawn: u32,
    near: f32,
    /// The half-planes of its silhouette that matter in the pixel.
    among: u64,
}

/// A pixel in which a target is compared with the occluders that may hide it.
pub(crate) struct Contest<'a> {
    candidates: &'a [PixelOccluder],
    buffer: &'a FaceBuffer,
    /// The target's silhouette, for squares in the pixel.
    target: LocalSilhouette<'a>,
}

impl Contest<'_> {
    /// The objects of the occluders.
    pub(crate) fn owners(&self) -> impl Iterator<Item = Slot> {
        self.candidates.iter().map(|candidate| self.buffer.drawn(candidate.drawn).owner)
    }

    /// A candidate as drawn, and its silhouette, for squares in the pixel.
    #[inline]
    fn drawn(&self, candidate: &PixelOccluder) -> (&DrawnSolid, LocalSilhouette<'_>) {
        let drawn = self.buffer.drawn(candidate.drawn);
        (drawn, drawn.silhouette.local(candidate.among))
    }
}

/// The search for a visible part of one target on one face.
pub(crate) struct Search<'a> {
    pub(crate) buffer: &'a FaceBuffer,
    pub(crate) target: &'a FaceTarget,
    /// The object of the target, whose own occluder does not hide it.
    pub(crate) owner: Slot,
    /// Directions and squares that may still be examined.
    pub(crate) squares: u32,
    /// How often a square may be halved.
    depth: u32,
    /// Directions and squares examined so far.
    pub(crate) spent: u64,
}

impl<'a> Search<'a> {
    pub(crate) fn new(
        buffer: &'a FaceBuffer,
        target: &'a FaceTarget,
        owner: Slot,
        squares: u32,
        depth: u32,
    ) -> Self {
        Self { buffer, target, owner, squares, depth, spent: 0 }
    }

    /// Takes squares from the budget.
    fn spend(&mut self, squares: u32) {
        self.squares = self.squares.saturating_sub(squares);
        self.spent += u64::from(squares);
    }

    /// Takes the cost of going through a list of occluders from the budget.
    fn pay(&mut self, listed: usize) {
        self.spend(1 + (listed / LISTED) as u32);
    }

    /// Whether a direction in a pixel shows the target for certain: patches of triangles hide all
    /// pixels that they may touch.
    pub(crate) fn direction_is_seen(&mut self, u: f64, v: f64, (x, y): (i64, i64)) -> bool {
        if self.squares == 0 || !self.target.silhouette.holds(u, v) {
            return false;
        }
        let point = Rect { u0: u, v0: v, u1: u, v1: v };
        let near = self.target.near(&point);
        if self.buffer.nearness(x, y) >= near || self.buffer.patch_may_hide((x, y), near) {
            return false;
        }
        let occluders = self.buffer.occluders();
        self.pay(occluders.len(occluders.index(x, y)));
        // A ray in a direction of the target's silhouette hits it inside the frustum, before any
        // occluder. This is not rounded: a wrong yes makes a hidden target visible, which is safe,
        // and a no decides nothing.
        self.buffer.halves().iter().all(|h| h.at(u, v) >= 0.0)
            && self.buffer.is_before((x, y), (u, v), self.target.at(u, v), self.owner)
    }

    /// Compares the target with those occluders of a list, the nearest first, that may hide it in
    /// the open part of a pixel. `candidates` is memory for them.
    pub(crate) fn contest<'c>(
        &mut self,
        list: &[Listed],
        pixel: &Rect,
        candidates: &'c mut Vec<PixelOccluder>,
    ) -> Contest<'c>
    where
        'a: 'c,
    {
        self.pay(list.len());
        // Only directions of the target need be hidden. Many targets are smaller than a pixel, and
        // most occluders of the pixel are beside them.
        let part = pixel.intersect(&self.target.rect).unwrap_or(*pixel);
        candidates.clear();
        let buffer = self.buffer;
        for listed in list {
            // An occluder that is nowhere nearer than the target's nearest point hides at most a
            // part of it.
            if listed.near <= self.target.near {
                break;
            }
            if !listed.rect.overlaps(&part) {
                continue;
            }
            let drawn = buffer.drawn(listed.drawn);
            if drawn.owner == self.owner {
                continue;
            }
            if let Some(silhouette) = drawn.silhouette.crossing(&part) {
                let (drawn, near, among) = (listed.drawn, listed.near, silhouette.among());
                candidates.push(PixelOccluder { drawn, near, among });
                if candidates.len() == CANDIDATES {
                    break;
                }
            }
        }
        let target = self.target.silhouette.crossing(pixel).unwrap_or_else(|| self.target.silhouette.whole());
        Contest { candidates, buffer, target }
    }

    /// Whether the candidates surely hide the target in the open part of a pixel.
    pub(crate) fn is_covered(&mut self, pixel: &Rect, contest: &Contest) -> bool {
        self.is_covered_by(pixel, 0, contest, u64::MAX)
    }

    /// Whether some of the candidates do so in a square of directions that was halved some times.
    fn is_covered_by(&mut self, rect: &Rect, halved: u32, contest: &Contest, among: u64) -> bool {
        if self.squares == 0 {
            return false;
        }
        self.spend(1);
        let target = self.target;
        let mut rest = 0u64;
        let mut near = None;
        for (i, c) in contest.candidates.iter().enumerate() {
            if among >> i & 1 == 0 {
                continue;
            }
            let (drawn, silhouette) = contest.drawn(c);
            if !silhouette.touches(rect) {
                continue;
            }
            if silhouette.covers(rect) {
                let near = *near.get_or_insert_with(|| target.near(rect));
                if below(drawn.front.behind_inside(rect)) >= near {
                    return true;
                }
            }
            rest |= 1 << i;
        }
        if rest == 0 || halved >= self.depth {
            return false;
        }
        let (u, v) = ((rect.u0 + rect.u1) * 0.5, (rect.v0 + rect.v1) * 0.5);
        if contest.target.holds(u, v) && self.is_open(u, v, contest, rest) {
            return false;
        }
        let quarters = [
            Rect { u1: u, v1: v, ..*rect },
            Rect { u0: u, v1: v, ..*rect },
            Rect { u1: u, v0: v, ..*rect },
            Rect { u0: u, v0: v, ..*rect },
        ];
        quarters.iter().all(|quarter| {
            !contest.target.touches(quarter)
                || self.buffer.halves().iter().any(|h| h.most(quarter) < 0.0)
                || self.is_covered_by(quarter, halved + 1, contest, rest)
        })
    }

    /// Whether a direction shows the target before some of the candidates of a pixel; see
    /// [`Search::direction_is_seen`].
    fn is_open(&self, u: f64, v: f64, contest: &Contest, among: u64) -> bool {
        let near = self.target.at(u, v);
        self.buffer.halves().iter().all(|h| h.at(u, v) >= 0.0)
            && contest.candidates.iter().enumerate().all(|(i, c)| {
                let (drawn, silhouette) = contest.drawn(c);
                among >> i & 1 == 0
                    || f64::from(c.near) <= near
                    || !silhouette.may_hold(u, v)
                    || drawn.front.at(u, v) <= near
            })
    }
}
