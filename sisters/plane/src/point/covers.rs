//! The directions in which the eye can see beyond the shells walked so far.
//!
//! A wall closes the directions in which it lies inside the square of these shells. Where
//! directions close late, the walk looks at more cells; the result is the same.

use glam::DVec2;

use crate::geometry::{Block, orient};
use crate::numeric::{BOTH_AXES, CLIPPED, ROUNDINGS};
use crate::point::arcs::{self, Arc, Circle, between};
use crate::point::shells::Shells;
use crate::point::wall::Wall;

/// Open directions, and the walls that may close more of them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Covers {
    /// The arcs in which the eye may see beyond the square, sorted by quarter and direction; disjoint.
    pub(crate) open: Vec<Arc>,
    /// All arcs of the view.
    pub(crate) view: Vec<Arc>,
    /// Arcs that are closed, and not yet taken out of `open`.
    pub(crate) closed: Vec<Arc>,
    waiting: Vec<Waiting>,
    /// Memory used again.
    rest: Vec<Arc>,
}

/// A wall that reaches beyond the square.
#[derive(Debug, Clone, Copy)]
struct Waiting {
    wall: u32,
    /// The shell at which to look at it again.
    next: i32,
    /// The first shell whose square contains all of it.
    last: i32,
}

impl Covers {
    /// Opens the arcs of a view.
    pub(crate) fn reset(&mut self, eye: DVec2, view: &[Arc]) {
        self.open.clear();
        self.open.extend_from_slice(view);
        arcs::unite(eye, &mut self.open);
        self.view.clone_from(&self.open);
        self.closed.clear();
        self.waiting.clear();
    }

    /// Whether much of the view is still open.
    pub(crate) fn is_wide(&self) -> bool {
        let sum = |arcs: &[Arc]| arcs.iter().map(|arc| arc.to.key - arc.from.key).sum::<f64>();
        sum(&self.open) >= WIDE * sum(&self.view)
    }

    /// Whether some directions of a wall may be open.
    pub(crate) fn may_show(&self, circle: &Circle, wall: &Wall) -> bool {
        wall.arcs(circle).any(|arc| meets(circle.eye, &self.open, &arc))
    }

    /// Takes notice of a wall.
    pub(crate) fn wait(&mut self, shells: &Shells, number: u32, wall: &Wall) {
        let last = shells.shell_of(wall.a).max(shells.shell_of(wall.b));
        self.waiting.push(Waiting { wall: number, next: 0, last });
    }

    /// Closes the directions in which walls lie inside the square of a shell.
    pub(crate) fn close(&mut self, circle: &Circle, walls: &[Wall], shells: &Shells, shell: i32) {
        let Self { closed, waiting, .. } = self;
        waiting.retain_mut(|wait| {
            if shell < wait.next {
                return true;
            }
            let wall = &walls[wait.wall as usize];
            let whole = shell >= wait.last;
            if whole {
                closed.extend(wall.arcs(circle));
            } else {
                let ends = inside(circle.eye, wall, shells, shell);
                closed.extend(ends.into_iter().flat_map(|[from, to]| between(circle, from, to)));
            }
            wait.next = (shell + shell / LATER + 1).min(wait.last);
            !whole
        });
        // Every arc of `open` is copied: only where it is worth it.
        if self.closed.is_empty() || self.closed.len() * FEW < self.open.len() {
            return;
        }
        arcs::unite(circle.eye, &mut self.closed);
        arcs::without(circle.eye, &self.open, &self.closed, &mut self.rest);
        std::mem::swap(&mut self.open, &mut self.rest);
        self.closed.clear();
    }
}

/// Arcs wait to be closed until there is one for so many open ones. Any number gives the same
/// result.
const FEW: usize = 3;

/// The view is wide open if at least this share of it is. Any number gives the same result.
const WIDE: f64 = 0.75;

/// A wall is looked at again when the number of the shell has grown by one part in so many. Any
/// number gives the same result.
const LATER: i32 = 4;

/// Whether an arc has more than one direction in common with some that are sorted and disjoint.
fn meets(eye: DVec2, open: &[Arc], arc: &Arc) -> bool {
    let ends_before = |other: &Arc| arcs::order(eye, &other.to, &arc.from).is_le();
    let first = open.get(open.partition_point(ends_before));
    first.is_some_and(|other| arcs::order(eye, &other.from, &arc.to).is_lt())
}

/// The directions in which a wall lies inside the square of a shell, rounded inwards; `None` if
/// that is not known.
fn inside(eye: DVec2, wall: &Wall, shells: &Shells, shell: i32) -> Option<[DVec2; 2]> {
    let [a, b] = [wall.a, wall.b];
    let inset = CLIPPED * shells.grid.cell;
    let (min, max) = shells.square(shell);
    let square = Block { min: min + inset, max: max - inset };
    let u = b - a;
    // Parameters of the part inside (Liang & Barsky 1984).
    let (mut first, mut last) = (0f64, 1f64);
    for axis in 0..2 {
        if u[axis] == 0.0 {
            if a[axis] < square.min[axis] || a[axis] > square.max[axis] {
                return None;
            }
            continue;
        }
        let hits = [square.min[axis], square.max[axis]].map(|line| (line - a[axis]) / u[axis]);
        first = first.max(hits[0].min(hits[1]));
        last = last.min(hits[0].max(hits[1]));
    }
    if first >= last {
        return None;
    }
    let rounding = ROUNDINGS * (a.abs().max_element() + b.abs().max_element());
    // A ray to a rounded point hits the wall elsewhere, the farther the flatter it meets the wall.
    let known = |p: DVec2| {
        let ray = p - eye;
        ray.perp_dot(u).abs() * inset > BOTH_AXES * rounding * ray.length() * u.length()
    };
    let from = if first > 0.0 { a + u * first } else { a };
    let to = if last < 1.0 { a + u * last } else { b };
    let sure = (first == 0.0 || known(from)) && (last == 1.0 || known(to)) && orient(eye, from, to) > 0.0;
    // Beyond its ends a wall covers nothing.
    (sure && orient(eye, a, from) >= 0.0 && orient(eye, to, b) >= 0.0).then_some([from, to])
}
