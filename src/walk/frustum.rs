//! The frustum in cells: half-spaces around the viewer's cell, clipped against one row of cells at
//! a time (thesis, section 3.4.2).

use glam::{DVec3, IVec3};
use smallvec::SmallVec;

use crate::geometry::plane::HalfSpace;
use crate::grid::Grid;
use crate::grid::side::Side;
use crate::numeric::query::{HALF_SPACE, ROW_SLOPE};
use crate::view::View;

#[derive(Debug, Clone, Copy)]
struct CellPlane {
    normal: [f64; 3],
    /// Value at the centre of the viewer's cell, widened by half a cell.
    offset: f64,
}

/// Where segments into the frustum may start: each half-space is widened until it contains that.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Start {
    /// Nowhere: the frustum stays as it is.
    None,
    /// At the eye.
    Eye,
    /// At the eye, or at any point of the viewer's cell.
    Cell,
}

/// The cells that may intersect the frustum, relative to the viewer's cell V.
///
/// Every half-space is widened until it contains the [`Start`]. The region is then convex, so
/// segments from there to any point in it stay in it.
#[derive(Debug, Clone)]
pub(crate) struct CellFrustum {
    planes: SmallVec<[CellPlane; 6]>,
}

impl CellFrustum {
    /// The frustum of a view in cells of a grid, relative to `cell`.
    pub(crate) fn new(grid: &Grid, view: &View, cell: IVec3, start: Start) -> Self {
        let (lo, hi) = grid.cell_bounds(cell);
        let center = (lo + hi) * 0.5;
        let widened = |plane: &HalfSpace| {
            let mut offset = plane.offset;
            if let (Some(at), true) = (view.eye(), start != Start::None) {
                offset += (plane.normal.abs().dot(view.eye_box()) - plane.distance(at)).max(0.0);
            }
            let half = plane.normal.abs().element_sum() * 0.5;
            let mut at_center = (plane.normal.dot(center) + offset) / grid.cell_size();
            if start == Start::Cell {
                // From here on the farthest corner of the cell lies in the half-space.
                at_center = at_center.max(half);
            }
            CellPlane { normal: plane.normal.to_array(), offset: at_center + half + HALF_SPACE }
        };
        Self { planes: view.planes.iter().map(widened).collect() }
    }

    /// Whether some cell of a block may intersect the frustum.
    pub(crate) fn meets(&self, lo: IVec3, hi: IVec3) -> bool {
        let (lo, hi) = (lo.as_dvec3(), hi.as_dvec3());
        self.planes.iter().all(|p| {
            let n = DVec3::from_array(p.normal);
            n.dot(DVec3::select(n.cmpge(DVec3::ZERO), hi, lo)) + p.offset >= 0.0
        })
    }

    /// The half-spaces on one side of a shell, prepared for single rows.
    pub(crate) fn on_side(&self, side: &Side, depth: i32) -> SideFrustum {
        let line = |p: &CellPlane| {
            let slope = p.normal[side.axes.col];
            RowPlane {
                at_zero: p.offset + p.normal[side.axes.normal] * f64::from(depth),
                by_row: p.normal[side.axes.row],
                slope,
                // A slope too small to divide by is decided at the ends of the row.
                inverse: if slope.abs() > ROW_SLOPE { 1.0 / slope } else { 0.0 },
            }
        };
        SideFrustum { planes: self.planes.iter().map(line).collect() }
    }
}

/// One half-space on a side: `at_zero + by_row * row + slope * col >= 0`.
#[derive(Debug, Clone, Copy)]
struct RowPlane {
    at_zero: f64,
    by_row: f64,
    slope: f64,
    inverse: f64,
}

/// The half-spaces of the frustum on one side of one shell.
#[derive(Debug, Clone)]
pub(crate) struct SideFrustum {
    planes: SmallVec<[RowPlane; 6]>,
}

