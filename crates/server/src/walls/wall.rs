//! One wall, and the sets that it hides and stops.

use casca::glam::DVec3;

/// A rectangle across one axis. The other two axes follow in turn: those of `min` and `max`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wall {
    /// 0 for x, 1 for y, 2 for z.
    pub(crate) axis: usize,
    /// Where it stands on that axis.
    pub(crate) at: f64,
    pub(crate) min: [f64; 2],
    pub(crate) max: [f64; 2],
}

/// The two axes of a wall across a third one.
pub(crate) fn along(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

/// A box with corners in double precision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    pub(crate) min: DVec3,
    pub(crate) max: DVec3,
}

/// Where an eye may be: in a ball and in a box.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Eyes {
    pub(crate) center: DVec3,
    pub(crate) reach: f64,
    pub(crate) span: Span,
}

impl Eyes {
    /// A number that n . e is not less than, for all of these eyes.
    fn least(&self, n: DVec3) -> f64 {
        let Span { min, max } = self.span;
        let in_box = (n * min).min(n * max).element_sum();
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

    /// Whether it covers the cross section of a box.
    fn covers(&self, span: &Span) -> bool {
        let within =
            |(i, axis): (usize, usize)| self.min[i] <= span.min[axis] && span.max[axis] <= self.max[i];
        along(self.axis).into_iter().enumerate().all(within)
    }

    /// Ends a box at the wall, if what starts in `from` cannot pass it. Returns whether it did.
    pub(super) fn stops(&self, from: &Span, span: &mut Span) -> bool {
        let a = self.axis;
        if !self.covers(span) {
            return false;
        }
        if from.max[a] <= self.at && self.at < span.max[a] {
            span.max[a] = self.at;
            return true;
        }
        if from.min[a] >= self.at && self.at > span.min[a] {
            span.min[a] = self.at;
            return true;
        }
        false
    }

    /// Whether it hides all of a box from all eyes.
    pub(crate) fn hides(&self, eyes: &Eyes, target: &Span) -> bool {
        let a = self.axis;
        // The eyes are on this side.
        let side = match eyes.span {
            Span { min, .. } if min[a] >= self.at && target.max[a] <= self.at => 1.0,
            Span { max, .. } if max[a] <= self.at && target.min[a] >= self.at => -1.0,
            _ => return false,
        };
        // What lies in the plane of the wall may be painted on it.
        if target.min[a] == self.at && target.max[a] == self.at {
            return false;
        }
        let corner = |i: usize| {
            DVec3::from_array(std::array::from_fn(|k| {
                if i >> k & 1 == 0 { target.min[k] } else { target.max[k] }
            }))
        };
        (0..8).map(corner).all(|q| self.hides_point(eyes, q, side))
    }

    /// Whether the cone behind the wall of a point on the other side holds all eyes.
    fn hides_point(&self, eyes: &Eyes, q: DVec3, side: f64) -> bool {
        let away = (self.at - q[self.axis]) * side;
        (0..2).zip(along(self.axis)).all(|(i, b)| {
            let (least, most) = (self.min[i] - q[b], self.max[i] - q[b]);
            if away <= 0.0 {
                return least <= 0.0 && most >= 0.0;
            }
            // An eye at a distance D along the axis from the point must be between
            // q + D least / away and q + D most / away.
            let holds = |slope: f64, sign: f64| {
                let mut n = DVec3::ZERO;
                n[b] = away * sign;
                n[self.axis] = -slope * side * sign;
                eyes.least(n) >= n.dot(q)
            };
            holds(least, 1.0) && holds(most, -1.0)
        })
    }

    /// Whether a segment passes it.
    pub(super) fn meets(&self, from: DVec3, to: DVec3) -> bool {
        let (p, q) = (from[self.axis] - self.at, to[self.axis] - self.at);
        if p * q > 0.0 || p == q {
            return false;
        }
        let point = from + (to - from) * (p / (p - q));
        (0..2).zip(along(self.axis)).all(|(i, b)| self.min[i] <= point[b] && point[b] <= self.max[i])
    }
}
