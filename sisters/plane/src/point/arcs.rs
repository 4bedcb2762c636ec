//! Arcs: intervals of directions around an eye, cut at the axes so that each lies in a quarter of
//! the circle.
//!
//! Inside a quarter, one exact cross product says which of two directions comes first. A number in
//! double precision that grows along the quarter says so too, unless two are as near as rounding.

use std::cmp::Ordering;

use glam::DVec2;
use smallvec::SmallVec;

use crate::geometry::{orient, point_along};
use crate::numeric::KEY;

/// The direction to a point, in a closed quarter of the circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ray {
    pub(crate) p: DVec2,
    /// The number of the quarter, and what grows from 0 to 1 along it; known to half of [`KEY`].
    /// Not a number for the eye.
    pub(crate) key: f64,
}

impl Ray {
    /// The direction to a point in a quarter, the axis that ends it included.
    #[inline]
    pub(crate) fn new(eye: DVec2, p: DVec2, quarter: u8) -> Self {
        let off = (p - eye).abs();
        let up = if quarter.is_multiple_of(2) { off.y } else { off.x };
        Self { p, key: f64::from(quarter) + up / (off.x + off.y) }
    }
}

/// A closed interval of directions in one quarter of the circle: from that to one point to that to
/// another, counterclockwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Arc {
    /// The quarter, counterclockwise from that between +x and +y.
    pub(crate) quarter: u8,
    pub(crate) from: Ray,
    pub(crate) to: Ray,
}

impl Arc {
    /// The part of it in another arc of its quarter; `None` if that is not more than one direction.
    pub(crate) fn within(self, eye: DVec2, other: &Self) -> Option<Self> {
        let part = self.clipped(eye, other);
        order(eye, &part.from, &part.to).is_lt().then_some(part)
    }

    /// The directions of it in another arc of its quarter; its ends change places if there are none.
    pub(crate) fn clipped(self, eye: DVec2, other: &Self) -> Self {
        let from = if order(eye, &other.from, &self.from).is_lt() { self.from } else { other.from };
        let to = if order(eye, &other.to, &self.to).is_lt() { other.to } else { self.to };
        Self { from, to, ..self }
    }
}

/// Some arcs, counterclockwise.
pub(crate) type Arcs = SmallVec<[Arc; 5]>;

/// An eye, and a point on each axis around it: that at which a quarter begins.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Circle {
    pub(crate) eye: DVec2,
    axes: [DVec2; 4],
}

impl Circle {
    pub(crate) fn new(eye: DVec2) -> Self {
        let axes = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y].map(|axis| point_along(eye, axis));
        Self { eye, axes }
    }

    /// The direction in which a quarter begins.
    pub(crate) fn first(&self, quarter: u8) -> Ray {
        Ray { p: self.axes[usize::from(quarter % 4)], key: f64::from(quarter) }
    }

    /// The direction in which a quarter ends.
    pub(crate) fn last(&self, quarter: u8) -> Ray {
        Ray { p: self.axes[usize::from((quarter + 1) % 4)], key: f64::from(quarter + 1) }
    }
}

/// The quarter of the direction to a point; that of an axis belongs to the quarter that begins
/// there.
#[inline]
pub(crate) fn quarter(eye: DVec2, p: DVec2) -> u8 {
    // By the signs of x and y. There is no branch that would be guessed wrongly half of the time.
    const QUARTERS: [u8; 16] = [0, 0, 2, 0, 1, 0, 1, 0, 3, 3, 2, 0, 0, 0, 0, 0];
    let [right, left] = [p.x > eye.x, p.x < eye.x].map(usize::from);
    let [up, down] = [p.y > eye.y, p.y < eye.y].map(usize::from);
    QUARTERS[right + 2 * left + 4 * up + 8 * down]
}

/// The arcs from the direction to one point to that to another, counterclockwise, less than a whole
/// turn; nothing if they are the same.
pub(crate) fn between(circle: &Circle, from: DVec2, to: DVec2) -> impl Iterator<Item = Arc> + use<> {
    let eye = circle.eye;
    cut(circle, from, to).filter(move |arc| order(eye, &arc.from, &arc.to).is_lt())
}

/// As [`between`], with the arcs of one direction that closed arcs of other quarters have in common
/// with these.
pub(crate) fn touching(circle: &Circle, from: DVec2, to: DVec2) -> impl Iterator<Item = Arc> + use<> {
    let eye = circle.eye;
    let before = (quarter(eye, from) + 3) % 4;
    let ray = Ray { p: from, key: f64::from(before + 1) };
    let before = Arc { quarter: before, from: ray, to: ray };
    let begins = from.x == eye.x || from.y == eye.y;
    begins.then_some(before).into_iter().chain(cut(circle, from, to))
}

