//! One wall, and the sets that it hides and stops.

use casca::glam::DVec3;

/// Sums of a few products in double precision are off by less than this share of the greatest
/// values that these can have: 16 roundings. With it, nothing is hidden in doubt.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// From which side of its plane a wall hides, and stops what comes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Side {
    #[default]
    Both,
    /// From where coordinates along its axis are less.
    Below,
    /// From where they are greater.
    Above,
}

/// A rectangle across one axis. The other two axes follow in turn: those of `min` and `max`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wall {
    /// 0 for x, 1 for y, 2 for z.
    pub(crate) axis: usize,
    /// Where it stands on that axis.
    pub(crate) at: f64,
    pub(crate) from: Side,
    pub(crate) min: [f64; 2],
    pub(crate) max: [f64; 2],
}

/// The two axes of a wall across a third one.
pub(crate) fn along(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

/// A box with corners in double precision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// The least corner.
    pub min: DVec3,
    /// The greatest corner.
    pub max: DVec3,
}

impl Span {
    /// The middle of the box.
    pub fn middle(&self) -> DVec3 {
        (self.min + self.max) * 0.5
    }

    /// The greatest distance of its coordinates from 0.
    fn farthest(&self) -> DVec3 {
        self.min.abs().max(self.max.abs())
    }

    fn corners(self) -> impl Iterator<Item = DVec3> {
        (0..8).map(move |i| {
            DVec3::from_array(std::array::from_fn(
                |k| if i >> k & 1 == 0 { self.min[k] } else { self.max[k] },
            ))
        })
    }

    /// Whether it is flat, and lies at a place on an axis.
    fn lies_at(&self, axis: usize, at: f64) -> bool {
        self.min[axis] == at && self.max[axis] == at
    }

    /// Its two parts on both sides of a place on an axis.
    pub(crate) fn divided(&self, axis: usize, at: f64) -> [Self; 2] {
        let (mut below, mut above) = (*self, *self);
        (below.max[axis], above.min[axis]) = (at, at);
        [below, above]
    }
}

/// Where to divide eyes, or else a target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cut {
    pub(crate) of_eyes: bool,
    pub(crate) axis: usize,
    pub(crate) at: f64,
}

/// Where an eye may be: in a ball and in a box.
#[derive(Debug, Clone, Copy)]
pub struct Eyes {
    center: DVec3,
    reach: f64,
    span: Span,
}

impl Eyes {
    /// Eyes in a box that are not farther than `reach` from a point.
    pub fn new(center: DVec3, reach: f64, span: Span) -> Self {
        Self { center, reach, span }
    }

    /// Eyes in a box.
    pub fn cuboid(span: Span) -> Self {
        Self { center: span.middle(), reach: f64::INFINITY, span }
    }

    /// The box in which all of them are.
    pub fn span(&self) -> &Span {
        &self.span
    }

    /// A number that n . e is not less than, for all of these eyes.
    fn least(&self, n: DVec3) -> f64 {
        let Span { min, max } = self.span;
        let in_box = (n * min).min(n * max).element_sum();
        // With a reach that is infinite, this is less than all, or no number for n = 0.
        in_box.max(n.dot(self.center) - self.reach * n.length())
    }
}

impl Wall {
    pub(crate) fn span(&self) -> Span {
        let [b, c] = along(self.axis);
        let (mut min, mut max) = (DVec3::splat(self.at), DVec3::splat(self.at));
        (min[b], min[c]) = (self.min[0], self.min[1]);
        (max[b], max[c]) = (self.max[0], self.max[1]);
        Span { min, max }
    }

    pub(crate) fn area(&self) -> f64 {
        (self.max[0] - self.min[0]) * (self.max[1] - self.min[1])
    }

    /// Whether it covers the cross section of a box.
    fn covers(&self, span: &Span) -> bool {
        let within =
            |(i, axis): (usize, usize)| self.min[i] <= span.min[axis] && span.max[axis] <= self.max[i];
        along(self.axis).into_iter().enumerate().all(within)
    }

    /// Whether a box lies in its plane. What does may be on either side of it: the wall stops it on
    /// none, and hides nothing from it, nor it from others.
    pub(crate) fn holds(&self, span: &Span) -> bool {
        span.lies_at(self.axis, self.at)
    }

    /// Whether eyes and a target lie in the plane of an edge of it: rays between them only touch.
    fn grazes(&self, eyes: &Span, target: &Span) -> bool {
        let both = |axis: usize, at: f64| eyes.lies_at(axis, at) && target.lies_at(axis, at);
        (0..2).zip(along(self.axis)).any(|(i, b)| both(b, self.min[i]) || both(b, self.max[i]))
    }

    /// Ends a box at the wall, if what starts in `from` cannot pass it. Returns whether it did.
    pub(crate) fn stops(&self, from: &Span, span: &mut Span) -> bool {
        let a = self.axis;
        if self.holds(from) || !self.covers(span) {
            return false;
        }
        if self.from != Side::Above && from.max[a] <= self.at && self.at < span.max[a] {
            span.max[a] = self.at;
            return true;
        }
        if self.from != Side::Below && from.min[a] >= self.at && self.at > span.min[a] {
            span.min[a] = self.at;
            return true;
        }
        false
    }

