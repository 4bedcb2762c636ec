//! Axis-aligned boxes: exact, since cell planes are exact.

use glam::{DVec3, IVec3};

use super::{CellRun, Shape};
use crate::Aabb;
use crate::geometry::Block;
use crate::grid::Grid;

fn runs(block: Option<(IVec3, IVec3)>, out: &mut dyn FnMut(CellRun)) {
    let Some((lo, hi)) = block else { return };
    for z in lo.z..=hi.z {
        for y in lo.y..=hi.y {
            out(CellRun { x0: lo.x, x1: hi.x, y, z });
        }
    }
}

impl Shape for Aabb {
    fn bounds(&self) -> (DVec3, DVec3) {
        (self.min.as_dvec3(), self.max.as_dvec3())
    }

    fn touched(&self, grid: &Grid, out: &mut dyn FnMut(CellRun)) {
        let (lo, hi) = grid.cover(self.min.as_dvec3(), self.max.as_dvec3());
        runs(grid.clip(lo, hi), out);
    }

    fn opaque(&self, grid: &Grid, out: &mut dyn FnMut(CellRun)) {
        runs(grid.inside(self.min.as_dvec3(), self.max.as_dvec3()), out);
    }

    fn contains_box(&self, min: DVec3, max: DVec3) -> bool {
        Block::from(*self).contains(&Block { min, max })
    }

    fn contains_point(&self, point: DVec3) -> bool {
        Block::from(*self).contains_point(point)
    }
}
