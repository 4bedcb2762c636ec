//! Local refinement: in undecided pixels, silhouettes are compared directly.
//!
//! A direction that hits the target before any occluder proves the target visible and ends the
//! search. A square of directions is covered if one silhouette contains it and hides the target
//! there, or if the target does not reach it; otherwise it is cut into four. The budget counts
//! directions and squares, not time, so that results are the same on all machines.

use casca_slots::Slot;

use crate::numeric::occlusion::below;
use crate::occlusion::buffers::OcclusionBuffers;
use crate::occlusion::face::Rect;
use crate::occlusion::face_buffer::{DrawnSolid, FaceBuffer, Listed};
use crate::occlusion::pixels::Window;
use crate::occlusion::silhouette::LocalSilhouette;
use crate::occlusion::target::{FaceTarget, Target};
use crate::occlusion::tiles::{TILE, block};

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
    buffers: &'a OcclusionBuffers,
    buffer: &'a FaceBuffer,
    /// The target, on all faces.
    whole: &'a Target,
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

/// A pixel, and its finer pixels that are open.
pub(crate) struct Pixel<'a> {
    /// The window of finer pixels.
    pub(crate) fine: &'a Window,
    /// The first of its finer pixels.
    pub(crate) first: (i64, i64),
    pub(crate) rect: Rect,
    pub(crate) open: u64,
}

impl Pixel<'_> {
    /// A rectangle around its open finer pixels, of which there is one.
    pub(crate) fn open_rect(&self) -> Rect {
        let rows =
            (i64::from(self.open.trailing_zeros()) / TILE, i64::from(self.open.leading_zeros()) / TILE);
        let columns = (0..TILE).fold(0, |all, row| all | self.open >> (row * TILE)) & 0xff;
        let (left, right) = (i64::from(columns.trailing_zeros()), 64 - i64::from(columns.leading_zeros()));
        Rect {
            u0: self.fine.border(self.first.0 + left),
            v0: self.fine.border(self.first.1 + rows.0),
            u1: self.fine.border(self.first.0 + right),
            v1: self.fine.border(self.first.1 + TILE - rows.1),
        }
    }
}

/// How often a pixel is halved until its parts are finer pixels.
const HALVINGS: u32 = TILE.trailing_zeros();

/// A square of directions in a pixel.
struct Square<'a> {
    rect: Rect,
    pixel: &'a Pixel<'a>,
    /// Its first finer pixel, counted from that of the pixel, where it is larger than one.
    corner: (i64, i64),
    /// How often the pixel was halved.
    level: u32,
}

impl<'a> Square<'a> {
    /// Half its width in finer pixels; 0 if it is one, or a part of one.
    fn half(&self) -> i64 {
        (TILE / 2) >> self.level.min(HALVINGS)
    }

    /// Where it is cut into four: on borders of finer pixels, while it is larger.
    fn middle(&self) -> (f64, f64) {
        let (half, r) = (self.half(), &self.rect);
        if half == 0 {
            return ((r.u0 + r.u1) * 0.5, (r.v0 + r.v1) * 0.5);
        }
        let (fine, first) = (self.pixel.fine, self.pixel.first);
        (fine.border(first.0 + self.corner.0 + half), fine.border(first.1 + self.corner.1 + half))
    }

    /// Whether the middle belongs to an open finer pixel.
    fn middle_is_open(&self) -> bool {
        let half = self.half();
        let (x, y) = (self.corner.0 + half, self.corner.1 + half);
        half == 0 || self.pixel.open & block(x - 1, x + 1, y - 1, y + 1) != 0
    }

    /// Whether one of its finer pixels is open.
    fn is_open(&self) -> bool {
        let (size, (x, y)) = (2 * self.half(), self.corner);
        self.level > HALVINGS || self.pixel.open & block(x, x + size.max(1), y, y + size.max(1)) != 0
    }

    /// The four squares around its middle.
    fn quarters(&self, u: f64, v: f64) -> [Self; 4] {
        let r = &self.rect;
        let part = |rect: Rect, x: i64, y: i64| {
            let corner = (self.corner.0 + x * self.half(), self.corner.1 + y * self.half());
            Square { rect, pixel: self.pixel, corner, level: self.level + 1 }
        };
        [
            part(Rect { u1: u, v1: v, ..*r }, 0, 0),
            part(Rect { u0: u, v1: v, ..*r }, 1, 0),
            part(Rect { u1: u, v0: v, ..*r }, 0, 1),
            part(Rect { u0: u, v0: v, ..*r }, 1, 1),
        ]
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
    /// The candidates of which it was found out whether all of the target lies behind their fronts,
    /// and those where it does.
    asked: u64,
    behind: u64,
}

impl<'a> Search<'a> {
    pub(crate) fn new(
        buffer: &'a FaceBuffer,
        target: &'a FaceTarget,
        owner: Slot,
        squares: u32,
        depth: u32,
    ) -> Self {
        let (asked, behind) = (0, 0);
        Self { buffer, target, owner, squares, depth, spent: 0, asked, behind }
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
        (buffers, whole): (&'c OcclusionBuffers, &'c Target),
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
        (self.asked, self.behind) = (0, 0);
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
        Contest { candidates, buffers, buffer, whole, target }
    }

    /// Whether the candidates surely hide the target in a pixel, or in some of its finer pixels.
    pub(crate) fn is_covered(&mut self, pixel: &Pixel, contest: &Contest) -> bool {
        self.is_covered_by(&Square { rect: pixel.rect, pixel, corner: (0, 0), level: 0 }, contest, u64::MAX)
    }

    fn is_covered_by(&mut self, square: &Square, contest: &Contest, among: u64) -> bool {
        if self.squares == 0 {
            return false;
        }
        self.spend(1);
        let (rect, target) = (&square.rect, self.target);
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
                let mut nearer = || {
                    let near = *near.get_or_insert_with(|| target.near(rect));
                    below(drawn.front.behind_inside(rect)) >= near
                };
                // The cheaper question first: one distance for a ball, one bound for its planes.
                let hides = match silhouette.is_conic() {
                    true => self.is_behind(contest, i) || nearer(),
                    false => nearer() || self.is_behind(contest, i),
                };
                if hides {
                    return true;
                }
            }
            rest |= 1 << i;
        }
        if rest == 0 || square.level >= self.depth {
            return false;
        }
        let (u, v) = square.middle();
        if square.middle_is_open() && contest.target.holds(u, v) && self.is_open(u, v, contest, rest) {
            return false;
        }
        square.quarters(u, v).iter().all(|q| {
            !q.is_open()
                || !contest.target.touches(&q.rect)
                || self.buffer.halves().iter().any(|h| h.most(&q.rect) < 0.0)
                || self.is_covered_by(q, contest, rest)
        })
    }

    /// Whether all of the target lies behind the front of a candidate.
    #[inline]
    fn is_behind(&mut self, contest: &Contest, candidate: usize) -> bool {
        let bit = 1 << candidate;
        if self.asked & bit == 0 {
            self.asked |= bit;
            let drawn = contest.buffer.drawn(contest.candidates[candidate].drawn);
            let behind = contest.whole.is_behind(contest.buffers.shadow(drawn.solid));
            self.behind |= u64::from(behind) << candidate;
        }
        self.behind & bit != 0
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