    /// Whether it hides all of a box, which is so far behind it, from all eyes.
    pub(crate) fn hides(&self, eyes: &Eyes, target: &Span, apart: f64) -> bool {
        let a = self.axis;
        if self.holds(&eyes.span) || self.holds(target) || self.grazes(&eyes.span, target) {
            return false;
        }
        // The eyes are on this side.
        let side = match eyes.span {
            Span { min, .. } if min[a] >= self.at && target.max[a] <= self.at - apart => 1.0,
            Span { max, .. } if max[a] <= self.at && target.min[a] >= self.at + apart => -1.0,
            _ => return false,
        };
        if self.from == if side > 0.0 { Side::Below } else { Side::Above } {
            return false;
        }
        let far = eyes.span.farthest().max(target.farthest());
        target.corners().all(|q| (0..2).all(|i| self.hides_along(i, eyes, q, side, far)))
    }

    /// Whether, along one axis of the wall, the cone behind it of a point on the other side holds
    /// all eyes. Coordinates of both are up to `far` from 0.
    fn hides_along(&self, i: usize, eyes: &Eyes, q: DVec3, side: f64, far: DVec3) -> bool {
        let away = (self.at - q[self.axis]) * side;
        let b = along(self.axis)[i];
        let (least, most) = (self.min[i] - q[b], self.max[i] - q[b]);
        if away <= 0.0 {
            return least <= 0.0 && most >= 0.0;
        }
        // An eye at a distance D along the axis from the point must be between
        // q + D least / away and q + D most / away.
        let holds = |slope: f64, sign: f64| {
            // Without a slope, places along one axis are compared, without rounding.
            if slope == 0.0 {
                return if sign > 0.0 { eyes.span.min[b] >= q[b] } else { eyes.span.max[b] <= q[b] };
            }
            let mut n = DVec3::ZERO;
            n[b] = away * sign;
            n[self.axis] = -slope * side * sign;
            eyes.least(n) >= n.dot(q) + ROUNDING * n.abs().dot(far)
        };
        holds(least, 1.0) && holds(most, -1.0)
    }

    /// Where to divide eyes or a target, so that the wall hides more of the parts: for boxes with
    /// the wall between their middles, of which it does not hide all.
    pub(crate) fn cut(&self, eyes: &Span, target: &Span, apart: f64) -> Cut {
        let a = self.axis;
        if eyes.min[a] < self.at && self.at < eyes.max[a] {
            return Cut { of_eyes: true, axis: a, at: self.at };
        }
        let side = if eyes.min[a] >= self.at { 1.0 } else { -1.0 };
        let border = self.at - side * apart;
        if target.min[a] < border && border < target.max[a] {
            return Cut { of_eyes: false, axis: a, at: border };
        }
        let all = Eyes::cuboid(*eyes);
        let far = eyes.farthest().max(target.farthest());
        let sticks_out = |i: usize| target.corners().any(|q| !self.hides_along(i, &all, q, side, far));
        let axes = (0..2).zip(along(a)).filter(|&(i, _)| sticks_out(i));
        // Where a wall ends at a floor or at another wall, that may hide what lies beyond the edge.
        let crossing = |span: &Span, (i, b): (usize, usize)| {
            [self.min[i], self.max[i]].into_iter().find(|at| span.min[b] < *at && *at < span.max[b])
        };
        for (of_eyes, span) in [(false, target), (true, eyes)] {
            if let Some((axis, at)) = axes.clone().find_map(|axis| Some((axis.1, crossing(span, axis)?))) {
                return Cut { of_eyes, axis, at };
            }
        }
        // By how much each edge moves the place at which a segment passes the wall, along one of
        // its axes: the part of the way that lies behind the wall counts for the eyes.
        let (from, to) = (eyes.middle(), target.middle());
        let share = ((self.at - to[a]) / (from[a] - to[a])).clamp(0.0, 1.0);
        let (of_eyes, of_target) = ((eyes.max - eyes.min) * share, (target.max - target.min) * (1.0 - share));
        let along_axis = |b: usize| {
            let slope = ((from[b] - to[b]) / (from[a] - to[a])).abs();
            [
                (true, b, of_eyes[b]),
                (false, b, of_target[b]),
                (true, a, of_eyes[a] * slope),
                (false, a, of_target[a] * slope),
            ]
        };
        let most = axes.flat_map(|(_, b)| along_axis(b)).max_by(|x, y| x.2.total_cmp(&y.2));
        let (of_eyes, axis, _) = most.unwrap_or((false, a, 0.0));
        Cut { of_eyes, axis, at: if of_eyes { from[axis] } else { to[axis] } }
    }

    /// Whether a segment passes or touches it.
    pub(crate) fn meets(&self, from: DVec3, to: DVec3) -> bool {
        let (p, q) = (from[self.axis] - self.at, to[self.axis] - self.at);
        if p * q > 0.0 || p == q {
            return false;
        }
        let point = from + (to - from) * (p / (p - q));
        (0..2).zip(along(self.axis)).all(|(i, b)| self.min[i] <= point[b] && point[b] <= self.max[i])
    }
}
