//! The directions in which the eye can see beyond the shells walked so far.
//!
//! A wall closes the directions in which it lies inside the square of these shells. Where directions close late, the walk looks at more
//! cells; the result is the same.

use glam::DVec2;

use crate::geometry::block::Block;
use crate::geometry::orient;
use crate::numeric::{CLIPPED, ROUNDINGS};
use crate::point::arcs::{self, Arc};
use crate::point::wall::Wall;

/// Open directions, and the walls that may close more of them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Covers {
    /// Sorted by quarter and direction; disjoint.
    open: Vec<Arc>,
    /// Arcs that are closed, and not yet taken out of `open`.
    closed: Vec<Arc>,
    /// Walls that reach beyond the square, by number.
    waiting: Vec<u32>,
    /// Memory used again.
    rest: Vec<Arc>,
}

impl Covers {
    /// Opens the arcs of a view.
    pub(crate) fn reset(&mut self, eye: DVec2, view: &[Arc]) {
        self.open.clear();
        self.open.extend_from_slice(view);
        arcs::sort(eye, &mut self.open);
        self.closed.clear();
        self.waiting.clear();
    }

    /// The arcs in which the eye may see beyond the square.
    pub(crate) fn open(&self) -> &[Arc] {
        &self.open
    }

    /// Closes arcs at the eye.
    pub(crate) fn block(&mut self, blocked: &[Arc]) {
        self.closed.extend_from_slice(blocked);
    }

    /// Takes notice of walls from number `first` on.
    pub(crate) fn wait(&mut self, walls: std::ops::Range<u32>) {
        self.waiting.extend(walls);
    }

    /// Closes the directions in which a wall lies inside the square. `cell` is the size of a cell.
    pub(crate) fn close(&mut self, eye: DVec2, walls: &[Wall], square: &Block, cell: f64) {
        let Self { closed, waiting, .. } = self;
        waiting.retain(|&number| {
            let wall = &walls[number as usize];
            let (ends, whole) = inside(eye, wall, square, cell);
            if let Some([from, to]) = ends {
                closed.extend(arcs::between(eye, from, to));
            }
            !whole
        });
        // Every arc of `open` is copied: only where it is worth it.
        if self.closed.len() * FEW < self.open.len() {
            return;
        }
        arcs::sort(eye, &mut self.closed);
        arcs::without(eye, &self.open, &self.closed, &mut self.rest);
        std::mem::swap(&mut self.open, &mut self.rest);
        self.closed.clear();
        let open = &self.open;
        self.waiting.retain(|&number| {
            let wall = &walls[number as usize];
            arcs::between(eye, wall.a, wall.b).iter().any(|arc| meets(eye, open, arc))
        });
    }
}

/// Arcs wait to be closed until there is one for so many open ones. Any number gives the same result.
const FEW: usize = 8;

/// Whether an arc has more than one direction in common with some that are sorted and disjoint.
fn meets(eye: DVec2, open: &[Arc], arc: &Arc) -> bool {
    let ends_before = |other: &Arc| {
        other.quarter < arc.quarter
            || other.quarter == arc.quarter && arcs::order(eye, other.to, arc.from).is_le()
    };
    let first = open.get(open.partition_point(ends_before));
    first.is_some_and(|o| o.quarter == arc.quarter && arcs::order(eye, o.from, arc.to).is_lt())
}

/// The directions in which a wall lies inside a square, rounded inwards, and whether all of it does.
fn inside(eye: DVec2, wall: &Wall, square: &Block, cell: f64) -> (Option<[DVec2; 2]>, bool) {
    let [a, b] = [wall.a, wall.b];
    if square.contains(a) && square.contains(b) {
        return (Some([a, b]), true);
    }
    let inset = CLIPPED * cell;
    let square = Block { min: square.min + inset, max: square.max - inset };
    let u = b - a;
    // Parameters of the part inside (Liang & Barsky 1984).
    let (mut first, mut last) = (0f64, 1f64);
    for axis in 0..2 {
        if u[axis] == 0.0 {
            if a[axis] < square.min[axis] || a[axis] > square.max[axis] {
                return (None, false);
            }
            continue;
        }
        let hits = [square.min[axis], square.max[axis]].map(|line| (line - a[axis]) / u[axis]);
        first = first.max(hits[0].min(hits[1]));
        last = last.min(hits[0].max(hits[1]));
    }
    if first >= last {
        return (None, false);
    }
    let rounding = ROUNDINGS * (a.abs().max_element() + b.abs().max_element());
    // A ray to a rounded point hits the wall elsewhere, the farther the flatter it meets the wall.
    let known = |p: DVec2| {
        let ray = p - eye;
        ray.perp_dot(u).abs() * inset > 2.0 * rounding * ray.length() * u.length()
    };
    let from = if first > 0.0 { a + u * first } else { a };
    let to = if last < 1.0 { a + u * last } else { b };
    let sure = (first == 0.0 || known(from)) && (last == 1.0 || known(to)) && orient(eye, from, to) > 0.0;
    // Beyond its ends a wall covers nothing.
    let sure = sure && orient(eye, a, from) >= 0.0 && orient(eye, to, b) >= 0.0;
    (sure.then_some([from, to]), false)
}
