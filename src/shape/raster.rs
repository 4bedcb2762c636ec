//! Triangles as rows of cells.
//!
//! A triangle is cut into slices between planes along z, and the outline of each slice is followed from row to row:
//! the cost is that of the rows met, however large the box around the triangle.

use glam::{DVec3, IVec3};
use smallvec::SmallVec;

use super::CellRun;
use crate::grid::Grid;

/// A triangle is widened by this share of its greatest coordinate. A corner that cutting makes errs by fewer than
/// 16 units in the last place of that coordinate; three cuts and one interpolation follow each
/// other: 64 units, 1.5e-14. A separating-axis test errs by about as much.
const WIDER: f64 = 1e-12;

/// A triangle cut by three pairs of planes has at most nine corners.
type Polygon = SmallVec<[DVec3; 9]>;

/// By how much a triangle is widened.
pub(super) fn margin(t: &[DVec3; 3]) -> f64 {
    t.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max) * WIDER
}

/// The least box that holds a triangle.
pub(super) fn box_of(t: &[DVec3; 3]) -> (DVec3, DVec3) {
    (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]))
}

/// The part of a convex polygon where the coordinate along `axis` is at least (`sign` 1) or at most
/// (`sign` -1) `limit`.
fn beyond(polygon: &Polygon, axis: usize, limit: f64, sign: f64) -> Polygon {
    let inside = |p: DVec3| (p[axis] - limit) * sign >= 0.0;
    let mut kept = Polygon::new();
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        if inside(p) {
            kept.push(p);
        }
        if inside(p) != inside(q) {
            let mut cut = p + (q - p) * ((limit - p[axis]) / (q[axis] - p[axis]));
            cut[axis] = limit;
            kept.push(cut);
        }
    }
    kept
}

/// The part of a convex polygon between two values along an axis.
fn between(polygon: &Polygon, axis: usize, lo: f64, hi: f64) -> Polygon {
    let (min, max) = polygon
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), p| (min.min(p[axis]), max.max(p[axis])));
    let above = if min < lo { &beyond(polygon, axis, lo, 1.0) } else { polygon };
    if max > hi { beyond(above, axis, hi, -1.0) } else { above.clone() }
}

/// Turns triangles into rows of the cells of a block.
pub(super) struct Raster<'a> {
    grid: &'a Grid,
    lo: IVec3,
    hi: IVec3,
    /// Least and greatest x in each row of the slice at hand.
    spans: Vec<(f64, f64)>,
}

impl<'a> Raster<'a> {
    /// For the cells from `lo` to `hi`, both included.
    pub(super) fn new(grid: &'a Grid, lo: IVec3, hi: IVec3) -> Self {
        Self { grid, lo, hi, spans: Vec::new() }
    }

    /// Calls `out` with runs that hold all cells of the block that the triangle meets, and no others but for
    /// its margin: at most one in each row.
    pub(super) fn triangle(&mut self, t: &[DVec3; 3], mut out: impl FnMut(CellRun)) {
        let (grid, room) = (self.grid, margin(t));
        let (min, max) = box_of(t);
        let (first, last) = grid.cover(min - room, max + room);
        let (a, b) = (first.max(self.lo), last.min(self.hi));
        if a.cmpgt(b).any() {
            return;
        }
        if first.y == last.y && first.z == last.z {
            // A connected set in one row meets all cells between its ends.
            out(CellRun { x0: a.x, x1: b.x, y: a.y, z: a.z });
            return;
        }
        let slab = |axis: usize, from: i32, to: i32| {
            (grid.plane(axis, from) - room, grid.plane(axis, to + 1) + room)
        };
        let mut whole = Polygon::from_slice(t);
        // What lies beside the block has rows too, which are not to be visited.
        for axis in [0, 1] {
            let (lo, hi) = slab(axis, a[axis], b[axis]);
            whole = between(&whole, axis, lo, hi);
        }
        for z in a.z..=b.z {
            let (lo, hi) = slab(2, z, z);
            let slice = between(&whole, 2, lo, hi);
            self.slice(&slice, room, (a, b), z, &mut out);
        }
    }

    /// The rows of a slice.
    fn slice(
        &mut self,
        slice: &Polygon,
        room: f64,
        (a, b): (IVec3, IVec3),
        z: i32,
        out: &mut impl FnMut(CellRun),
    ) {
        let grid = self.grid;
        let (low, high) = slice
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p.y), high.max(p.y)));
        if low > high {
            return;
        }
        let rows = |low: f64, high: f64| {
            (grid.cell_along(1, low - room).max(a.y), grid.cell_along(1, high + room).min(b.y))
        };
        let (y0, y1) = rows(low, high);
        self.spans.clear();
        self.spans.resize((y1 - y0 + 1).max(0) as usize, (f64::INFINITY, f64::NEG_INFINITY));
        for (i, &p) in slice.iter().enumerate() {
            let q = slice[(i + 1) % slice.len()];
            let (p, q) = if p.y <= q.y { (p, q) } else { (q, p) };
            let (left, right) = (p.x.min(q.x), p.x.max(q.x));
            let slope = (q.x - p.x) / (q.y - p.y);
            let (first, last) = rows(p.y, q.y);
            for y in first..=last {
                let span = &mut self.spans[(y - y0) as usize];
                if first == last || !slope.is_finite() {
                    *span = (span.0.min(left), span.1.max(right));
                    continue;
                }
                for at in [(grid.plane(1, y) - room).max(p.y), (grid.plane(1, y + 1) + room).min(q.y)] {
                    let x = (p.x + (at - p.y) * slope).clamp(left, right);
                    *span = (span.0.min(x), span.1.max(x));
                }
            }
        }
        for (y, &(left, right)) in (y0..).zip(&self.spans) {
            if left > right {
                continue;
            }
            let x0 = grid.cell_along(0, left - room).max(a.x);
            let x1 = grid.cell_along(0, right + room).min(b.x);
            if x0 <= x1 {
                out(CellRun { x0, x1, y, z });
            }
        }
    }
}
