//! The visible region: which points and shapes meet it.
//!
//! It is the closure of the set of points before the nearest walls, so that its borders belong to
//! it. Comparisons are exact, but for distances: those to the end of the range and those of discs
//! are rounded outwards.

use glam::DVec2;

use crate::geometry::{Disc, Shape, orient, point_along};
use crate::numeric::{DISTANCE, TILT};
use crate::point::arcs::{Arc, order, touching};
use crate::point::envelope::{BLOCKED, Domain, Envelope, OPEN, Piece, Step};
use crate::point::wall::{Around, Direction, NOBODY, Wall};

/// The visible region of a view.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Region<'a> {
    pub(crate) around: Around<'a>,
    pub(crate) envelope: &'a Envelope,
    /// How far the view goes, rounded outwards; infinity if it does not end.
    pub(crate) range: f64,
}

impl<'a> Region<'a> {
    /// The region before the walls of an envelope.
    pub(crate) fn new(around: Around<'a>, envelope: &'a Envelope, range: Option<f64>) -> Self {
        let range = range.map_or(f64::INFINITY, |range| range * (1.0 + DISTANCE));
        Self { around, envelope, range }
    }

    /// Whether nothing is seen at all.
    pub(crate) fn is_empty(&self) -> bool {
        self.envelope.steps.iter().all(|step| step.wall == BLOCKED)
    }

    /// The pieces of a domain, counterclockwise.
    pub(crate) fn pieces(&self, domain: &'a Domain) -> impl Iterator<Item = Piece> {
        let steps = &self.envelope.steps[domain.steps.clone()];
        (0..steps.len()).map(move |i| domain.piece(steps, i))
    }

