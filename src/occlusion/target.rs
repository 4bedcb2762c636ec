//! Targets: the bounds of what is tested, rounded outwards.

use glam::{DMat3, DVec3};
use smallvec::SmallVec;

use super::face::{Face, Rect};
use super::outline::{Half, Outline, Polytope};
use super::silhouette::Silhouette;
use crate::geometry::Block;

/// What is tested, relative to the origin of the rays.
#[derive(Debug, Clone)]
pub(crate) struct Target {
    outline: Outline,
    vertices: SmallVec<[DVec3; 8]>,
    block: Block,
}

/// A target as one face sees it.
#[derive(Debug)]
pub(crate) struct FaceTarget {
    pub(crate) silhouette: Silhouette,
    pub(crate) rect: Rect,
    /// No point of it is nearer, on this face.
    pub(crate) near: f32,
}

impl Target {
    pub(crate) fn sphere(center: DVec3, radius: f64) -> Self {
        let block = Block { min: center - radius, max: center + radius };
        Self { outline: Outline::Sphere { center, radius }, vertices: SmallVec::new(), block }
    }

    pub(crate) fn block(block: Block, direction: Option<DVec3>) -> Self {
        let polytope = Polytope::block(&block);
        Self { outline: polytope.outline(direction), vertices: polytope.vertices, block }
    }

    /// A box of half-axes `axes`.
    pub(crate) fn oriented(center: DVec3, axes: &DMat3, direction: Option<DVec3>) -> Self {
        let polytope = Polytope::boxed(center, axes);
        let block = polytope.bounds();
        Self { outline: polytope.outline(direction), vertices: polytope.vertices, block }
    }

    /// The distance to it along the axis on which it is farthest from the origin: a lower
    /// bound of the depth of all its points, on whatever face they are.
    pub(crate) fn chessboard_distance(&self) -> f64 {
        self.block.min.max(-self.block.max).max_element().max(0.0)
    }

    pub(crate) fn on_face(&self, face: &Face) -> Option<FaceTarget> {
        let (mut rect, mut depth) = face.block(&self.block)?;
        let silhouette = Silhouette::new(&self.outline, face);
        let tighter = match &self.outline {
            Outline::Sphere { center, radius } => {
                depth = depth.max(center.dot(face.forward) - radius);
                silhouette.conic_rect()
            }
            _ => face.points(&self.vertices).map(|(r, near)| {
                depth = depth.max(near);
                r
            }),
        };
        rect = rect.grown();
        if let Some(tighter) = tighter {
            rect = rect.meet(&tighter.grown())?;
        }
        Some(FaceTarget { silhouette, rect, near: above(face.nearness_of(depth)) })
    }

    /// Whether all of it lies behind the planes, as `m . x <= h`: what is less, by a margin
    /// for sums of coordinates.
    pub(crate) fn is_behind(&self, planes: &[Half]) -> bool {
        planes.iter().all(|&(m, h)| {
            let most = match &self.outline {
                Outline::Sphere { center, radius } => m.dot(*center) + radius,
                _ if !self.vertices.is_empty() => {
                    self.vertices.iter().map(|v| m.dot(*v)).fold(f64::NEG_INFINITY, f64::max)
                }
                _ => m.dot(DVec3::select(m.cmpge(DVec3::ZERO), self.block.max, self.block.min)),
            };
            let reach = self.block.min.abs().max(self.block.max.abs()).max_element() + h.abs();
            most <= h - 1e-9 * reach
        })
    }
}

/// Rounds a nearness to single precision, upwards by at least a part in 2^22.
pub(crate) fn above(near: f64) -> f32 {
    let n = near as f32;
    n + n.abs() * 2.4e-7
}

/// Rounds a nearness to single precision, downwards by at least a part in 2^22.
pub(crate) fn below(near: f64) -> f32 {
    let n = near as f32;
    n - n.abs() * 2.4e-7
}