fn cut(circle: &Circle, from: DVec2, to: DVec2) -> impl Iterator<Item = Arc> + use<> {
    let eye = circle.eye;
    let ends = [from, to].map(|p| {
        let quarter = quarter(eye, p);
        (quarter, Ray::new(eye, p, quarter))
    });
    let [(first, from), (last, to)] = ends;
    let same = first == last && order(eye, &from, &to).is_le();
    let quarters = if same { 0 } else { (last + 3 - first) % 4 + 1 };
    let circle = *circle;
    (0..=quarters).map(move |i| {
        let quarter = (first + i) % 4;
        Arc {
            quarter,
            from: if i == 0 { from } else { circle.first(quarter) },
            to: if i == quarters { to } else { circle.last(quarter) },
        }
    })
}

/// The whole circle.
pub(crate) fn whole(circle: &Circle) -> Arcs {
    (0..4).map(|quarter| Arc { quarter, from: circle.first(quarter), to: circle.last(quarter) }).collect()
}

/// The order of two directions, counterclockwise from +x on, where the end of the last quarter is
/// after all others. Exact.
#[inline]
pub(crate) fn order(eye: DVec2, p: &Ray, q: &Ray) -> Ordering {
    if keys_tell(p.key - q.key, KEY) {
        return if p.key < q.key { Ordering::Less } else { Ordering::Greater };
    }
    // Ends of arcs that meet are the same point.
    if p.p == q.p { Ordering::Equal } else { order_exactly(eye, p.p, q.p) }
}

/// Whether keys that are known to `doubt` together tell the order of two directions.
#[inline]
pub(crate) fn keys_tell(apart: f64, doubt: f64) -> bool {
    apart.abs() > doubt
}

/// As [`order`], for directions that are as near as rounding.
#[cold]
#[inline(never)]
fn order_exactly(eye: DVec2, p: DVec2, q: DVec2) -> Ordering {
    0f64.total_cmp(&(orient(eye, p, q) + 0.0))
}

/// Takes some arcs out of others. Both are sorted by quarter and direction, and disjoint; so are
/// those that remain, which have more than one direction.
pub(crate) fn without(eye: DVec2, arcs: &[Arc], others: &[Arc], rest: &mut Vec<Arc>) {
    rest.clear();
    let mut next = 0;
    for arc in arcs {
        let ends_before = |other: &Arc| order(eye, &other.to, &arc.from).is_le();
        while others.get(next).is_some_and(ends_before) {
            next += 1;
        }
        let mut from = arc.from;
        let begins_inside = |other: &&Arc| order(eye, &other.from, &arc.to).is_lt();
        while let Some(other) = others.get(next).filter(begins_inside) {
            if order(eye, &from, &other.from).is_lt() {
                rest.push(Arc { from, to: other.from, ..*arc });
            }
            from = other.to;
            if order(eye, &from, &arc.to).is_ge() {
                // The next arc may meet it, too.
                break;
            }
            next += 1;
        }
        if order(eye, &from, &arc.to).is_lt() {
            rest.push(Arc { from, ..*arc });
        }
    }
}

/// Sorts arcs by quarter and direction, and joins those that meet.
pub(crate) fn unite(eye: DVec2, arcs: &mut Vec<Arc>) {
    arcs.sort_unstable_by(|a, b| order(eye, &a.from, &b.from));
    arcs.dedup_by(|arc, before| {
        let meet = arc.quarter == before.quarter && order(eye, &arc.from, &before.to).is_le();
        if meet && order(eye, &before.to, &arc.to).is_lt() {
            before.to = arc.to;
        }
        meet
    });
}

#[cfg(test)]
mod tests {
    use glam::Vec2;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg32;

    use super::*;

    /// Keys that differ by less count as near: a rounding or two of single precision.
    const NEAR: f64 = 1e-7;

    /// The margin of keys is needed and enough: directions that differ by less than a digit of their
    /// keys are told apart exactly.
    #[test]
    fn keys_tell_no_order_that_is_not_so() {
        let mut random = Pcg32::seed_from_u64(40);
        let mut near = 0;
        for _ in 0..200_000 {
            let mut number = || random.random_range(-1.0f32..1.0) * 2f32.powi(random.random_range(-20..20));
            let eye = Vec2::new(number(), number());
            let p = eye + Vec2::new(number(), number());
            // On almost the same ray.
            let along = 2f32.powi(random.random_range(-3..3)) * random.random_range(0.9f32..1.1);
            let q = eye + (p - eye) * along;
            let [eye, p, q] = [eye, p, q].map(|v| v.as_dvec2());
            let quarters = [quarter(eye, p), quarter(eye, q)];
            if quarters[0] != quarters[1] || p == eye || q == eye {
                continue;
            }
            let rays = [p, q].map(|v| Ray::new(eye, v, quarters[0]));
            assert_eq!(order(eye, &rays[0], &rays[1]), order_exactly(eye, p, q), "{eye} {p} {q}");
            near += u32::from((rays[0].key - rays[1].key).abs() < NEAR);
        }
        assert!(near > 10_000, "{near}");
    }
}
