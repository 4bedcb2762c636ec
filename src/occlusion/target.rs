//! Targets: the bounds of tested objects, rounded outwards.

use glam::DVec3;

use crate::geometry::aspect::{Aspect, Outline};
use crate::geometry::body::Body;
use crate::geometry::polytope::Part;
use crate::geometry::{Block, Room};
use crate::numeric::occlusion::above;
use crate::occlusion::face::{Face, Linear, Rect};
use crate::occlusion::front::Front;
use crate::occlusion::silhouette::Silhouette;

/// The bounds of a tested object, relative to the origin of the rays.
#[derive(Debug, Clone, Default)]
pub(crate) struct Target {
    aspect: Aspect,
}

/// A target as one face sees it.
#[derive(Debug, Default)]
pub(crate) struct FaceTarget {
    pub(crate) silhouette: Silhouette,
    pub(crate) rect: Rect,
    /// No point of it is nearer, on this face.
    pub(crate) near: f32,
    front: Front,
}

impl FaceTarget {
    /// No point of the target in the rectangle is nearer.
    pub(crate) fn near(&self, rect: &Rect) -> f32 {
        self.near.min(above(self.front.nearest(rect)))
    }

    /// Whether all of the target in a rectangle lies behind a plane, given by its nearness.
    #[inline]
    pub(crate) fn is_behind_plane(&self, plane: &Linear, rect: &Rect) -> bool {
        self.front.is_behind(plane, rect)
    }

    /// Nearness in one direction of the silhouette, not rounded outwards.
    pub(crate) fn at(&self, u: f64, v: f64) -> f64 {
        self.front.at(u, v)
    }
}

impl Target {
    /// A body to test.
    pub(crate) fn new(body: &Body, direction: Option<DVec3>) -> Self {
        let mut target = Self::default();
        target.set_body(body, direction);
        target
    }

    #[cfg(test)]
    pub(crate) fn block(block: Block, direction: Option<DVec3>) -> Self {
        Self::new(&Body::Block(block), direction)
    }

    /// Makes it a body.
    pub(crate) fn set_body(&mut self, body: &Body, direction: Option<DVec3>) {
        self.aspect.set_body(body, direction, &Room::NONE);
    }

    /// Makes it a part of a mesh; the box around it is given.
    pub(crate) fn set_part(&mut self, part: &Part, block: Block, direction: Option<DVec3>) {
        self.aspect.set_part(part, block, direction, &Room::NONE);
    }

    /// A box around it.
    pub(crate) fn bounds(&self) -> &Block {
        &self.aspect.block
    }

    /// Fills in how a face sees it. Returns whether the face does.
    pub(crate) fn on_face(&self, face: &Face, seen: &mut FaceTarget) -> bool {
        let Aspect { outline, vertices, block, .. } = &self.aspect;
        let Some((mut rect, (mut depth, _))) = face.block(block) else { return false };
        seen.silhouette.set(&self.aspect, face);
        let tighter = match outline {
            Outline::Sphere { center, radius } => {
                depth = depth.max(center.dot(face.forward) - radius);
                seen.silhouette.kind().conic_rect()
            }
            // The rectangle around a box is exact if the box lies in front of the eye.
            _ if vertices.is_empty() => None,
            _ => face.points(vertices).map(|(r, near)| {
                depth = depth.max(near);
                r
            }),
        };
        rect = rect.grown();
        if let Some(tighter) = tighter {
            let Some(both) = rect.intersect(&tighter.grown()) else { return false };
            rect = both;
        }
        seen.front.set(face, &self.aspect, f64::INFINITY, self.aspect.largest());
        (seen.rect, seen.near) = (rect, above(face.nearness_of(depth)));
        true
    }
}
