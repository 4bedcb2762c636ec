//! Local refinement: what pixels leave undecided is asked of the silhouettes.
//!
//! A target that only undecided pixels show is examined again in those pixels. A
//! square of directions is covered if one silhouette contains it and hides the target there, or the
//! target does not reach it; otherwise it is cut into four. A direction that meets the target and
//! that no nearer occluder covers proves it visible and ends the search. The budget counts
//! squares, so that results do not depend on speed.

use smallvec::SmallVec;

use super::face::Rect;
use super::target::{FaceTarget, Target, below};
use super::{FaceBuffer, OcclusionBuffers, Verdict};

/// How hard to try.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Effort {
    /// Squares examined for one target, at most.
    pub(crate) squares: u32,
    /// How often a pixel is halved, at most.
    pub(crate) depth: u32,
}

/// One occluder that may hide the target.
#[derive(Clone, Copy)]
struct Candidate {
    drawn: u32,
    /// All of the target lies behind its planes.
    behind: bool,
}

struct Search<'a> {
    buffer: &'a FaceBuffer,
    target: &'a FaceTarget,
    squares: u32,
    depth: u32,
}

impl OcclusionBuffers {
    /// Tests a target as [`OcclusionBuffers::test`] does, and examines undecided pixels again.
    /// Takes what it uses from `budget`.
    pub(crate) fn refine(&self, target: &Target, effort: &Effort, budget: &mut u64) -> Verdict {
        if !(target.chessboard_distance() > self.nearest) && self.direction.is_none() {
            return Verdict::Visible;
        }
        let mut squares = effort.squares.min((*budget).min(u64::from(u32::MAX)) as u32);
        let given = squares;
        let mut verdict = Verdict::Hidden;
        let mut known: SmallVec<[(u32, bool); 16]> = SmallVec::new();
        for buffer in self.faces.iter().filter(|b| b.active) {
            let Some(on_face) = target.on_face(&buffer.face) else { continue };
            known.clear();
            let mut search = Search { buffer, target: &on_face, squares, depth: effort.depth };
            buffer.uncovered(&on_face, |x, y, rect| {
                let mut candidates: SmallVec<[Candidate; 16]> = SmallVec::new();
                for &drawn in buffer.bin(x, y) {
                    let d = &buffer.drawn[drawn as usize];
                    if !d.silhouette.touches(rect) {
                        continue;
                    }
                    let behind = match known.iter().find(|(k, _)| *k == drawn) {
                        Some(&(_, behind)) => behind,
                        None => {
                            let behind = target.is_behind(&self.fronts[d.solid as usize]);
                            known.push((drawn, behind));
                            behind
                        }
                    };
                    candidates.push(Candidate { drawn, behind });
                }
                if !search.covered(rect, &candidates, 0) {
                    verdict = Verdict::Visible;
                }
                verdict == Verdict::Visible
            });
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
    /// Whether the candidates surely hide the target in a square.
    fn covered(&mut self, rect: &Rect, candidates: &[Candidate], level: u32) -> bool {
        if self.squares == 0 || candidates.is_empty() {
            return false;
        }
        self.squares -= 1;
        let mut rest: SmallVec<[Candidate; 16]> = SmallVec::new();
        for &c in candidates {
            let d = &self.buffer.drawn[c.drawn as usize];
            if !d.silhouette.touches(rect) {
                continue;
            }
            if d.silhouette.covers(rect) && (c.behind || below(d.depth.on(rect)) >= self.target.near) {
                return true;
            }
            rest.push(c);
        }
        if rest.is_empty() || level == self.depth {
            return false;
        }
        let (u, v) = ((rect.u0 + rect.u1) * 0.5, (rect.v0 + rect.v1) * 0.5);
        if self.is_seen(u, v, &rest) {
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
                || self.outside_frustum(q)
                || self.covered(q, &rest, level + 1)
        })
    }

    /// Whether a direction meets the target, inside the frustum, and no candidate.
    fn is_seen(&self, u: f64, v: f64, candidates: &[Candidate]) -> bool {
        self.target.silhouette.holds(u, v)
            && self.buffer.halves.iter().all(|h| h.at(u, v) >= 0.0)
            && candidates.iter().all(|c| !self.buffer.drawn[c.drawn as usize].silhouette.may_hold(u, v))
    }

    fn outside_frustum(&self, rect: &Rect) -> bool {
        self.buffer.halves.iter().any(|h| h.most(rect) < 0.0)
    }
}
