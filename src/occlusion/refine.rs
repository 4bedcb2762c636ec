//! Local refinement: in undecided pixels, silhouettes are compared directly.
//!
//! A direction that hits the target before any occluder proves the target visible and ends the
//! search. A square of directions is covered if one silhouette contains it and hides the target
//! there, or if the target does not reach it; otherwise it is cut into four. The budget counts
//! directions and squares, not time, so that results are the same on all machines.

use casca_slots::Slot;
use std::cell::Cell;

use smallvec::SmallVec;

use crate::numeric::occlusion::below;
use crate::occlusion::buffers::OcclusionBuffers;
use crate::occlusion::face::Rect;
use crate::occlusion::face_buffer::{DrawnSolid, FaceBuffer, Listed};
use crate::occlusion::pixels::Window;
use crate::occlusion::silhouette::LocalSilhouette;
use crate::occlusion::solid::Shadow;
use crate::occlusion::target::{FaceTarget, Target};
use crate::occlusion::tiles::{TILE, block};

/// Going through this many listed occluders costs as much as a square, so that the budget bounds
/// the time also where thousands are listed in one place.
const LISTED: usize = 64;

/// To compare squares with a polygon costs as much as with this many spheres.
const POLYGON: u32 = 3;

/// Candidates are numbered by the bits of a word.
const CANDIDATES: usize = u64::BITS as usize;

/// One occluder that may hide the target in a pixel.
struct PixelOccluder<'a> {
    drawn: &'a DrawnSolid,
    near: f32,
    /// Its silhouette, for squares in the pixel.
    silhouette: LocalSilhouette<'a>,
    /// The space behind its front.
    shadow: &'a Shadow,
    /// Whether all of the target lies there, once that was found out.
    behind: Cell<Option<bool>>,
}

impl PixelOccluder<'_> {
    /// Whether all of a target lies behind its front.
    #[inline]
    fn is_before(&self, target: &Target) -> bool {
        self.behind.get().unwrap_or_else(|| {
            let behind = target.is_behind(self.shadow);
            self.behind.set(Some(behind));
            behind
        })
    }
}

/// A pixel in which a target is compared with the occluders that may hide it.
pub(crate) struct Contest<'a> {
    candidates: SmallVec<[PixelOccluder<'a>; 4]>,
    /// The target, on all faces.
    whole: &'a Target,
    /// The target's silhouette, for squares in the pixel.
    target: LocalSilhouette<'a>,
}

impl Contest<'_> {
    /// The objects of the occluders.
    pub(crate) fn owners(&self) -> impl Iterator<Item = Slot> {
        self.candidates.iter().map(|candidate| candidate.drawn.owner)
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
    /// Whether the last squares were not examined to the end.
    cut_short: bool,
}

impl<'a> Search<'a> {
    pub(crate) fn new(
        buffer: &'a FaceBuffer,
        target: &'a FaceTarget,
        owner: Slot,
        squares: u32,
        depth: u32,
    ) -> Self {
        Self { buffer, target, owner, squares, depth, spent: 0, cut_short: false }
    }

