//! The cells of convex solids.
//!
//! A cell is inside if no corner of it lies beyond a face, and touched if it is not wholly beyond
//! one face. Faces are moved by [`DISTANCE`] of the coordinates, outwards or inwards.

use glam::{DVec3, IVec3};

use crate::geometry::plane::HalfSpace;
use crate::grid::Grid;
use crate::grid::run::CellRun;
use crate::numeric::shape::DISTANCE;
use crate::shape::Shape;
use crate::shape::convex::Convex;
use crate::shape::filter::filtered;

impl Convex {
    /// Whether no face separates a box from the solid that was asked for.
    fn near(&self, min: DVec3, max: DVec3) -> bool {
        self.faces.iter().all(|face| {
            let nearest = DVec3::select(face.normal.cmple(DVec3::ZERO), min, max);
            -face.normal.dot(nearest) <= face.offset + margin(face, min.abs().max(max.abs())) + self.lost
        })
    }

    /// Whether a box lies behind all faces.
    fn holds(&self, min: DVec3, max: DVec3) -> bool {
        self.faces.iter().all(|face| {
            let farthest = DVec3::select(face.normal.cmple(DVec3::ZERO), max, min);
            -face.normal.dot(farthest) <= face.offset - margin(face, min.abs().max(max.abs()))
        })
    }
}

/// How far the distance of a point from a face may be off.
fn margin(face: &HalfSpace, p: DVec3) -> f64 {
    DISTANCE * (p.abs().max_element() + face.offset.abs())
}

impl Shape for Convex {
    fn bounds(&self) -> (DVec3, DVec3) {
        let (min, max) = self.corner_bounds();
        (min - self.lost, max + self.lost)
    }

    fn contains_box(&self, min: DVec3, max: DVec3) -> bool {
        self.holds(min, max)
    }

    fn contains_point(&self, point: DVec3) -> bool {
        self.faces.iter().all(|face| -face.normal.dot(point) <= face.offset + margin(face, point) + self.lost)
    }

    fn touched_rows(&self, grid: &Grid, lo: IVec3, hi: IVec3, out: &mut dyn FnMut(CellRun)) {
        filtered(grid, self.bounds(), (lo, hi), |min, max| self.near(min, max), out);
    }

    fn opaque_rows(&self, grid: &Grid, lo: IVec3, hi: IVec3, out: &mut dyn FnMut(CellRun)) {
        filtered(grid, self.bounds(), (lo, hi), |min, max| self.holds(min, max), out);
    }

    fn misses(&self, min: DVec3, max: DVec3) -> bool {
        !self.near(min, max)
    }
}
