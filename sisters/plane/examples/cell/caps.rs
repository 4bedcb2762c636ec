//! The cells that can be seen from anywhere in the viewer's cell, by the thesis' way: a walk in
//! chessboard shells, front to back (section 3.3.3), on which an opaque cell in sight grows to an
//! extended occluder (3.3.4), and the cells behind its cap are hidden one by one (3.3.5).
//!
//! # The chain rule
//!
//! Cells have whole coordinates relative to the viewer's cell V; a cell c is the closed square of
//! the points within half a cell of c along both axes. A cell *blocks* if it is opaque or hidden.
//! It is *hidden* if each way from a point of V to a point of it meets an opaque cell on the way.
//! Draw a line from the centre of each blocking cell to the centres of its blocking neighbours
//! along the axes. Those lines are the *chains*.
//!
//! **Rule.** If the way from the centre of V to the centre of c meets a chain before it reaches c,
//! then c is hidden.
//!
//! *Proof.* Let the way meet a chain in q = tc, t < 1, on the line between the centres a and b of
//! two neighbours that block (a = b for a single cell). Take a point v of V and a point c + d of c.
//! The way between them is at t in tc + (1-t)v + td = q + e, and e is a mean of v and d, so it lies
//! within half a cell of q along both axes. The cells a and b share a side, so all points within
//! half a cell of a point between their centres lie in a or in b. If that cell is opaque, the way
//! meets an opaque cell. If it is hidden, the way to q + e has met one before. As t < 1, both lie
//! before c + d. ∎
//!
//! An extended occluder is a row or a column of cells that block, or an L of both, which share the
//! cell at the corner. Its *cap* is the chain of those cells. The thesis fills the endless polygon
//! behind the cap, between the rays through its ends, with samples at the centres of cells: those
//! that lie behind the cap, seen from the centre of V, which the rule hides.

use casca_plane::BitGrid;
use glam::IVec2;

/// The matrix H, the cells in sight, and how many occluders hid others.
#[derive(Debug, Clone)]
pub struct Walk {
    hidden: BitGrid,
    pub seen: BitGrid,
    pub drawn: u32,
}

/// The ends of an extended occluder and its corner, relative to the viewer's cell. The corner of a
/// straight one is an end.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cap {
    first: IVec2,
    corner: IVec2,
    last: IVec2,
}

impl Cap {
    /// Linear functions `(a, b, c)` such that a cell `(x, y)` relative to V is behind the cap if no
    /// `a x + b y + c` is negative.
    fn half_planes(&self) -> impl Iterator<Item = (i64, i64, i64)> {
        let wide = |v: IVec2| (i64::from(v.x), i64::from(v.y));
        let ((fx, fy), (kx, ky), (lx, ly)) = (wide(self.first), wide(self.corner), wide(self.last));
        // Counterclockwise from the first ray to the last one.
        let turn = if fx * ly - fy * lx < 0 { -1 } else { 1 };
        let rays = [(-fy * turn, fx * turn, 0), (ly * turn, -lx * turn, 0)];
        let beyond_row =
            (ky == fy && fx != kx || ky == ly && lx != kx).then(|| (0, ky.signum(), -ky.abs() - 1));
        let beyond_column =
            (kx == fx && fy != ky || kx == lx && ly != ky).then(|| (kx.signum(), 0, -kx.abs() - 1));
        let single = self.first == self.last;
        let beyond_cell = single.then(|| (kx.signum(), ky.signum(), -kx.abs() - ky.abs() - 1));
        rays.into_iter().chain(beyond_row).chain(beyond_column).chain(beyond_cell)
    }
}

