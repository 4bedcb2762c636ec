//! Walls and directions as an eye sees them, and exact comparisons of them.
//!
//! A wall from `a` to `b` runs counterclockwise around the eye `e`. Along a direction `d` it lies
//! at the distance `c / cross(d, u)` with `u = b - a` and `c = cross(a - e, b - e) > 0`. So of two
//! walls the first is nearer if `cross(d, w) > 0` with `w = c' u - c u'`, and the two cross in the
//! direction of `w` or `-w`. All comparisons are signs of polynomials of degree 6 at most. A filter
//! computes them in double precision; where it is not sure they are computed exactly.

use glam::DVec2;

use crate::geometry::expansion::{Exact2, between, combined, cross};
use crate::geometry::orient;
use crate::numeric::{CROSSING_KEY, HIT_ROOM, HIT_SHARE, KEY, ROUNDINGS};
use crate::point::arcs::{Arc, Circle, Ray, keys_tell, quarter};

/// A vector, and how far each of its components may be off.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Vague {
    pub(crate) v: DVec2,
    pub(crate) error: f64,
}

impl Vague {
    fn between(from: DVec2, to: DVec2) -> Self {
        let v = to - from;
        Self { v, error: ROUNDINGS * v.abs().max_element() }
    }

    /// The opposite vector, if `back`.
    pub(crate) fn turned(self, back: bool) -> Self {
        Self { v: if back { -self.v } else { self.v }, ..self }
    }

    /// The cross product, and its greatest error.
    fn cross(self, other: Self) -> (f64, f64) {
        let (a, b) = (self.v.x * other.v.y, self.v.y * other.v.x);
        let sums = [self, other].map(|s| s.v.x.abs() + s.v.y.abs());
        let error = self.error * (sums[1] + 2.0 * other.error) + other.error * sums[0];
        (a - b, error + ROUNDINGS * (a.abs() + b.abs()))
    }
}

/// A wall that is not collinear with the eye.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wall {
    pub(crate) a: DVec2,
    pub(crate) b: DVec2,
    pub(crate) u: Vague,
    /// Twice the area of the triangle that it makes with the eye, and the error of it.
    pub(crate) c: (f64, f64),
    /// The keys of its ends in their quarters.
    keys: [f64; 2],
    /// The quarter where it begins, and how many it has directions of.
    first: u8,
    quarters: u8,
    /// The place in the walk of the object of which this is a side, if its occluder is all of it;
    /// or else [`NOBODY`].
    pub(crate) owner: u32,
}

/// In place of the owner of a wall.
pub(crate) const NOBODY: u32 = u32::MAX;

impl Wall {
    /// The wall between two points; `None` if they are collinear with the eye.
    pub(crate) fn new(eye: DVec2, a: DVec2, b: DVec2, owner: u32) -> Option<Self> {
        let turn = orient(eye, a, b);
        let (a, b) = if turn > 0.0 { (a, b) } else { (b, a) };
        let c = Vague::between(eye, a).cross(Vague::between(eye, b));
        let [first, last] = [a, b].map(|p| quarter(eye, p));
        // Where it ends on the axis that begins a quarter, it has one direction of that: no arc.
        let ends_on_axis = if last.is_multiple_of(2) { b.y == eye.y } else { b.x == eye.x };
        let last = if ends_on_axis { (last + 3) % 4 } else { last };
        let quarters = (last + 4 - first) % 4 + 1;
        let keys = [Ray::new(eye, a, first).key, Ray::new(eye, b, last).key];
        (turn != 0.0).then(|| Self { a, b, u: Vague::between(a, b), c, keys, first, quarters, owner })
    }

    /// The directions that it covers.
    #[inline]
    pub(crate) fn arcs(&self, circle: &Circle) -> impl Iterator<Item = Arc> + use<> {
        let &Self { a, b, keys, first, quarters, .. } = self;
        let circle = *circle;
        (0..quarters).map(move |i| {
            let quarter = (first + i) % 4;
            Arc {
                quarter,
                from: if i == 0 { Ray { p: a, key: keys[0] } } else { circle.first(quarter) },
                to: if i + 1 == quarters { Ray { p: b, key: keys[1] } } else { circle.last(quarter) },
            }
        })
    }

