//! Local refinement: in undecided pixels, silhouettes are compared directly.
//!
//! A target that uncovered pixels show is examined in those pixels again. First the middles of some pixels: a
//! direction that hits the target before any occluder proves the target visible and ends the search. Then
//! squares, from the pixel down: a square is covered if one silhouette contains it and hides the target there, or
//! if the target does not reach it; otherwise it is cut into four. The budget counts directions and squares, not
//! time, so that results are the same on all machines.

use smallvec::SmallVec;

use crate::numeric::occlusion::below;
use crate::occlusion::buffers::{OcclusionBuffers, Verdict};
use crate::occlusion::face::Rect;
use crate::occlusion::face_buffer::{FaceBuffer, Listed};
use crate::occlusion::target::{FaceTarget, Target};

/// The limits of refinement for one target.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Effort {
    /// Directions and squares examined for one target, at most.
    pub(crate) squares: u32,
    /// How often a pixel is halved, at most.
    pub(crate) depth: u32,
}

/// Directions tried for one target on one face before squares.
const DIRECTIONS: u32 = 16;

/// A target with this many uncovered pixels on one face (or a quarter of the squares allowed, if that is more) is
/// taken to be visible, even if none of them shows it for certain.
const PIXELS: usize = 64;

/// Going through this many listed occluders costs as much as a square, so that the budget bounds the time also
/// where thousands are listed in one place.
const LISTED: usize = 64;

/// One occluder that may hide the target.
#[derive(Clone, Copy)]
struct Candidate {
    listed: Listed,
    /// All of the target lies behind its front.
    behind: bool,
}

struct Search<'a> {
    buffer: &'a FaceBuffer,
    target: &'a FaceTarget,
    /// The object of the target, whose own occluder does not hide it.
    owner: u32,
    squares: u32,
    depth: u32,
}

/// The cost of testing one direction against all listed occluders, in squares.
fn price(listed: &[Listed]) -> u32 {
    1 + (listed.len() / LISTED) as u32
}

impl OcclusionBuffers {
    /// Tests a target as [`OcclusionBuffers::test`] does, and examines uncovered pixels again.
    /// The directions and squares examined are taken from `budget`; when that is spent, the pixels decide.
    pub(crate) fn refine(&self, target: &Target, owner: u32, effort: &Effort, budget: &mut u64) -> Verdict {
        if self.is_close(target.bounds()) {
            return Verdict::Visible;
        }
        let given = effort.squares.min((*budget).min(u64::from(u32::MAX)) as u32);
        let mut squares = given;
        let mut verdict = Verdict::Hidden;
        for buffer in self.faces() {
            let Some(on_face) = target.on_face(buffer.face()) else { continue };
            let mut search = Search { buffer, target: &on_face, owner, squares, depth: effort.depth };
            if !search.is_hidden(self, target) {
                verdict = Verdict::Visible;
            }
            squares = search.squares;
            if verdict == Verdict::Visible {
                break;
            }
        }
        *budget -= u64::from(given - squares);
        verdict
    }
}

