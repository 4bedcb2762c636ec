//! Depths of the fronts of convex shapes on a face.

use glam::DVec3;
use smallvec::SmallVec;

use crate::geometry::aspect::{Aspect, Outline};
use crate::numeric::occlusion::{
    BALL_NEAR_EYE, BALL_OUTLINE, PLANE_BEHIND_PLANE, PLANE_NEAR_EYE, TANGENT_NEAR_EYE,
};
use crate::occlusion::face::{Face, Linear, Rect};

/// The front of a convex shape on a face, as nearness in each direction of its silhouette.
///
/// A ray enters the shape at the farthest of its front planes, or at the front of a ball. The
/// nearness is rounded both ways: [`Front::behind`] for occluders, [`Front::nearest`] for targets.
#[derive(Debug, Clone, Default)]
pub(crate) struct Front {
    planes: SmallVec<[Linear; 3]>,
    /// Whether all planes are known.
    complete: bool,
    ball: Option<Ball>,
    /// The silhouette's farthest point is at least this near.
    floor: f64,
}

#[derive(Debug, Clone, Copy)]
struct Ball {
    /// On the face: across, up, depth.
    center: DVec3,
    radius: f64,
    /// |center|^2 - radius^2.
    power: f64,
    /// Radius in units of a face across parallel rays; 0 around an eye.
    across: f64,
}

impl Ball {
    fn new(face: &Face, center: DVec3, radius: f64) -> Self {
        let distance = center.length();
        Self {
            center: face.local(center),
            radius,
            power: (distance - radius) * (distance + radius),
            across: if face.parallel { radius * face.right.length() } else { 0.0 },
        }
    }

    /// Nearness where a direction enters; not a number if it barely does or not at all, or if the
    /// eye is about as close as coordinates are exact.
    #[inline]
    fn nearness(&self, u: f64, v: f64) -> f64 {
        let c = self.center;
        if self.across > 0.0 {
            let (du, dv) = ((u - c.x) / self.across, (v - c.y) / self.across);
            let q = 1.0 - (du * du + dv * dv);
            return if q > BALL_OUTLINE { self.radius * q.sqrt() - c.z } else { f64::NAN };
        }
        let s = u * c.x + v * c.y + c.z;
        let q = s * s - (u * u + v * v + 1.0) * self.power;
        // The root keeps more than half of its digits.
        let known = (s > 0.0) & (q > BALL_OUTLINE * s * s) & (self.power > BALL_NEAR_EYE * s * s);
        if known { (s + q.sqrt()) / self.power } else { f64::NAN }
    }
}

impl Front {
    /// Makes it that of a shape on a face. `farthest` is the greatest depth of the silhouette along
    /// the face's axis, `largest` bounds the coordinates of the shape.
    pub(crate) fn set(&mut self, face: &Face, aspect: &Aspect, farthest: f64, largest: f64) {
        // Planes too close to the eye, or seen edge-on, are not known well enough.
        self.planes.clear();
        for plane in &aspect.fronts {
            if face.parallel || plane.offset.abs() > PLANE_NEAR_EYE * largest {
                self.planes.extend(face.nearness(plane));
            }
        }
        self.ball = match aspect.outline {
            Outline::Sphere { center, radius } => Some(Ball::new(face, center, radius)),
            _ => None,
        };
        self.complete = self.planes.len() == aspect.fronts.len();
        // A point behind the eye on this face gives no bound.
        self.floor = if face.parallel || farthest > 0.0 { face.nearness_of(farthest) } else { 0.0 };
    }

    /// Points of the silhouette in the rectangle that are less near than this are behind the
    /// shape's front.
    #[inline]
    pub(crate) fn behind(&self, r: &Rect) -> f64 {
        if !self.complete {
            return self.floor;
        }
        let mut near = f64::INFINITY;
        for plane in &self.planes {
            let own = plane.least(r);
            near = if own < near { own } else { near };
        }
        if near > self.floor { near } else { self.floor }
    }