    pub(crate) fn is_in_one_quarter(&self) -> bool {
        self.quarters == 1
    }

    /// As [`Wall::arcs`], with the arcs of one direction that closed arcs of other quarters have in
    /// common with these.
    pub(crate) fn touching(&self, circle: &Circle) -> impl Iterator<Item = Arc> + use<> {
        let one = |p: DVec2, quarter: u8, key: u8| {
            let ray = Ray { p, key: f64::from(key) };
            (p.x == circle.eye.x || p.y == circle.eye.y).then_some(Arc { quarter, from: ray, to: ray })
        };
        let (before, after) = ((self.first + 3) % 4, (self.first + self.quarters) % 4);
        let (before, after) = (one(self.a, before, before + 1), one(self.b, after, after));
        before.into_iter().chain(self.arcs(circle)).chain(after)
    }

    fn is(&self, other: &Self) -> bool {
        self.a == other.a && self.b == other.b
    }
}

/// A direction from the eye, in a closed quarter of the circle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Direction {
    pub(crate) to: To,
    /// As that of a [`Ray`].
    key: f64,
    /// How far the key may be off.
    doubt: f64,
}

impl From<Ray> for Direction {
    fn from(ray: Ray) -> Self {
        Self { to: To::Point(ray.p), key: ray.key, doubt: KEY / 2.0 }
    }
}

/// The goal of a direction.
#[derive(Debug, Clone, Copy)]
pub(crate) enum To {
    /// To a point.
    Point(DVec2),
    /// To the point where two walls cross.
    Crossing {
        /// The two walls.
        walls: [u32; 2],
        /// Whether it is that of `-w`, and not of `w`.
        flipped: bool,
        /// The direction in double precision, of any length.
        v: Vague,
    },
}

/// An eye among walls: compares directions and walls. The walls that directions name are in
/// `walls`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Around<'a> {
    pub(crate) circle: &'a Circle,
    pub(crate) eye: DVec2,
    pub(crate) walls: &'a [Wall],
}

impl<'a> Around<'a> {
    pub(crate) fn new(circle: &'a Circle, walls: &'a [Wall]) -> Self {
        Self { circle, eye: circle.eye, walls }
    }

    pub(crate) fn wall(&self, number: u32) -> &Wall {
        &self.walls[number as usize]
    }

    /// The direction as a vector.
    pub(crate) fn vague(&self, direction: &Direction) -> Vague {
        match direction.to {
            To::Point(p) => Vague::between(self.eye, p),
            To::Crossing { v, .. } => v,
        }
    }

    /// Positive if the second direction lies counterclockwise of the first, by less than half a
    /// turn; 0 if they are the same (or opposite).
    #[inline]
    pub(crate) fn turn(&self, from: &Direction, to: &Direction) -> f64 {
        let apart = to.key - from.key;
        match (from.to, to.to) {
            _ if keys_tell(apart, from.doubt + to.doubt) => apart,
            (To::Point(p), To::Point(q)) if p == q => 0.0,
            _ => self.turn_exactly(from, to),
        }
    }

    /// As [`Around::turn`], for directions whose keys do not tell.
    #[cold]
    #[inline(never)]
    fn turn_exactly(&self, from: &Direction, to: &Direction) -> f64 {
        use To::{Crossing, Point};
        match (from.to, to.to) {
            (Point(p), Point(q)) => orient(self.eye, p, q),
            (Crossing { walls: p, .. }, Crossing { walls: q, .. }) if p == q => 0.0,
            _ => {
                let (turn, error) = self.vague(from).cross(self.vague(to));
                if turn.abs() > error {
                    return turn;
                }
                cross(&self.exact(from), &self.exact(to)).sign()
            }
        }
    }

