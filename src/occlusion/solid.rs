//! Occluders ready to be drawn, rounded inwards.

use glam::DVec3;
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::geometry::body::Body;
use crate::geometry::plane::HalfSpace;
use crate::geometry::polytope::{Outline, Part, Polytope, outline_of_block};
use crate::numeric::occlusion::SPHERE_AROUND_EYE;
use crate::occlusion::face::{Face, Rect};
use crate::occlusion::front::{Front, contour_depth};
use crate::occlusion::silhouette::Silhouette;

/// The space behind the front of a solid. The solid hides all of it that its silhouette covers.
#[derive(Debug, Clone)]
pub(crate) struct Shadow {
    /// Inside all of these half-spaces;
    pub(crate) planes: SmallVec<[HalfSpace; 3]>,
    /// or inside this ball.
    pub(crate) ball: Option<(DVec3, f64)>,
}

/// A convex occluder relative to the origin of the rays.
#[derive(Debug, Clone)]
pub(crate) struct Solid {
    outline: Outline,
    pub(crate) shadow: Shadow,
    /// Its corners; none for spheres and for boxes along the axes.
    vertices: SmallVec<[DVec3; 8]>,
    block: Block,
}

/// The part of a solid that a face sees.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seen {
    /// A rectangle around it.
    pub(crate) rect: Rect,
    /// Its least depth, and the greatest depth of the silhouette along the face's axis.
    pub(crate) near: f64,
    pub(crate) far: f64,
}

impl Solid {
    /// A body to draw; `None` if the eye is in it or too close to tell.
    ///
    /// With a `reach`, it hides a point only if it hides it from all eyes within that distance,
    /// which all lie outside of it.
    pub(crate) fn new(body: Body, direction: Option<DVec3>, reach: f64) -> Option<Self> {
        match body {
            // A smaller sphere covers nearly the same directions.
            Body::Sphere { center, radius } => Self::sphere(center, radius - reach, direction),
            Body::Block(block) => Self::block(block, direction, reach),
            Body::Oriented { center, axes } => {
                Self::polytope(Polytope::boxed(center, &axes), direction, reach)
            }
            Body::Polytope(polytope) => Self::polytope(polytope, direction, reach),
        }
    }

    /// A box along the axes, as [`Solid::new`] draws it; `None` if the eye is in it or too close to
    /// tell.
    pub(crate) fn block(block: Block, direction: Option<DVec3>, reach: f64) -> Option<Self> {
        if direction.is_some() || reach > 0.0 {
            return Self::polytope(Polytope::block(&block), direction, reach);
        }
        let (outline, planes) = outline_of_block(&block);
        let drawable = matches!(outline, Outline::Cone(_)) && !planes.is_empty();
        let shadow = Shadow { planes, ball: None };
        drawable.then(|| Self { outline, shadow, vertices: SmallVec::new(), block })
    }

    /// A sphere; `None` if the eye is in it.
    pub(crate) fn sphere(center: DVec3, radius: f64, direction: Option<DVec3>) -> Option<Self> {
        let distance = center.length();
        let front = match direction {
            Some(d) => HalfSpace { normal: d, offset: -center.dot(d) },
            None => {
                let offset = -(distance - radius) * (distance + radius) / distance;
                HalfSpace { normal: center / distance, offset }
            }
        };
        let outside = direction.is_some() || distance > radius * (1.0 + SPHERE_AROUND_EYE);
        (radius > 0.0 && outside && front.normal.is_finite()).then(|| Self {
            outline: Outline::Sphere { center, radius },
            shadow: Shadow { planes: SmallVec::from_iter([front]), ball: Some((center, radius)) },
            vertices: SmallVec::new(),
            block: Block { min: center - radius, max: center + radius },
        })
    }

    /// A polytope, as [`Solid::new`] draws it; `None` if the eye is in it or too close to tell.
    pub(crate) fn polytope(polytope: Polytope, direction: Option<DVec3>, reach: f64) -> Option<Self> {
        let outline = polytope.outline(direction, reach);
        let shadow = Shadow { planes: polytope.fronts(direction), ball: None };
        let drawable = matches!(outline, Outline::Cone(_)) && !shadow.planes.is_empty();
        let block = polytope.bounds();
        drawable.then_some(Self { outline, shadow, vertices: polytope.vertices, block })
    }

    /// A part of a mesh, as [`Solid::new`] draws it; `None` if the eye is in it or too close to
    /// tell.
    pub(crate) fn part(part: &Part, direction: Option<DVec3>, reach: f64) -> Option<Self> {
        let (vertices, outline, planes) = part.seen(direction, reach);
        let drawable = matches!(outline, Outline::Cone(_)) && !planes.is_empty();
        let shadow = Shadow { planes, ball: None };
        drawable.then(|| Self { outline, shadow, vertices, block: part.bounds() })
    }

    /// Its silhouette on a face.
    pub(crate) fn silhouette(&self, face: &Face) -> Silhouette {
        Silhouette::new(&self.outline, face)
    }

    /// Its front as a face sees it.
    pub(crate) fn front(&self, face: &Face, seen: &Seen) -> Front {
        let reach = self.block.min.abs().max(self.block.max.abs()).max_element();
        Front::new(face, &self.outline, &self.shadow.planes, seen.far, reach)
    }

    /// The part of it that a face sees.
    pub(crate) fn on_face(&self, face: &Face) -> Option<Seen> {
        let (rect, (near, far)) = face.block(&self.block)?;
        let (tighter, far) = match &self.outline {
            Outline::Sphere { center, radius } => (
                Silhouette::new(&self.outline, face).conic_rect(),
                contour_depth(*center, *radius, face.forward, face.parallel),
            ),
            // The rectangle around a box is exact if the box lies in front of the eye.
            _ if self.vertices.is_empty() => (None, far),
            _ => {
                let depths = self.vertices.iter().map(|v| v.dot(face.forward));
                (face.points(&self.vertices).map(|(r, _)| r), depths.fold(f64::NEG_INFINITY, f64::max))
            }
        };
        let rect = tighter.map_or(Some(rect), |t| rect.intersect(&t))?;
        Some(Seen { rect: rect.intersect(&Rect::FACE)?, near, far })
    }
}