impl SideFrustum {
    /// The columns between `lo` and `hi` of a row that may intersect the frustum.
    #[inline]
    pub(crate) fn row(&self, row: i32, (lo, hi): (i32, i32)) -> Option<(i32, i32)> {
        let (mut a, mut b) = (f64::from(lo), f64::from(hi));
        for p in &self.planes {
            let rest = p.at_zero + p.by_row * f64::from(row);
            let end = -rest * p.inverse;
            if p.inverse > 0.0 {
                a = a.max(end);
            } else if p.inverse < 0.0 {
                b = b.min(end);
            } else if rest + (p.slope * a).max(p.slope * b) < 0.0 {
                return None;
            }
        }
        // Both are between `lo` and `hi` from here on; an end that is not a number bounds nothing.
        if a > b {
            return None;
        }
        // The end may be off by one rounding of a quotient up to 2^21: far below the margin.
        let (a, b) = (ceil(a), floor(b));
        (a <= b).then_some((a, b))
    }
}

/// The floor of a number within the range of `i32`.
///
/// `f64::floor` calls a library function on processors without SSE4.1, for which this is compiled.
#[inline]
fn floor(v: f64) -> i32 {
    let whole = v as i32;
    whole - i32::from(f64::from(whole) > v)
}

#[inline]
fn ceil(v: f64) -> i32 {
    let whole = v as i32;
    whole + i32::from(f64::from(whole) < v)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use glam::camera::rh::{proj::directx, view::look_to_mat4};

    use super::*;
    use crate::geometry::Plane;

    #[test]
    fn absurd_planes_overflow_nothing() {
        let grid = Grid::new(1.0).unwrap();
        for offset in [1e38, -1e38, 3e9, -3e9, f32::MIN_POSITIVE] {
            for normal in [Vec3::ONE, Vec3::new(1.0, 1e-8, 0.0), Vec3::new(1e-30, -1e-30, 2e-30)] {
                let plane = Plane { normal, offset };
                let Ok(view) = View::from_planes(Vec3::splat(7.5), &[plane]) else { continue };
                for frustum in [
                    CellFrustum::new(&grid, &view, IVec3::splat(7), Start::Eye),
                    CellFrustum::new(&grid, &view, IVec3::splat(7), Start::Cell),
                    CellFrustum::new(&grid, &view, IVec3::splat(7), Start::None),
                ] {
                    for side in &Side::ALL {
                        let found = frustum.on_side(side, 5 * side.sign).row(3, (-5, 5));
                        assert!(found.is_none_or(|(a, b)| -5 <= a && a <= b && b <= 5));
                    }
                }
            }
        }
    }

    #[test]
    fn rows_hold_every_cell_that_the_frustum_meets() {
        let grid = Grid::new(0.5).unwrap();
        let eye = Vec3::new(5.1, 6.2, 3.3);
        let matrix =
            directx::perspective(0.9, 1.4, 0.1, 6.0) * look_to_mat4(eye, Vec3::new(0.5, 0.1, 0.8), Vec3::Y);
        let view = View::perspective(eye, matrix).unwrap();
        let v = grid.cell_of(eye.as_dvec3());
        let frustum = CellFrustum::new(&grid, &view, v, Start::Eye);
        let (mut inside, mut outside) = (0, 0);
        for m in 1..24 {
            for side in &Side::ALL {
                let on_side = frustum.on_side(side, m * side.sign);
                for row in -m..=m {
                    let found = on_side.row(row, (-m, m));
                    for col in -m..=m {
                        let mut c = IVec3::ZERO;
                        c[side.axes.normal] = m * side.sign;
                        c[side.axes.row] = row;
                        c[side.axes.col] = col;
                        let (lo, hi) = grid.cell_bounds(c + v);
                        let meets = (0..64).any(|i| {
                            let t =
                                DVec3::new(f64::from(i & 3), f64::from(i >> 2 & 3), f64::from(i >> 4)) / 3.0;
                            let p = lo + t * (hi - lo);
                            view.planes.iter().all(|h| h.distance(p) >= 0.0)
                        });
                        let listed = found.is_some_and(|(a, b)| a <= col && col <= b);
                        assert!(listed || !meets, "{c}");
                        inside += i32::from(meets);
                        outside += i32::from(listed && !meets);
                    }
                }
            }
        }
        assert!(inside > 500 && outside < inside, "{inside} {outside}");
    }
}