    /// As [`Front::behind`], for a rectangle inside the silhouette.
    ///
    /// The depth at which rays enter a ball is greatest at a corner: the directions that enter it
    /// before some depth are those to a convex part of the ball, and so form a convex set.
    #[inline]
    pub(crate) fn behind_inside(&self, r: &Rect) -> f64 {
        let planes = self.behind(r);
        let Some(ball) = &self.ball else { return planes };
        let mut least = f64::INFINITY;
        for (u, v) in r.corners() {
            let near = ball.nearness(u, v);
            if near.is_nan() {
                return planes;
            }
            least = if near < least { near } else { least };
        }
        planes.max(least)
    }

    /// Whether the shape is nowhere in the rectangle nearer than a plane. Both are linear, so their
    /// difference is least at a corner.
    #[inline]
    pub(crate) fn is_behind(&self, plane: &Linear, r: &Rect) -> bool {
        self.ball.is_none()
            && self.planes.iter().any(|f| {
                let margin = PLANE_BEHIND_PLANE
                    * (plane.a.abs() + plane.b.abs() + plane.c.abs() + f.a.abs() + f.b.abs() + f.c.abs());
                Linear { a: plane.a - f.a, b: plane.b - f.b, c: plane.c - f.c }.least(r) >= margin
            })
    }

    /// Nearness of the front in one direction that is in the silhouette, but for rounding.
    pub(crate) fn at(&self, u: f64, v: f64) -> f64 {
        match &self.ball {
            Some(ball) => match ball.nearness(u, v) {
                near if near.is_nan() => self.floor,
                near => near,
            },
            None => self.planes.iter().map(|p| p.at(u, v)).fold(f64::INFINITY, f64::min),
        }
    }

    /// No point of the shape in the rectangle is nearer than this.
    #[inline]
    pub(crate) fn nearest(&self, r: &Rect) -> f64 {
        let Some(ball) = &self.ball else {
            return self.planes.iter().map(|f| f.most(r)).fold(f64::INFINITY, f64::min);
        };
        if ball.across > 0.0 {
            return f64::INFINITY;
        }
        // The ball lies behind any plane that touches it. The plane where the direction nearest to
        // its middle enters is a good bound; on its outline, a direction a little farther in.
        let c = ball.center;
        let (mut u, mut v) = ((r.u0 + r.u1) * 0.5, (r.v0 + r.v1) * 0.5);
        if c.z > 0.0 {
            (u, v) = ((c.x / c.z).clamp(r.u0, r.u1), (c.y / c.z).clamp(r.v0, r.v1));
        }
        let mut near = ball.nearness(u, v);
        if near.is_nan() && c.z > 0.0 {
            let (du, dv) = (c.x / c.z - u, c.y / c.z - v);
            let step = (2.0 * (r.u1 - r.u0 + r.v1 - r.v0) / (du.abs() + dv.abs())).min(1.0);
            (u, v) = (u + du * step, v + dv * step);
            near = ball.nearness(u, v);
        }
        if near.is_nan() {
            return f64::INFINITY;
        }
        let n = ball.center - DVec3::new(u, v, 1.0) / near;
        let h = n.dot(ball.center) - ball.radius * n.length();
        if h <= TANGENT_NEAR_EYE * n.length() * ball.center.length() {
            return f64::INFINITY;
        }
        let near = Linear { a: n.x / h, b: n.y / h, c: n.z / h }.most(r);
        if near > 0.0 { near } else { f64::INFINITY }
    }
}

/// The greatest depth along an axis of a sphere's contour as seen from the origin.
pub(crate) fn contour_depth(center: DVec3, radius: f64, forward: DVec3, parallel: bool) -> f64 {
    let depth = center.dot(forward);
    if parallel {
        return depth;
    }
    let d2 = center.length_squared();
    let sine2 = radius * radius / d2;
    let along = depth * depth / d2;
    depth * (1.0 - sine2) + radius * ((1.0 - sine2) * (1.0 - along)).max(0.0).sqrt()
}