impl Walk {
    /// Walks from a cell inside the grid outwards, until a whole shell is hidden. If `l_shaped`, an
    /// occluder has a second arm, round the corner that is nearest to the viewer.
    pub fn run(opaque: &BitGrid, v: IVec2, l_shaped: bool) -> Self {
        let (width, height) = (opaque.width(), opaque.height());
        let empty = BitGrid::new(width, height);
        let mut walk = Self { hidden: empty.clone(), seen: empty, drawn: 0 };
        walk.seen.set(v.x as u32, v.y as u32, true);
        let last = IVec2::new(width as i32, height as i32) - 1;
        for m in 1..=v.max(last - v).max_element() {
            let ring = (-m..=m).flat_map(|i| [(i, -m), (i, m), (-m, i), (m, i)]);
            let ring = ring.map(|(x, y)| v + IVec2::new(x, y));
            let mut shell: Vec<IVec2> =
                ring.filter(|c| c.cmpge(IVec2::ZERO).all() && c.cmple(last).all()).collect();
            // The corners come twice.
            shell.sort_unstable_by_key(|c| c.to_array());
            shell.dedup();
            shell.retain(|c| !walk.hidden.get(c.x as u32, c.y as u32));
            if shell.is_empty() {
                break;
            }
            shell.iter().for_each(|c| walk.seen.set(c.x as u32, c.y as u32, true));
            for cell in shell.into_iter().filter(|c| opaque.get(c.x as u32, c.y as u32)) {
                let cap = walk.extend(opaque, v, cell, l_shaped);
                walk.drawn += 1;
                walk.fill(v, &cap);
            }
        }
        walk
    }

    /// Grows an opaque cell through opaque or hidden cells: towards the viewer, round the corner
    /// there, and away (table of Figure 3.8). The corner is the point nearest to the viewer, so the
    /// cap with the rays behind it bounds a convex polygon.
    fn extend(&self, opaque: &BitGrid, v: IVec2, cell: IVec2, l_shaped: bool) -> Cap {
        let from = cell - v;
        let reach = |from: IVec2, step: IVec2| {
            // Numbers below 0 lie far outside of the grid here, where no bit is set.
            let is_set = |bits: &BitGrid, c: IVec2| bits.get(c.x as u32, c.y as u32);
            let blocks = |c: IVec2| is_set(opaque, c + v) || is_set(&self.hidden, c + v);
            let mut end = from;
            while blocks(end + step) {
                end += step;
            }
            end
        };
        let sign = from.signum();
        if sign.x == 0 || sign.y == 0 {
            // Straight ahead: both ways across.
            let step = if sign.x == 0 { IVec2::X } else { IVec2::Y };
            let last = reach(from, step);
            return Cap { first: reach(from, -step), corner: last, last };
        }
        let (x, y) = (IVec2::new(sign.x, 0), IVec2::new(0, sign.y));
        // The table says which axis comes first in each quadrant.
        let (one, two) = if sign.x * sign.y < 0 { (x, y) } else { (y, x) };
        let (mut first, mut corner, mut step) = (from, reach(from, -one), two);
        if corner == from {
            (first, corner, step) = (reach(from, two), reach(from, -two), one);
        }
        // Where the first arm crosses an axis of the viewer, the second one would be behind it.
        let turns = l_shaped && corner.signum() == first.signum();
        Cap { first, corner, last: if turns { reach(corner, step) } else { corner } }
    }

    /// Hides the cells behind a cap, row by row.
    fn fill(&mut self, v: IVec2, cap: &Cap) {
        let (width, height) = (self.hidden.width() as i32, self.hidden.height() as i32);
        for row in 0..height {
            let y = i64::from(row - v.y);
            let (mut lo, mut hi) = (-i64::from(v.x), i64::from(width - 1 - v.x));
            for (a, b, c) in cap.half_planes() {
                let rest = b * y + c;
                match a {
                    0 if rest < 0 => hi = i64::MIN,
                    0 => {}
                    1.. => lo = lo.max(-rest.div_euclid(a)),
                    _ => hi = hi.min(rest.div_euclid(-a)),
                }
            }
            if lo <= hi {
                let place = |x: i64| (x + i64::from(v.x)) as u32;
                self.hidden.fill(row as u32, place(lo)..place(hi) + 1);
            }
        }
    }
}
