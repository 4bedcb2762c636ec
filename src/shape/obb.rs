//! Boxes turned by a rotation.
//!
//! A cell is inside if its corners are, and touched if no face of the box keeps it out. Faces are
//! moved by [`DISTANCE`] of the coordinates, outwards or inwards.

use glam::{DMat3, DVec3, IVec3, Vec3};

use crate::error::Error;
use crate::geometry::body::Body;
use crate::geometry::plane::HalfSpace;
use crate::geometry::{Block, Obb};
use crate::grid::Grid;
use crate::grid::run::CellRun;
use crate::numeric::shape::{DISTANCE, REGION};
use crate::shape::Shape;
use crate::shape::filter::filtered;
use crate::shape::kind::Kind;

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
            let (d, radius) = ((min + max) * 0.5 - c, (max - min) * 0.5);
            let slack = margin + DISTANCE * max.abs().max(min.abs()).max_element();
            (0..3).all(|i| turn.col(i).dot(d).abs() <= half[i] + turn.col(i).abs().dot(radius) + slack)
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
        let radius = axes.x_axis.abs() + axes.y_axis.abs() + axes.z_axis.abs() + margin;
        (c - radius, c + radius)
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

impl Kind for Obb {
    fn is_centered(&self) -> bool {
        true
    }

    fn check(&self, what: &'static str) -> Result<(), Error> {
        Obb::check(self, what)
    }

    fn same(&self, other: &Self) -> bool {
        self == other
    }

    fn moved(&self, offset: Vec3) -> Result<Option<Self>, Error> {
        Ok(Some(Obb { center: self.center + offset, ..*self }))
    }

    fn may_reach(&self, planes: &[HalfSpace]) -> bool {
        let (c, axes, _) = self.parts();
        let largest = c.abs().max_element() + self.half.as_dvec3().element_sum();
        planes.iter().all(|p| {
            let half: f64 = (0..3).map(|i| axes.col(i).dot(p.normal).abs()).sum();
            p.distance(c) >= -(half + p.margin(largest))
        })
    }

    fn may_meet(&self, planes: &[HalfSpace], around: &Block) -> bool {
        let (center, axes, margin) = self.parts();
        let turn = self.turn();
        let (middle, half) = ((around.min + around.max) * 0.5, (around.max - around.min) * 0.5);
        let apart = (0..3).any(|i| {
            let (way, own) = (turn.col(i), axes.col(i).length() * (1.0 + REGION));
            way.dot(middle - center).abs() > own + way.abs().dot(half) * (1.0 + REGION) + margin
        });
        !apart && self.may_reach(planes)
    }

    fn distance_from(&self, eye: DVec3) -> f64 {
        let (center, _, margin) = self.parts();
        // How far the eye lies beyond each pair of faces.
        let beyond = (self.turn().transpose() * (eye - center)).abs() - self.half.as_dvec3();
        beyond.max(DVec3::ZERO).length() - margin
    }

    fn distance_along(&self, direction: DVec3) -> f64 {
        let (center, axes, margin) = self.parts();
        center.dot(direction) - (0..3).map(|i| axes.col(i).dot(direction).abs()).sum::<f64>() - margin
    }

    fn ball(&self) -> (DVec3, f64) {
        let (center, _, margin) = self.parts();
        (center, self.half.as_dvec3().length() + margin)
    }

    fn outer(&self, origin: DVec3, grow: f64) -> Body<'_> {
        let (center, _, margin) = self.parts();
        let (turn, half) = (self.turn(), self.half.as_dvec3() + grow + margin);
        let axes = DMat3::from_cols(turn.x_axis * half.x, turn.y_axis * half.y, turn.z_axis * half.z);
        Body::Oriented { center: center - origin, axes }
    }

    fn inner(&self, origin: DVec3, shrink: f64) -> Option<Body<'_>> {
        let (center, axes, margin) = self.parts();
        let shorter = |a: DVec3| a - a.normalize_or_zero() * (shrink + margin);
        let axes = DMat3::from_cols(shorter(axes.x_axis), shorter(axes.y_axis), shorter(axes.z_axis));
        let solid = f64::from(self.half.min_element()) > shrink + margin;
        solid.then_some(Body::Oriented { center: center - origin, axes })
    }
}