impl Search<'_> {
    fn is_hidden(&mut self, buffers: &OcclusionBuffers, target: &Target) -> bool {
        if self.squares > 0 && self.middle_is_seen(target) {
            return false;
        }
        let most = PIXELS.max(self.squares as usize / 4);
        let mut open: SmallVec<[Rect; PIXELS]> = SmallVec::new();
        let (mut seen, mut tries) = (false, 0);
        self.buffer.uncovered(self.target, |x, y, rect| {
            let (u, v) = ((rect.u0 + rect.u1) * 0.5, (rect.v0 + rect.v1) * 0.5);
            if tries < DIRECTIONS && self.squares > 0 && self.target.silhouette.holds(u, v) {
                tries += 1;
                let listed = self.buffer.occluders().list(self.buffer.occluders().index(x, y));
                self.squares = self.squares.saturating_sub(price(listed));
                seen = self.is_seen(u, v, listed);
            }
            let full = open.len() == most;
            if !full {
                open.push(*rect);
            }
            seen || full || self.squares == 0
        });
        if seen || self.squares == 0 || open.is_empty() || open.len() == most {
            return open.is_empty();
        }
        let all = open.iter().skip(1).fold(open[0], |all, r| Rect {
            u0: all.u0.min(r.u0),
            v0: all.v0.min(r.v0),
            u1: all.u1.max(r.u1),
            v1: all.v1.max(r.v1),
        });
        let mut gathered: (usize, SmallVec<[Candidate; 16]>) = (usize::MAX, SmallVec::new());
        open.iter().all(|rect| {
            let bin = self.bin_of(rect);
            if gathered.0 != bin {
                self.squares = self.squares.saturating_sub(price(self.buffer.occluders().list(bin)) - 1);
                gathered = (bin, self.candidates(buffers, target, bin, &all));
            }
            let touching = |c: &&Candidate| self.buffer.drawn(&c.listed).silhouette.touches(rect);
            let candidates: SmallVec<[Candidate; 16]> = gathered.1.iter().filter(touching).copied().collect();
            self.covered(rect, &candidates, 0)
        })
    }

    /// The number of the bin at the corner of a rectangle.
    fn bin_of(&self, rect: &Rect) -> usize {
        let (x, y) = self.buffer.window().corner_of(rect);
        self.buffer.occluders().index(x, y)
    }

    /// The occluders of a bin that may hide the target in a rectangle.
    fn candidates(
        &self,
        buffers: &OcclusionBuffers,
        target: &Target,
        bin: usize,
        rect: &Rect,
    ) -> SmallVec<[Candidate; 16]> {
        let mut found = SmallVec::new();
        for listed in self.buffer.occluders().list(bin) {
            let d = self.buffer.drawn(listed);
            // An occluder that is nowhere nearer than the target's nearest point hides at most a part of it.
            if listed.near > self.target.near && d.owner != self.owner && d.silhouette.touches(rect) {
                let behind = target.is_behind(buffers.shadow(d.solid));
                found.push(Candidate { listed: *listed, behind });
            }
        }
        found
    }

    /// Tries the direction to the target's middle.
    fn middle_is_seen(&mut self, target: &Target) -> bool {
        let p = self.buffer.face().local(target.middle());
        let (u, v) = if self.buffer.face().parallel { (p.x, p.y) } else { (p.x / p.z, p.y / p.z) };
        let bounds = self.buffer.bounds();
        let inside = u >= bounds.u0 && u < bounds.u1 && v >= bounds.v0 && v < bounds.v1;
        if (!self.buffer.face().parallel && p.z <= 0.0) || !inside || !self.target.silhouette.holds(u, v) {
            return false;
        }
        let point = Rect { u0: u, v0: v, u1: u, v1: v };
        // Triangles are known by the pixels that they cover only.
        if self.buffer.hides(&point, self.target.near(&point)) {
            return false;
        }
        let listed = self.buffer.occluders().list(self.bin_of(&point));
        self.squares = self.squares.saturating_sub(price(listed));
        self.is_seen(u, v, listed)
    }

    /// Whether the candidates surely hide the target in a square.
    fn covered(&mut self, rect: &Rect, candidates: &[Candidate], level: u32) -> bool {
        if self.squares == 0 || candidates.is_empty() {
            return false;
        }
        self.squares -= 1;
        let mut rest: SmallVec<[Candidate; 16]> = SmallVec::new();
        let mut near = None;
        for &c in candidates {
            let d = self.buffer.drawn(&c.listed);
            if level > 0 && !d.silhouette.touches(rect) {
                continue;
            }
            if d.silhouette.covers(rect) {
                let mut nearer = || {
                    below(d.front.behind_inside(rect)) >= *near.get_or_insert_with(|| self.target.near(rect))
                };
                if c.behind || nearer() {
                    return true;
                }
            }
            rest.push(c);
        }
        if rest.is_empty() || level == self.depth {
            return false;
        }
        let (u, v) = ((rect.u0 + rect.u1) * 0.5, (rect.v0 + rect.v1) * 0.5);
        if self.target.silhouette.holds(u, v) && self.is_seen(u, v, rest.iter().map(|c| &c.listed)) {
            return false;
        }
        let quarters = [
            Rect { u1: u, v1: v, ..*rect },
            Rect { u0: u, v1: v, ..*rect },
            Rect { u1: u, v0: v, ..*rect },
            Rect { u0: u, v0: v, ..*rect },
        ];
        quarters.iter().all(|q| {
            !self.target.silhouette.touches(q)
                || self.buffer.halves().iter().any(|h| h.most(q) < 0.0)
                || self.covered(q, &rest, level + 1)
        })
    }

    /// Whether a ray in a direction of the target's silhouette hits it inside the frustum, before any of the
    /// occluders. This is not rounded: a wrong yes makes a hidden target visible, which is safe, and a no decides
    /// nothing.
    fn is_seen<'a>(&self, u: f64, v: f64, occluders: impl IntoIterator<Item = &'a Listed>) -> bool {
        let near = self.target.at(u, v);
        self.buffer.halves().iter().all(|h| h.at(u, v) >= 0.0)
            && occluders.into_iter().all(|listed| {
                if f64::from(listed.near) <= near {
                    return true;
                }
                let d = self.buffer.drawn(listed);
                d.owner == self.owner || !d.silhouette.may_hold(u, v) || d.front.at(u, v) <= near
            })
    }
}
