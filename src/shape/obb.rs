//! Boxes turned by a rotation.
//!
//! A cell is inside if its corners are, and touched if no face of the box keeps it out. Faces are moved by
//! [`DISTANCE`] of the coordinates, outwards or inwards.

use glam::{DMat3, DVec3, IVec3};

use crate::geometry::{Block, Obb};
use crate::grid::Grid;
use crate::grid::run::CellRun;
use crate::numeric::shape::DISTANCE;
use crate::shape::Shape;
use crate::shape::filter::filtered;
use crate::shape::traits::Rows;

impl Obb {
    /// Centre, half-axes as columns, and the margin of coordinates.
    pub(crate) fn parts(&self) -> (DVec3, DMat3, f64) {
        let (c, half) = (self.center.as_dvec3(), self.half.as_dvec3());
        let turn = DMat3::from_quat(self.rotation.as_dquat().normalize());
        let axes = DMat3::from_cols(turn.x_axis * half.x, turn.y_axis * half.y, turn.z_axis * half.z);
        (c, axes, DISTANCE * (c.abs().max_element() + half.max_element()))
    }

    /// Unit axes.
    pub(crate) fn turn(&self) -> DMat3 {
        DMat3::from_quat(self.rotation.as_dquat().normalize())
    }

    /// Asks whether no face keeps a box out.
    fn near(&self) -> impl Fn(DVec3, DVec3) -> bool {
        let (c, _, margin) = self.parts();
        let (turn, half) = (self.turn(), self.half.as_dvec3());
        move |min: DVec3, max: DVec3| {
            let (d, reach) = ((min + max) * 0.5 - c, (max - min) * 0.5);
            let slack = margin + DISTANCE * max.abs().max(min.abs()).max_element();
            (0..3).all(|i| turn.col(i).dot(d).abs() <= half[i] + turn.col(i).abs().dot(reach) + slack)
        }
    }

    /// Asks whether a box lies behind all faces.
    fn holds(&self) -> impl Fn(DVec3, DVec3) -> bool {
        let (c, _, margin) = self.parts();
        let (turn, half) = (self.turn(), self.half.as_dvec3());
        move |min: DVec3, max: DVec3| {
            let slack = margin + DISTANCE * max.abs().max(min.abs()).max_element();
            Block { min, max }
                .corners()
                .iter()
                .all(|&p| (0..3).all(|i| turn.col(i).dot(p - c).abs() <= half[i] - slack))
        }
    }
}

impl Shape for Obb {
    fn bounds(&self) -> (DVec3, DVec3) {
        let (c, axes, margin) = self.parts();
        let reach = axes.x_axis.abs() + axes.y_axis.abs() + axes.z_axis.abs() + margin;
        (c - reach, c + reach)
    }

    fn touched(&self, grid: &Grid, out: &mut dyn FnMut(CellRun)) {
        self.touched_rows(grid, IVec3::ZERO, grid.dims() - 1, out);
    }

    fn opaque(&self, grid: &Grid, out: &mut dyn FnMut(CellRun)) {
        self.opaque_rows(grid, IVec3::ZERO, grid.dims() - 1, out);
    }

    fn contains_box(&self, min: DVec3, max: DVec3) -> bool {
        self.holds()(min, max)
    }

    fn contains_point(&self, point: DVec3) -> bool {
        let (c, _, margin) = self.parts();
        let (turn, half) = (self.turn(), self.half.as_dvec3());
        let slack = margin + DISTANCE * point.abs().max_element();
        (0..3).all(|i| turn.col(i).dot(point - c).abs() <= half[i] + slack)
    }
}

impl Rows for Obb {
    fn touched_rows(&self, grid: &Grid, lo: IVec3, hi: IVec3, out: &mut dyn FnMut(CellRun)) {
        filtered(grid, self.bounds(), (lo, hi), self.near(), out);
    }

    fn opaque_rows(&self, grid: &Grid, lo: IVec3, hi: IVec3, out: &mut dyn FnMut(CellRun)) {
        filtered(grid, self.bounds(), (lo, hi), self.holds(), out);
    }

    fn misses(&self, min: DVec3, max: DVec3) -> bool {
        !self.near()(min, max)
    }
}
