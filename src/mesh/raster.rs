//! Triangles as rows of cells.
//!
//! A triangle is cut into slices between planes along z, and the outline of each slice is followed
//! from row to row: the cost is that of the rows touched, however large the box around the
//! triangle.

use glam::{DVec3, IVec3};
use smallvec::SmallVec;

use crate::grid::Grid;
use crate::grid::run::CellRun;
use crate::numeric::mesh::TRIANGLE;

/// A triangle cut by three pairs of planes has at most nine corners.
type Polygon = SmallVec<[DVec3; 9]>;

/// By how much a triangle is widened.
pub(crate) fn margin(t: &[DVec3; 3]) -> f64 {
    t.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max) * TRIANGLE
}

/// The least box around a triangle.
pub(crate) fn box_of(t: &[DVec3; 3]) -> (DVec3, DVec3) {
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
pub(crate) struct CellRaster<'a> {
    grid: &'a Grid,
    lo: IVec3,
    hi: IVec3,
    /// Least and greatest x in each row of the slice at hand.
    spans: Vec<(f64, f64)>,
}

impl<'a> CellRaster<'a> {
    /// For the cells from `lo` to `hi`, both included.
    pub(crate) fn new(grid: &'a Grid, lo: IVec3, hi: IVec3) -> Self {
        Self { grid, lo, hi, spans: Vec::new() }
    }