    /// Whether the last squares were not examined to the end: with more squares or halvings, they
    /// might be covered.
    pub(crate) fn is_cut_short(&self) -> bool {
        self.cut_short
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

    /// Whether the direction to the target's middle shows it.
    pub(crate) fn middle_is_seen(&mut self, target: &Target) -> bool {
        let p = self.buffer.face().local(target.middle());
        let (u, v) = if self.buffer.face().parallel { (p.x, p.y) } else { (p.x / p.z, p.y / p.z) };
        let ahead = self.buffer.face().parallel || p.z > 0.0;
        match self.buffer.window().pixel_at(u, v) {
            Some(pixel) if ahead => self.direction_is_seen(u, v, pixel),
            _ => false,
        }
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
        let buffer = self.buffer;
        let listed = buffer.occluders().list(buffer.occluders().index(x, y));
        self.pay(listed.len());
        self.is_seen(u, v, listed)
    }

    /// Compares the target with those occluders of a list, the nearest first, that may hide it in
    /// the open part of a pixel; `None` if they weigh more than `most`.
    pub(crate) fn contest<'c>(
        &mut self,
        (buffers, whole): (&'c OcclusionBuffers, &'c Target),
        list: &[Listed],
        pixel: &Rect,
        most: u32,
    ) -> Option<Contest<'c>>
    where
        'a: 'c,
    {
        self.pay(list.len());
        // Only directions of the target need be hidden. Many targets are smaller than a pixel, and
        // most occluders of the pixel are beside them.
        let part = pixel.intersect(&self.target.rect).unwrap_or(*pixel);
        let (mut candidates, mut weight) = (SmallVec::new(), 0);
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
            let drawn = buffer.drawn(listed);
            if drawn.owner == self.owner {
                continue;
            }
            if let Some(silhouette) = drawn.silhouette.crossing(&part) {
                weight += if silhouette.is_conic() { 1 } else { POLYGON };
                if weight > most {
                    return None;
                }
                let (near, shadow) = (listed.near, buffers.shadow(drawn.solid));
                candidates.push(PixelOccluder { drawn, near, silhouette, shadow, behind: Cell::new(None) });
                if candidates.len() == CANDIDATES {
                    break;
                }
            }
        }
        let target = self.target.silhouette.crossing(pixel).unwrap_or_else(|| self.target.silhouette.whole());
        Some(Contest { candidates, whole, target })
    }

    /// Whether the candidates surely hide the target in a pixel, or in some of its finer pixels.
    pub(crate) fn is_covered(&mut self, pixel: &Pixel, contest: &Contest) -> bool {
        self.cut_short = false;
        self.is_covered_by(&Square { rect: pixel.rect, pixel, corner: (0, 0), level: 0 }, contest, u64::MAX)
    }

    fn is_covered_by(&mut self, square: &Square, contest: &Contest, among: u64) -> bool {
        if self.squares == 0 {
            self.cut_short = true;
            return false;
        }
        self.spend(1);
        let rect = &square.rect;
        let mut rest = 0u64;
        let mut near = None;
        for (i, c) in contest.candidates.iter().enumerate() {
            if among >> i & 1 == 0 || !c.silhouette.touches(rect) {
                continue;
            }
            if c.silhouette.covers(rect) {
                let mut nearer = || {
                    let near = *near.get_or_insert_with(|| self.target.near(rect));
                    below(c.drawn.front.behind_inside(rect)) >= near
                };
                // The cheaper question first: one distance for a ball, one bound for its planes.
                let hides = match c.silhouette.is_conic() {
                    true => c.is_before(contest.whole) || nearer(),
                    false => nearer() || c.is_before(contest.whole),
                };
                if hides {
                    return true;
                }
            }
            rest |= 1 << i;
        }
        if rest == 0 || square.level >= self.depth {
            self.cut_short |= rest != 0;
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

    /// As [`Search::is_seen`], for some of the candidates of a pixel.
    fn is_open(&self, u: f64, v: f64, contest: &Contest, among: u64) -> bool {
        let near = self.target.at(u, v);
        self.buffer.halves().iter().all(|h| h.at(u, v) >= 0.0)
            && contest.candidates.iter().enumerate().all(|(i, c)| {
                among >> i & 1 == 0
                    || f64::from(c.near) <= near
                    || !c.silhouette.may_hold(u, v)
                    || c.drawn.front.at(u, v) <= near
            })
    }

    /// Whether a ray in a direction of the target's silhouette hits it inside the frustum, before
    /// any of the occluders. This is not rounded: a wrong yes makes a hidden target visible, which
    /// is safe, and a no decides nothing.
    fn is_seen(&self, u: f64, v: f64, occluders: &[Listed]) -> bool {
        self.buffer.halves().iter().all(|h| h.at(u, v) >= 0.0)
            && self.buffer.is_before((u, v), self.target.at(u, v), occluders, self.owner)
    }
}
