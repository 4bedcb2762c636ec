//! Cells that pass a test, row by row.

use glam::{DVec3, IVec3};

use crate::grid::Grid;
use crate::grid::run::CellRun;

/// The cells of a box between `lo` and `hi` that pass a test which the cells of each row pass in
/// one run.
pub(crate) fn filtered(
    grid: &Grid,
    (min, max): (DVec3, DVec3),
    (lo, hi): (IVec3, IVec3),
    passes: impl Fn(DVec3, DVec3) -> bool,
    out: &mut dyn FnMut(CellRun),
) {
    let (a, b) = grid.cover(min, max);
    let (lo, hi) = (a.max(lo), b.min(hi));
    for z in lo.z..=hi.z {
        for y in lo.y..=hi.y {
            let test = |x: &i32| {
                let (a, b) = grid.cell_bounds(IVec3::new(*x, y, z));
                passes(a, b)
            };
            if let Some(x0) = (lo.x..=hi.x).find(test) {
                let x1 = (x0..=hi.x).rev().find(test).unwrap_or(x0);
                out(CellRun { x0, x1, y, z });
            }
        }
    }
}
