//! Targets: the bounds of tested objects, rounded outwards.

use glam::{DMat3, DVec3};
use smallvec::SmallVec;

use crate::geometry::body::Body;
use crate::geometry::plane::HalfSpace;
use crate::geometry::polytope::{Outline, Part, Polytope, outline_of_block};
use crate::geometry::{Block, Room};
use crate::numeric::occlusion::{BEHIND, above};
use crate::occlusion::face::{Face, Linear, Rect};
use crate::occlusion::front::Front;
use crate::occlusion::silhouette::Silhouette;
use crate::occlusion::solid::Shadow;

/// The bounds of a tested object, relative to the origin of the rays.
#[derive(Debug, Clone)]
pub(crate) struct Target {
    outline: Outline,
    /// Its corners; none for spheres and for boxes along the axes.
    vertices: SmallVec<[DVec3; 8]>,
    fronts: SmallVec<[HalfSpace; 3]>,
    block: Block,
}

/// A target as one face sees it.
#[derive(Debug)]
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
    pub(crate) fn new(body: Body, direction: Option<DVec3>) -> Self {
        match body {
            Body::Sphere { center, radius } => Self::sphere(center, radius),
            Body::Block(block) => Self::block(block, direction),
            Body::Oriented { center, axes } => Self::oriented(center, &axes, direction),
            Body::Polytope(polytope) => {
                let block = polytope.bounds();
                Self::polytope(polytope, block, direction)
            }
        }
    }

    pub(crate) fn sphere(center: DVec3, radius: f64) -> Self {
        let block = Block { min: center - radius, max: center + radius };
        let outline = Outline::Sphere { center, radius };
        Self { outline, vertices: SmallVec::new(), fronts: SmallVec::new(), block }
    }

    pub(crate) fn block(block: Block, direction: Option<DVec3>) -> Self {
        if direction.is_some() {
            return Self::polytope(Polytope::block(&block), block, direction);
        }
        let (outline, fronts) = outline_of_block(&block);
        Self { outline, fronts, vertices: SmallVec::new(), block }
    }

    /// A box of half-axes `axes`.
    pub(crate) fn oriented(center: DVec3, axes: &DMat3, direction: Option<DVec3>) -> Self {
        let polytope = Polytope::boxed(center, axes);
        let block = polytope.bounds();
        Self::polytope(polytope, block, direction)
    }

    pub(crate) fn polytope(polytope: Polytope, block: Block, direction: Option<DVec3>) -> Self {
        let (outline, fronts) = (polytope.outline(direction, &Room::NONE), polytope.fronts(direction));
        Self { outline, fronts, vertices: polytope.vertices, block }
    }

    /// A part of a mesh; the box around it is given.
    pub(crate) fn part(part: &Part, block: Block, direction: Option<DVec3>) -> Self {
        let (vertices, outline, fronts) = part.seen(direction, &Room::NONE);
        Self { outline, fronts, vertices, block }
    }

    /// The greatest magnitude of its coordinates.
    fn largest(&self) -> f64 {
        self.block.min.abs().max(self.block.max.abs()).max_element()
    }

    /// Its middle.
    pub(crate) fn middle(&self) -> DVec3 {
        (self.block.min + self.block.max) * 0.5
    }

    /// A box around it.
    pub(crate) fn bounds(&self) -> &Block {
        &self.block
    }

    pub(crate) fn on_face(&self, face: &Face) -> Option<FaceTarget> {
        let (mut rect, (mut depth, _)) = face.block(&self.block)?;
        let silhouette = Silhouette::new(&self.outline, face);
        let tighter = match &self.outline {
            Outline::Sphere { center, radius } => {
                depth = depth.max(center.dot(face.forward) - radius);
                silhouette.conic_rect()
            }
            // The rectangle around a box is exact if the box lies in front of the eye.
            _ if self.vertices.is_empty() => None,
            _ => face.points(&self.vertices).map(|(r, near)| {
                depth = depth.max(near);
                r
            }),
        };
        rect = rect.grown();
        if let Some(tighter) = tighter {
            rect = rect.intersect(&tighter.grown())?;
        }
        let front = Front::new(face, &self.outline, &self.fronts, f64::INFINITY, self.largest());
        Some(FaceTarget { silhouette, rect, near: above(face.nearness_of(depth)), front })
    }

    /// Whether all of the target lies behind the front of a solid: behind its planes, or inside its
    /// ball. Then the solid hides every part of the target that its silhouette covers.
    pub(crate) fn is_behind(&self, shadow: &Shadow) -> bool {
        let inside = shadow.ball.is_some_and(|(center, radius)| {
            let farthest = match &self.outline {
                Outline::Sphere { center: own, radius: r } => (*own - center).length() + r,
                _ => (self.block.min - center).abs().max((self.block.max - center).abs()).length(),
            };
            farthest <= radius - BEHIND * (radius + center.abs().max_element())
        });
        inside
            || shadow.planes.iter().all(|&HalfSpace { normal: n, offset: h }| {
                let most = match &self.outline {
                    Outline::Sphere { center, radius } => -n.dot(*center) + radius,
                    _ if !self.vertices.is_empty() => {
                        self.vertices.iter().map(|v| -n.dot(*v)).fold(f64::NEG_INFINITY, f64::max)
                    }
                    _ => -n.dot(DVec3::select(n.cmple(DVec3::ZERO), self.block.max, self.block.min)),
                };
                most <= h - BEHIND * (self.largest() + h.abs())
            })
    }
}