    /// `w` of two walls.
    pub(crate) fn lead(&self, a: &Wall, b: &Wall) -> Vague {
        let (p, q) = (a.u.v * b.c.0, b.u.v * a.c.0);
        let size = |v: DVec2| v.abs().max_element();
        let of = |u: Vague, c: (f64, f64)| u.error * (c.0.abs() + c.1) + c.1 * size(u.v);
        let error = of(a.u, b.c) + of(b.u, a.c) + ROUNDINGS * (size(p) + size(q));
        Vague { v: p - q, error }
    }

    /// The direction in which two walls cross, whose numbers are given, if the first is the nearer
    /// one clockwise of it; if `flipped`, counterclockwise. It is in a closed quarter.
    pub(crate) fn crossing(&self, walls: [u32; 2], flipped: bool, quarter: u8) -> Direction {
        let v = self.lead(self.wall(walls[0]), self.wall(walls[1])).turned(flipped);
        let (along, up) = if quarter.is_multiple_of(2) { (v.v.x, v.v.y) } else { (v.v.y, v.v.x) };
        let size = along.abs() + up.abs();
        let share = v.error / size;
        // Not a number, it is not sure.
        let doubt = if share < HIT_SHARE { CROSSING_KEY * share + KEY / 2.0 } else { f64::INFINITY };
        Direction { to: To::Crossing { walls, flipped, v }, key: f64::from(quarter) + up.abs() / size, doubt }
    }

    /// Positive if wall `a` is nearer than wall `b` along a direction that both cover, 0 if they
    /// meet there.
    pub(crate) fn nearer(&self, a: &Wall, b: &Wall, along: &Direction) -> f64 {
        if let To::Point(p) = along.to {
            // Without branches that would be guessed wrongly half of the time.
            let is = |q: DVec2| (p.x == q.x) & (p.y == q.y);
            if is(a.a) | is(a.b) {
                return orient(b.a, b.b, p);
            }
            if is(b.a) | is(b.b) {
                return -orient(a.a, a.b, p);
            }
        }
        if a.is(b) {
            return 0.0;
        }
        let (sign, error) = self.vague(along).cross(self.lead(a, b));
        if sign.abs() > error {
            return sign;
        }
        cross(&self.exact(along), &self.exact_lead(a, b)).sign()
    }

    /// The point of a wall in a direction that it covers, and how far from it the true one may be.
    pub(crate) fn hit(&self, wall: &Wall, along: &Direction) -> (DVec2, f64) {
        match along.to {
            To::Point(p) if p == wall.a || p == wall.b => (p, 0.0),
            _ => self.hit_along(wall, self.vague(along)),
        }
    }

    /// As [`Around::hit`], for a direction as a vector.
    pub(crate) fn hit_along(&self, wall: &Wall, along: Vague) -> (DVec2, f64) {
        let (turn, error) = along.cross(wall.u);
        let offset = along.v * (wall.c.0 / turn);
        let share =
            wall.c.1 / wall.c.0 + error / turn + along.error / along.v.abs().max_element() + ROUNDINGS;
        let doubt = HIT_ROOM * share * offset.length() + ROUNDINGS * self.eye.length();
        let all = (wall.b - wall.a).length() * (1.0 + ROUNDINGS);
        // Comparisons with NaN are false: then the point may be anywhere on the wall.
        if (0.0..HIT_SHARE).contains(&share) && doubt < all {
            (self.eye + offset, doubt)
        } else {
            (wall.a, all)
        }
    }

    fn exact_lead(&self, a: &Wall, b: &Wall) -> Exact2 {
        let c = |wall: &Wall| cross(&between(self.eye, wall.a), &between(self.eye, wall.b));
        combined(&between(a.a, a.b), &c(b), &between(b.a, b.b), &c(a))
    }

    fn exact(&self, direction: &Direction) -> Exact2 {
        match direction.to {
            To::Point(p) => between(self.eye, p),
            To::Crossing { walls: [a, b], flipped, .. } => {
                let (a, b) = if flipped { (b, a) } else { (a, b) };
                // `w` of the walls in the other order is `-w`.
                self.exact_lead(self.wall(a), self.wall(b))
            }
        }
    }
}
