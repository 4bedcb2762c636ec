//! Walls as all eyes within a reach of a place see them.
//!
//! D is the closed disc of the eyes, e its centre and r its radius. Each occluder falls into convex
//! *pieces*: solids, and single walls. A piece that D touches hides nothing: an eye may be inside,
//! or behind it. The others are clipped at their ends, and then hide from e what they hide from all
//! eyes.
//!
//! **Rule.** Let the way from e to q meet a piece before q, and let a path in the pieces lead from
//! there to a point on its right and farther than r from it, without crossing it again, and another
//! one to such a point on its left. Then q is hidden from all of D.
//!
//! *Proof.* The two paths together are one path that passes the way from e to q once. Take an eye
//! e' of D. All of the triangle e, e', q is within r of the way from e to q: the point at a share t
//! of the way from e' is (1-t) |e' - e| from that at the same share of the way from e. So both ends
//! of the path lie outside of the triangle, and the path passes its sides an even number of times.
//! That from e to e' lies in D, which no piece touches. The way from e to q is passed once. So that
//! from e' to q is passed, before q. ∎ (As lemma 16 of casca's `docs/conservativeness.md`.)
//!
//! A path to the right stays inside of a piece P up to its last point R on the right. That is
//! farther than r from ways whose angle with that to R is asin(r / |R - e|) or more: this angle is
//! the *gap* of P. If a corner c of P lies in a piece Q, ways from that of c on may also take the
//! gap of Q, whose last point may lie farther to the right: walls that join at an end hide as one.
//! A path is only followed past R for ways within a quarter of a turn of R, and a piece takes less
//! than half a turn, so that no path comes round to its way again.
//!
//! Far behind a wall, the shadow that is left and that of all eyes have parallel sides, r apart.

use casca_slots::Slot;
use glam::DVec2;
use smallvec::SmallVec;

use crate::geometry::block::Block;
use crate::geometry::polygon::ring;
use crate::geometry::{Polyline, Shape, orient};
use crate::numeric::{REACH, REACH_ANGLE, REACH_BACK, REACH_STEP};
use crate::point::target::distance;
use crate::scene::Scene;

/// Joints are followed from piece to piece so many times. Less hides less.
const LONGEST_PATH: u32 = 8;

/// Pieces that are looked at for one end, at most: a caller may put any number at one place.
const MOST_LOOKS: u32 = 128;

/// Corners of a solid that are looked at, at most: those of the others are its last points only.
const MOST_CORNERS: usize = 8;

/// The eyes, and the scene that they look at.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reach<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) eye: DVec2,
    pub(crate) reach: f64,
    /// The layers of the view.
    pub(crate) layers: u64,
}

/// A convex piece of an occluder: which of the segments of a chain, or 0.
type Name = (Slot, usize);

/// A convex piece as the middle of the eyes sees it.
#[derive(Debug, Clone)]
struct Piece {
    name: Name,
    /// The sides that turn to the eye, from the right end of each to its left one.
    sides: SmallVec<[[DVec2; 2]; 4]>,
    /// The last points to the right and to the left.
    ends: [DVec2; 2],
    /// Corners that may lie in other pieces.
    corners: SmallVec<[DVec2; MOST_CORNERS]>,
}

