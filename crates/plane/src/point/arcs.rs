//! Arcs: intervals of directions around an eye, cut at the axes so that each lies in a quarter of
//! the circle.
//!
//! Inside a quarter, one exact cross product says which of two directions comes first.

use std::cmp::Ordering;

use glam::DVec2;
use smallvec::SmallVec;

use crate::geometry::{orient, point_along};

/// A closed interval of directions in one quarter of the circle: from that to one point to that to
/// another, counterclockwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Arc {
    /// The quarter, counterclockwise from that between +x and +y.
    pub(crate) quarter: u8,
    pub(crate) from: DVec2,
    pub(crate) to: DVec2,
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

    fn axis(&self, quarter: u8) -> DVec2 {
        self.axes[usize::from(quarter % 4)]
    }
}

/// The quarter of the direction to a point; that of an axis belongs to the quarter that begins
/// there.
pub(crate) fn quarter(eye: DVec2, p: DVec2) -> u8 {
    match (p.x > eye.x, p.x < eye.x, p.y > eye.y, p.y < eye.y) {
        (true, _, _, false) => 0,
        (false, _, true, _) => 1,
        (_, true, _, _) => 2,
        (false, false, false, false) => 0,
        _ => 3,
    }
}

/// The arcs from the direction to one point to that to another, counterclockwise, less than a whole
/// turn; nothing if they are the same.
pub(crate) fn between(circle: &Circle, from: DVec2, to: DVec2) -> impl Iterator<Item = Arc> + use<> {
    let eye = circle.eye;
    cut(circle, from, to).filter(move |arc| order(eye, arc.from, arc.to).is_lt())
}

/// As [`between`], with the arcs of one direction that closed arcs of other quarters have in common
/// with these.
pub(crate) fn touching(circle: &Circle, from: DVec2, to: DVec2) -> impl Iterator<Item = Arc> + use<> {
    let eye = circle.eye;
    let before = Arc { quarter: (quarter(eye, from) + 3) % 4, from, to: from };
    let begins = from.x == eye.x || from.y == eye.y;
    begins.then_some(before).into_iter().chain(cut(circle, from, to))
}

fn cut(circle: &Circle, from: DVec2, to: DVec2) -> impl Iterator<Item = Arc> + use<> {
    let circle = *circle;
    let eye = circle.eye;
    let (first, last) = (quarter(eye, from), quarter(eye, to));
    let same = first == last && orient(eye, from, to) >= 0.0;
    let quarters = if same { 0 } else { (last + 3 - first) % 4 + 1 };
    (0..=quarters).map(move |i| {
        let quarter = (first + i) % 4;
        Arc {
            quarter,
            from: if i == 0 { from } else { circle.axis(quarter) },
            to: if i == quarters { to } else { circle.axis(quarter + 1) },
        }
    })
}

/// The whole circle.
pub(crate) fn whole(circle: &Circle) -> Arcs {
    (0..4).map(|quarter| Arc { quarter, from: circle.axis(quarter), to: circle.axis(quarter + 1) }).collect()
}

/// The order of the directions to two points of the same closed quarter, counterclockwise.
pub(crate) fn order(eye: DVec2, p: DVec2, q: DVec2) -> Ordering {
    if p == q {
        return Ordering::Equal;
    }
    0f64.total_cmp(&(orient(eye, p, q) + 0.0))
}

/// Takes some arcs out of others. Both are sorted by quarter and direction, and disjoint; so are
/// those that remain, which have more than one direction.
pub(crate) fn without(eye: DVec2, arcs: &[Arc], others: &[Arc], rest: &mut Vec<Arc>) {
    rest.clear();
    let mut next = 0;
    for arc in arcs {
        let ends_before = |other: &Arc| {
            other.quarter < arc.quarter
                || other.quarter == arc.quarter && order(eye, other.to, arc.from).is_le()
        };
        while others.get(next).is_some_and(ends_before) {
            next += 1;
        }
        let mut from = arc.from;
        let begins_inside =
            |other: &&Arc| other.quarter == arc.quarter && order(eye, other.from, arc.to).is_lt();
        while let Some(other) = others.get(next).filter(begins_inside) {
            if order(eye, from, other.from).is_lt() {
                rest.push(Arc { from, to: other.from, ..*arc });
            }
            from = other.to;
            if order(eye, from, arc.to).is_ge() {
                // The next arc may meet it, too.
                break;
            }
            next += 1;
        }
        if order(eye, from, arc.to).is_lt() {
            rest.push(Arc { from, ..*arc });
        }
    }
}

/// Sorts arcs by quarter and direction, and joins those that meet.
pub(crate) fn unite(eye: DVec2, arcs: &mut Vec<Arc>) {
    arcs.sort_unstable_by(|a, b| a.quarter.cmp(&b.quarter).then_with(|| order(eye, a.from, b.from)));
    arcs.dedup_by(|arc, before| {
        let meet = arc.quarter == before.quarter && order(eye, arc.from, before.to).is_le();
        if meet && order(eye, before.to, arc.to).is_lt() {
            before.to = arc.to;
        }
        meet
    });
}