    /// Whether one of the pieces in some arcs, clipped to these, satisfies a test.
    fn any(&self, arcs: impl Iterator<Item = Arc>, mut test: impl FnMut(&Piece) -> bool) -> bool {
        let around = &self.around;
        for arc in arcs {
            for domain in self.envelope.domains.iter().filter(|domain| domain.arc.quarter == arc.quarter) {
                let part = arc.clipped(around.eye, &domain.arc);
                if order(around.eye, &part.from, &part.to).is_gt() {
                    continue;
                }
                let [from, to] = [part.from, part.to].map(Direction::from);
                let steps = &self.envelope.steps[domain.steps.clone()];
                // The first piece that does not end before.
                let before = |step: &Step| around.turn(&step.from, &from) > 0.0;
                let first = steps.partition_point(before).saturating_sub(1);
                let reached = (first..steps.len()).take_while(|&i| around.turn(&steps[i].from, &to) >= 0.0);
                for mut piece in reached.map(|i| domain.piece(steps, i)) {
                    if around.turn(&piece.from, &from) > 0.0 {
                        piece.from = from;
                    }
                    if around.turn(&piece.to, &to) <= 0.0 {
                        piece.to = to;
                    }
                    if around.turn(&piece.from, &piece.to) >= 0.0 && test(&piece) {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// Whether a point belongs to the region.
    pub(crate) fn contains(&self, p: DVec2) -> bool {
        if p == self.around.eye {
            return !self.is_empty();
        }
        let seen = |piece: &Piece| match piece.wall {
            OPEN => true,
            BLOCKED => false,
            wall => {
                let wall = self.around.wall(wall);
                orient(wall.a, wall.b, p) >= 0.0
            }
        };
        (p - self.around.eye).length() <= self.range && self.any(touching(self.around.circle, p, p), seen)
    }

    /// Whether a segment meets the region.
    fn meets_segment(&self, a: DVec2, b: DVec2) -> bool {
        match Wall::new(self.around.eye, a, b, NOBODY) {
            Some(target) => self.meets_wall(&target),
            None => self.meets_radial(a, b),
        }
    }

    /// Whether a segment that is collinear with the eye meets the region: whether its nearest point
    /// does.
    fn meets_radial(&self, a: DVec2, b: DVec2) -> bool {
        let eye = self.around.eye;
        let (low, high) = (a.min(b), a.max(b));
        if eye.cmpge(low).all() && eye.cmple(high).all() {
            return self.contains(eye);
        }
        let axis = usize::from(a.x == b.x);
        let a_is_nearer = (a[axis] < b[axis]) == (eye[axis] < a[axis].min(b[axis]));
        self.contains(if a_is_nearer { a } else { b })
    }

    /// Whether a wall meets the region.
    pub(crate) fn meets_wall(&self, target: &Wall) -> bool {
        let ends = [target.a, target.b].map(|p| (p - self.around.eye).length());
        let within = ends[0].max(ends[1]) <= self.range;
        self.any(target.touching(self.around.circle), |piece| match piece.wall {
            BLOCKED => false,
            OPEN => within || self.is_near(target, None, piece),
            wall => {
                let wall = self.around.wall(wall);
                let before = |along| self.around.nearer(target, wall, along) >= 0.0;
                (before(&piece.from) || before(&piece.to))
                    && (within || self.is_near(target, Some(wall), piece))
            }
        })
    }

    /// Whether the part of a target in a piece, and before the wall of the piece, comes as near as
    /// the range; in doubt, yes.
    fn is_near(&self, target: &Wall, wall: Option<&Wall>, piece: &Piece) -> bool {
        let eye = self.around.eye;
        let mut ends = [&piece.from, &piece.to].map(|along| self.around.hit(target, along));
        if let Some(wall) = wall {
            let signs = [&piece.from, &piece.to].map(|along| self.around.nearer(target, wall, along));
            // The end behind the wall moves to the crossing.
            let crossing = self.around.lead(target, wall).turned(signs[0] < 0.0);
            for i in 0..2 {
                if signs[i] < 0.0 {
                    ends[i] = self.around.hit_along(target, crossing);
                }
            }
        }
        let doubt = ends[0].1 + ends[1].1;
        let (a, b) = (ends[0].0 - eye, ends[1].0 - eye);
        distance(DVec2::ZERO, a, b) <= self.range + doubt
    }

    /// Whether a shape meets the region.
    pub(crate) fn meets(&self, shape: &Shape) -> bool {
        let eye = self.around.eye;
        if shape.contains(eye) {
            return !self.is_empty();
        }
        if let Shape::Disc(disc) = shape {
            let [from, to] = disc_sides(eye, disc);
            let meets = |piece: &Piece| disc_meets(&self.around, self.range, disc, piece);
            return self.any(touching(self.around.circle, from, to), meets);
        }
        let mut met = false;
        shape.front_sides(eye, |a, b| met = met || self.meets_segment(a, b));
        met
    }
}

/// Points whose directions enclose those to a disc, for an eye outside of it: the first and the
/// last counterclockwise.
fn disc_sides(eye: DVec2, disc: &Disc) -> [DVec2; 2] {
    let to = disc.center.as_dvec2() - eye;
    let half = (f64::from(disc.radius) / to.length()).min(1.0).asin() + TILT;
    let direction = to.normalize_or(DVec2::X);
    [-half, half].map(|angle| point_along(eye, DVec2::from_angle(angle).rotate(direction)))
}

/// Whether a disc meets a piece of the region, as far as `range`; in doubt, yes.
fn disc_meets(around: &Around, range: f64, disc: &Disc, piece: &Piece) -> bool {
    if piece.wall == BLOCKED {
        return false;
    }
    let eye = around.eye;
    let center = disc.center.as_dvec2() - eye;
    let wall = (piece.wall != OPEN).then(|| around.wall(piece.wall));
    let [from, to] = [&piece.from, &piece.to].map(|along| around.vague(along).v.normalize_or(DVec2::X));
    let faces = |p: DVec2| from.perp_dot(p) >= 0.0 && p.perp_dot(to) >= 0.0;
    let before = wall.is_none_or(|wall| orient(wall.a, wall.b, disc.center.as_dvec2()) >= 0.0);
    let off = center.length();
    if faces(center) && before && off <= range {
        return true;
    }
    let radius = f64::from(disc.radius);
    // Beyond this distance nothing touches the disc.
    let far = range.min((off + radius) * (1.0 + DISTANCE));
    let (ends, doubt) = match wall {
        Some(wall) => {
            let [a, b] = [&piece.from, &piece.to].map(|along| around.hit(wall, along));
            ([a.0 - eye, b.0 - eye], a.1 + b.1)
        }
        None => ([from * far, to * far], 0.0),
    };
    let mut nearest = [from, to].into_iter().zip(ends).fold(f64::INFINITY, |nearest, (side, end)| {
        nearest.min(distance(center, DVec2::ZERO, side * end.length().min(far)))
    });
    if wall.is_some()
        && let Some([a, b]) = inside_circle(ends[0], ends[1], range + doubt)
    {
        nearest = nearest.min(distance(center, a, b));
    }
    // The nearest point of the circle that ends the range.
    let rim = center * (range / off);
    if off > range && faces(rim) && wall.is_none_or(|wall| orient(wall.a, wall.b, eye + rim) >= 0.0) {
        nearest = nearest.min(off - range);
    }
    nearest <= radius * (1.0 + DISTANCE) + doubt + DISTANCE * (off + eye.length())
}

/// The part of a segment inside a circle around the origin.
pub(crate) fn inside_circle(a: DVec2, b: DVec2, range: f64) -> Option<[DVec2; 2]> {
    let along = b - a;
    let squared = along.length_squared();
    if a.length().max(b.length()) <= range || squared == 0.0 {
        return (a.length() <= range).then_some([a, b]);
    }
    let middle = -a.dot(along) / squared;
    let off = (a + along * middle).length();
    let half = ((range * range - off * off).max(0.0) / squared).sqrt();
    let (first, last) = ((middle - half).clamp(0.0, 1.0), (middle + half).clamp(0.0, 1.0));
    (off <= range && middle + half >= 0.0 && middle - half <= 1.0)
        .then(|| [first, last].map(|at| a + along * at))
}

/// The distance of a point from a segment.
fn distance(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let at = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    // Where the ends are the same, the quotient is not a number.
    let nearest = if at.is_nan() { a } else { a + along * at };
    (p - nearest).length().min((p - a).length()).min((p - b).length())
}