    /// Calls `out` with runs of all cells of the block that the triangle touches, and no others but
    /// for its margin: at most one in each row.
    pub(crate) fn triangle(&mut self, t: &[DVec3; 3], mut out: impl FnMut(CellRun)) {
        let (grid, room) = (self.grid, margin(t));
        let (min, max) = box_of(t);
        let (first, last) = grid.cover(min - room, max + room);
        let (a, b) = (first.max(self.lo), last.min(self.hi));
        if a.cmpgt(b).any() {
            return;
        }
        if first.y == last.y && first.z == last.z {
            // A connected set in one row touches all cells between its ends.
            out(CellRun { x0: a.x, x1: b.x, y: a.y, z: a.z });
            return;
        }
        let slab = |axis: usize, from: i32, to: i32| {
            (grid.plane(axis, from) - room, grid.plane(axis, to + 1) + room)
        };
        let mut whole = Polygon::from_slice(t);
        // Parts beside the block have rows too, which are not to be visited.
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::mesh::triangle::triangle_meets_box;
    use crate::random::Random;

    /// Rows of a triangle as cells: each row comes once.
    fn rows(t: &[DVec3; 3], grid: &Grid, lo: IVec3, hi: IVec3) -> BTreeSet<[i32; 3]> {
        let (mut cells, mut seen) = (BTreeSet::new(), BTreeSet::new());
        CellRaster::new(grid, lo, hi).triangle(t, |run| {
            assert!(lo.x <= run.x0 && run.x0 <= run.x1 && run.x1 <= hi.x, "{run:?}");
            assert!(seen.insert((run.z, run.y)));
            cells.extend(run.cells().map(|c| c.to_array()));
        });
        cells
    }

    /// Each cell of a block on its own, tested with a margin.
    fn one_by_one(t: &[DVec3; 3], grid: &Grid, lo: IVec3, hi: IVec3, margin: f64) -> BTreeSet<[i32; 3]> {
        let mut cells = BTreeSet::new();
        for z in lo.z..=hi.z {
            for y in lo.y..=hi.y {
                for x in lo.x..=hi.x {
                    if triangle_meets_box(t, grid.cell_bounds(IVec3::new(x, y, z)), margin) {
                        cells.insert([x, y, z]);
                    }
                }
            }
        }
        cells
    }

    /// A triangle of some kind around a grid from 0 to 12, corners in single precision.
    fn triangle(kind: usize, random: &mut Random) -> [DVec3; 3] {
        let mut any = |lo: f64, hi: f64| {
            DVec3::from_array([(); 3].map(|()| lo + (hi - lo) * random.next())).as_vec3().as_dvec3()
        };
        let (a, b, c) = (any(-3.0, 15.0), any(-3.0, 15.0), any(-3.0, 15.0));
        let flat = |p: DVec3, axis: usize, at: f64| {
            let mut p = p;
            p[axis] = at;
            p
        };
        match kind {
            // Anywhere, on the lattice, in a plane of it, or in the middle of cells.
            0 => [a, b, c],
            1 => [a.round(), b.round(), c.round()],
            2..5 => [flat(a, kind - 2, 5.0), flat(b, kind - 2, 5.0), flat(c, kind - 2, 5.0)],
            5..8 => [flat(a, kind - 5, 5.5), flat(b, kind - 5, 5.5), flat(c, kind - 5, 5.5)],
            // Needles, segments and points.
            8 => [a, b, (b + any(-0.01, 0.01)).as_vec3().as_dvec3()],
            9 => [a, b, b],
            10 => [a, a, a],
            11 => [a, a.round(), (2.0 * a.round() - a).as_vec3().as_dvec3()],
            // Small, and far longer than the grid.
            12 => [a, a + any(-0.5, 0.5), a + any(-0.5, 0.5)].map(|p| p.as_vec3().as_dvec3()),
            13 => [a, b * 1e6, c],
            14 => [a * 1e4, b * -1e4, c],
            _ => [a, flat(a, kind % 3, 14.0), flat(b, kind % 3, -2.0)],
        }
    }

    #[test]
    fn rows_hold_the_cells_that_are_met_one_by_one() {
        let grid = Grid::new(1.0).unwrap();
        let mut random = Random::new(3);
        let (mut met, mut more) = (0, 0);
        for round in 0..3200 {
            let t = triangle(round % 16, &mut random);
            let hi = IVec3::splat(11);
            let lo = if round % 5 == 0 { IVec3::new(3, 2, 4) } else { IVec3::ZERO };
            let own = rows(&t, &grid, lo, hi);
            // The test by cells errs too: by less than half of the margin.
            let least = one_by_one(&t, &grid, lo, hi, 0.5 * margin(&t));
            let most = one_by_one(&t, &grid, lo, hi, 2.0 * margin(&t));
            assert!(least.is_subset(&own), "{t:?}: {:?} are missing", least.difference(&own));
            assert!(own.is_subset(&most), "{t:?}: {:?} are too many", own.difference(&most));
            (met, more) = (met + own.len(), more + most.len() - own.len());
        }
        assert!(met > 30_000 && more * 1000 < met, "{met} {more}");
    }

    #[test]
    fn rows_hold_all_points_of_triangles_anywhere() {
        let mut random = Random::new(11);
        for (min, cell) in [(0.0, 1.0), (-0.3, 0.1), (1e6, 0.25), (123.456, 0.0625), (-1e-3, 1e-4)] {
            let grid = Grid::new(cell).unwrap().shifted(DVec3::splat(min)).unwrap().0;
            for round in 0..320 {
                let place = |p: DVec3| (grid.min() + p * grid.cell_size()).as_vec3().as_dvec3();
                let t = triangle(round % 13, &mut random).map(place);
                let own = rows(&t, &grid, IVec3::ZERO, IVec3::splat(11));
                for _ in 0..200 {
                    let (u, v) = (random.next(), random.next());
                    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                    let (u, v) = if round % 2 == 0 { (u, v) } else { (u, 0.0) };
                    let cell = grid.cell_of(t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v);
                    let inside = cell.cmpge(IVec3::ZERO).all() && cell.cmplt(IVec3::splat(12)).all();
                    assert!(!inside || own.contains(&cell.to_array()), "{t:?} {cell}");
                }
            }
        }
    }

    #[test]
    fn large_triangles_cost_their_rows() {
        // Some 8 million cells are met; the box around them has 2^36.
        let grid = Grid::new(1.0).unwrap();
        let t =
            [DVec3::new(1.0, 1.0, 1.0), DVec3::new(4095.0, 30.0, 4000.0), DVec3::new(200.0, 4090.0, 4000.0)];
        let (mut runs, mut cells) = (0u64, 0u64);
        CellRaster::new(&grid, IVec3::ZERO, IVec3::splat(4095)).triangle(&t, |run| {
            runs += 1;
            cells += (run.x1 - run.x0 + 1) as u64;
        });
        assert!(runs > 1_000_000 && cells > 8_000_000 && cells < 40_000_000, "{runs} {cells}");
    }
}
