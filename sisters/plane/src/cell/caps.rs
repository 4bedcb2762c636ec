//! The thesis' own way to hide cells, as a reference: an opaque cell grows to an extended occluder
//! (section 3.3.4), and the cells behind its cap are hidden one by one (section 3.3.5).
//!
//! An extended occluder is a row or a column of cells that are opaque or hidden, or an L of both.
//! Its *cap* is the line through the centres of those cells. The thesis fills the endless polygon
//! behind the cap, between the rays through its ends, with vertices and samples at the centres of
//! cells: those are the cells whose centre lies behind the cap, seen from the centre of the
//! viewer's cell. By the chain rule of [`crate::cell`] they are hidden.

use glam::IVec2;

use crate::bits::BitGrid;
use crate::cell::map::CellMap;

/// The matrix H, and the occluders that fill it.
#[derive(Debug, Clone, Default)]
pub(super) struct Caps {
    hidden: BitGrid,
}

/// The ends of an extended occluder and its corner, relative to the viewer's cell. The corner of a
/// straight one is an end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cap {
    pub(super) first: IVec2,
    pub(super) corner: IVec2,
    pub(super) last: IVec2,
}

impl Cap {
    /// An estimate of the angle under which the viewer sees the occluder, in radians: its length
    /// over its distance (Coorg & Teller 1997, with one dimension less; the occluder always faces
    /// the viewer).
    fn angle(&self) -> f64 {
        let length = |a: IVec2, b: IVec2| f64::from((a - b).abs().max_element());
        let cells = length(self.first, self.corner) + length(self.corner, self.last) + 1.0;
        cells / (self.first + self.last).as_dvec2().length().max(1.0) * 2.0
    }

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

impl Caps {
    /// Forgets all hidden cells, for a grid.
    pub(super) fn begin(&mut self, dims: IVec2) {
        if (self.hidden.width(), self.hidden.height()) == (dims.x as u32, dims.y as u32) {
            self.hidden.clear();
        } else {
            self.hidden = BitGrid::new(dims.x as u32, dims.y as u32);
        }
    }

    /// Whether a cell of the grid is hidden.
    pub(super) fn is_hidden(&self, cell: IVec2) -> bool {
        self.hidden.get(cell.x as u32, cell.y as u32)
    }

    /// Extends the occluder that an opaque cell begins, and hides the cells behind it. False if its
    /// angle is too small.
    pub(super) fn hide_behind(
        &mut self,
        map: &CellMap,
        v: IVec2,
        cell: IVec2,
        l_shaped: bool,
        least_angle: f64,
    ) -> bool {
        let cap = self.extend(map, v, cell, l_shaped);
        if cap.angle() < least_angle {
            return false;
        }
        self.fill(map, v, &cap);
        true
    }

    /// Grows an opaque cell through opaque or hidden cells: towards the viewer, round the corner
    /// there, and away (table of Figure 3.8). The corner is the point nearest to the viewer, so the
    /// cap with the rays behind it bounds a convex polygon.
    fn extend(&self, map: &CellMap, v: IVec2, cell: IVec2, l_shaped: bool) -> Cap {
        let from = cell - v;
        let reach = |from: IVec2, step: IVec2| {
            let blocks = |c: IVec2| map.contains(c + v) && (map.is_opaque(c + v) || self.is_hidden(c + v));
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
        let near = reach(from, -one);
        if near != from {
            return Self::turned(from, near, two, l_shaped, reach);
        }
        let away = reach(from, two);
        let near = reach(from, -two);
        Self::turned(away, near, one, l_shaped, reach)
    }

    /// The cap from `far` to `near`, and from there on along `step`, if the corner is in the same
    /// quadrant.
    fn turned(
        far: IVec2,
        near: IVec2,
        step: IVec2,
        l_shaped: bool,
        reach: impl Fn(IVec2, IVec2) -> IVec2,
    ) -> Cap {
        // Where the first arm crosses an axis of the viewer, the second one would be behind it.
        let turns = l_shaped && near.signum() == far.signum();
        Cap { first: far, corner: near, last: if turns { reach(near, step) } else { near } }
    }

    /// Hides the cells behind a cap, row by row.
    fn fill(&mut self, map: &CellMap, v: IVec2, cap: &Cap) {
        for row in 0..map.dims.y {
            let y = i64::from(row - v.y);
            let (mut lo, mut hi) = (-i64::from(v.x), i64::from(map.dims.x - 1 - v.x));
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