impl Reach<'_> {
    /// Calls `add` with the walls by which an occluder hides from all eyes, as the middle one sees
    /// them. Says whether some eye may be in a solid occluder.
    pub(crate) fn walls(&self, slot: Slot, occluder: &Shape, mut add: impl FnMut(DVec2, DVec2)) -> bool {
        let mut touched = false;
        for part in 0..parts(occluder) {
            match self.piece((slot, part), occluder) {
                Ok(piece) => self.clip(&piece, &mut add),
                Err(near) => touched |= near,
            }
        }
        touched && !matches!(occluder, Shape::Segment(_) | Shape::Polyline(_))
    }

    /// A piece of an occluder. If it hides nothing from some eyes, whether these touch it; else the
    /// middle one is in line with it.
    fn piece(&self, name: Name, occluder: &Shape) -> Result<Piece, bool> {
        let eye = self.eye;
        let mut sides: SmallVec<[[DVec2; 2]; 4]> = SmallVec::new();
        let mut nearest = f64::INFINITY;
        let mut side = |a: DVec2, b: DVec2| {
            nearest = nearest.min(distance(eye, a, b));
            let turn = orient(eye, a, b);
            if turn != 0.0 {
                sides.push(if turn > 0.0 { [a, b] } else { [b, a] });
            }
        };
        match occluder {
            Shape::Polyline(line) => {
                let [a, b] = segment(line, name.1);
                side(a, b);
            }
            _ => occluder.front_sides(eye, side),
        }
        if nearest <= self.reach * (1.0 + REACH) || occluder.surrounds(eye) {
            return Err(true);
        }
        if sides.is_empty() {
            return Err(false);
        }
        let mut ends = sides[0];
        for [right, left] in &sides {
            if orient(eye, ends[0], *right) < 0.0 {
                ends[0] = *right;
            }
            if orient(eye, ends[1], *left) > 0.0 {
                ends[1] = *left;
            }
        }
        let mut corners = SmallVec::from_slice(&ends);
        match occluder {
            Shape::Rect(rect) => corners.extend(rect.corners().map(|p| p.as_dvec2())),
            Shape::Polygon(polygon) if polygon.corners().len() + 2 <= MOST_CORNERS => {
                corners.extend(polygon.corners().iter().map(|p| p.as_dvec2()));
            }
            _ => {}
        }
        Ok(Piece { name, sides, ends, corners })
    }

    /// The angle by which the directions of `b` lie counterclockwise of those of `a`.
    fn angle(&self, a: DVec2, b: DVec2) -> f64 {
        let (a, b) = (a - self.eye, b - self.eye);
        a.perp_dot(b).atan2(a.dot(b))
    }

    /// Takes the directions that hide from some eyes only off both ends of a piece.
    fn clip(&self, piece: &Piece, add: &mut impl FnMut(DVec2, DVec2)) {
        let gaps = [0, 1].map(|end| self.gap(piece, end, LONGEST_PATH, &mut { MOST_LOOKS }));
        let [first, last] = [gaps[0], self.angle(piece.ends[0], piece.ends[1]) - gaps[1]];
        for &[right, left] in &piece.sides {
            let [from, to] = [right, left].map(|p| self.angle(piece.ends[0], p));
            if first >= to || last <= from || first >= last {
                continue;
            }
            // An end that no gap touches stays as it is, exactly.
            let cut_right = gaps[0] > 0.0 && first > from;
            let cut_left = gaps[1] > 0.0 && last < to;
            let right_end = if cut_right { self.cut(piece, [right, left], first) } else { Some(right) };
            let left_end = if cut_left { self.cut(piece, [right, left], last) } else { Some(left) };
            if let (Some(right), Some(left)) = (right_end, left_end) {
                add(right, left);
            }
        }
    }

    /// The point of a side in the direction at an angle from the right end of a piece, or a little
    /// behind the side; `None` if rounding does not let it be found.
    fn cut(&self, piece: &Piece, [right, left]: [DVec2; 2], angle: f64) -> Option<DVec2> {
        let eye = self.eye;
        let along = DVec2::from_angle(angle).rotate((piece.ends[0] - eye).try_normalize()?);
        let (p, u) = (right - eye, left - right);
        let share = -along.perp_dot(p) / along.perp_dot(u);
        let at = if (0.0..=1.0).contains(&share) { right + u * share } else { return None };
        let mut back = REACH_BACK * ((at - eye).length() + eye.abs().max_element()) + REACH_STEP;
        // A wall in line with the eye needs more than one that faces it.
        for _ in 0..24 {
            let behind = ((at + along * back) / REACH_STEP).round() * REACH_STEP;
            let kept = orient(right, left, behind) <= 0.0;
            let is_there = (self.angle(piece.ends[0], behind) - angle).abs() < REACH_ANGLE / 2.0;
            if kept && is_there {
                return Some(behind);
            }
            back *= 2.0;
        }
        None
    }

    /// The gap of a piece at its right end (0) or at its left one (1), in radians: directions that
    /// far from the end hide from all eyes.
    fn gap(&self, piece: &Piece, end: usize, path: u32, looks: &mut u32) -> f64 {
        let sign = if end == 0 { 1.0 } else { -1.0 };
        let last = piece.ends[end];
        let mut least =
            (self.reach * (1.0 + REACH) / (last - self.eye).length()).min(1.0).asin() + REACH_ANGLE;
        if path == 0 {
            return least;
        }
        let Some(own) = self.occluder(piece.name.0) else { return least };
        for &corner in &piece.corners {
            // No way that may go on there is as far from the end.
            if sign * self.angle(last, corner) >= least {
                continue;
            }
            for slot in self.slots_at(corner) {
                let Some(shape) = self.occluder(slot) else { continue };
                for part in parts_near(shape, slot, piece.name) {
                    if *looks == 0 || least <= 0.0 {
                        return least;
                    }
                    *looks -= 1;
                    let Ok(other) = self.piece((slot, part), shape) else { continue };
                    let beyond = sign * self.angle(other.ends[end], last);
                    if (slot, part) == piece.name || beyond <= 0.0 {
                        continue;
                    }
                    let in_own = || other.ends.into_iter().find(|&p| holds(own, piece.name.1, p));
                    let joint = Some(corner).filter(|&p| holds(shape, part, p)).or_else(in_own);
                    let Some(joint) = joint else { continue };
                    // No way through the piece is beyond its end.
                    let ahead = sign * orient(self.eye, last, joint) > 0.0;
                    let inside = if ahead { sign * self.angle(last, joint) + REACH_ANGLE } else { 0.0 };
                    if inside < least {
                        let rest = self.gap(&other, end, path - 1, looks) - beyond;
                        least = least.min(inside.max(rest).max(0.0));
                    }
                }
            }
        }
        least
    }

    /// The objects that may hold a point.
    fn slots_at(&self, p: DVec2) -> impl Iterator<Item = Slot> {
        let cell = self.scene.grid().cell_of(p);
        let listed: &[Slot] =
            if self.scene.grid().contains(cell) { self.scene.lists().get(cell) } else { &[] };
        listed.iter().chain(self.scene.outer()).copied()
    }

    /// The occluder of an object that hides in the view.
    fn occluder(&self, slot: Slot) -> Option<&Shape> {
        let object = self.scene.object(slot)?;
        let hides = object.layers & self.layers != 0 && object.is_certain();
        object.occluder.as_ref().filter(|_| hides)
    }
}

/// How many convex pieces a shape has.
fn parts(shape: &Shape) -> usize {
    if let Shape::Polyline(line) = shape { line.points().len() - 1 } else { 1 }
}

/// The ends of a piece of a chain.
fn segment(line: &Polyline, part: usize) -> [DVec2; 2] {
    [part, part + 1].map(|i| line.points()[i].as_dvec2())
}

/// The pieces of a shape that may touch another one: of its own chain only those beside it.
fn parts_near(shape: &Shape, slot: Slot, (other, part): Name) -> std::ops::Range<usize> {
    if slot == other { part.saturating_sub(1)..parts(shape).min(part + 2) } else { 0..parts(shape) }
}

/// Whether a piece of a shape holds a point, exactly; a disc by the polygon inside.
fn holds(shape: &Shape, part: usize, p: DVec2) -> bool {
    match shape {
        Shape::Disc(disc) => ring(&disc.polygon()).all(|(a, b)| orient(a, b, p) >= 0.0),
        Shape::Polyline(line) => {
            let [a, b] = segment(line, part);
            Block::EMPTY.with(a).with(b).contains(p) && orient(a, b, p) == 0.0
        }
        _ => shape.contains(p),
    }
}
