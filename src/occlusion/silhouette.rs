//! Silhouettes: an outline put on a face, asked for squares of directions.
//!
//! A sphere's silhouette is the conic `s^2 >= k (u^2 + v^2 + 1)` with `s` linear in the
//! direction (u, v): its inside is convex, so a square whose four corners are inside is inside.
//! A polytope's is the intersection of half-planes. Both are exact up to the margins below.

use glam::DVec3;
use smallvec::SmallVec;

use crate::geometry::plane::HalfSpace;
use crate::geometry::polytope::Outline;
use crate::numeric::shape::CONE_MARGIN;
use crate::occlusion::face::{Face, Linear, Rect};

/// The conic is scaled so that its terms are at most about 3: sums of ten of them
/// err by less than this.
const CONIC_MARGIN: f64 = 1e-13;

#[derive(Debug, Clone)]
enum Kind {
    /// `s^2 - k ((u - u0)^2 + (v - v0)^2 + e) >= 0` where `s > 0`.
    Conic {
        s: Linear,
        k: f64,
        u0: f64,
        v0: f64,
        e: f64,
        sine: f64,
    },
    Polygon(SmallVec<[Linear; 8]>),
    Everything,
}

/// What a convex shape covers of a face.
#[derive(Debug, Clone)]
pub(crate) struct Silhouette {
    kind: Kind,
}

impl Silhouette {
    pub(crate) fn new(outline: &Outline, face: &Face) -> Self {
        let kind = match outline {
            Outline::Everything => Kind::Everything,
            Outline::Sphere { center, radius } => {
                let (c, distance) = (face.local(*center), center.length());
                if face.parallel {
                    let r = radius * face.right.length();
                    let s = Linear { a: 0.0, b: 0.0, c: r };
                    Kind::Conic { s, k: 1.0, u0: c.x, v0: c.y, e: 0.0, sine: 0.0 }
                } else if distance > *radius {
                    let (c, sine) = (c / distance, radius / distance);
                    let s = Linear { a: c.x, b: c.y, c: c.z };
                    Kind::Conic { s, k: (1.0 - sine) * (1.0 + sine), u0: 0.0, v0: 0.0, e: 1.0, sine }
                } else {
                    Kind::Everything
                }
            }
            Outline::Cone(planes) => {
                Kind::Polygon(planes.iter().map(|p| face.half(p.normal, p.offset)).collect())
            }
        };
        Self { kind }
    }

    /// Whether a direction is inside by more than `margin`, in units of the conic or of distance.
    #[inline]
    fn inside(&self, u: f64, v: f64, conic: f64, cone: f64) -> bool {
        match &self.kind {
            Kind::Conic { s, k, u0, v0, e, .. } => {
                let (du, dv, at) = (u - u0, v - v0, s.at(u, v));
                at > 0.0 && at * at - k * (du * du + dv * dv + e) >= conic
            }
            Kind::Polygon(halves) => halves.iter().all(|half| half.at(u, v) >= cone),
            Kind::Everything => true,
        }
    }

    /// Whether every direction of a square is surely covered.
    #[inline]
    pub(crate) fn covers(&self, r: &Rect) -> bool {
        match &self.kind {
            Kind::Conic { .. } => r.corners().iter().all(|&(u, v)| self.inside(u, v, CONIC_MARGIN, 0.0)),
            Kind::Polygon(halves) => halves.iter().all(|half| half.least(r) >= CONE_MARGIN),
            Kind::Everything => false,
        }
    }

    /// Whether a direction is surely covered.
    pub(crate) fn holds(&self, u: f64, v: f64) -> bool {
        !matches!(self.kind, Kind::Everything) && self.inside(u, v, CONIC_MARGIN, CONE_MARGIN)
    }

    /// Whether a direction may be covered.
    pub(crate) fn may_hold(&self, u: f64, v: f64) -> bool {
        self.inside(u, v, -CONIC_MARGIN, -CONE_MARGIN)
    }

    /// Whether some direction of a square may be covered.
    #[inline]
    pub(crate) fn touches(&self, r: &Rect) -> bool {
        match &self.kind {
            // The circle of directions around the square against the circle of the sphere.
            Kind::Conic { s, k, u0, v0, e, sine } => {
                let (u, v) = ((r.u0 + r.u1) * 0.5, (r.v0 + r.v1) * 0.5);
                let (hu, hv) = ((r.u1 - r.u0) * 0.5, (r.v1 - r.v0) * 0.5);
                let reach = hu * hu + hv * hv;
                if *e == 0.0 {
                    let (du, dv) = (((u - u0).abs() - hu).max(0.0), ((v - v0).abs() - hv).max(0.0));
                    return du * du + dv * dv <= s.c * s.c + CONIC_MARGIN;
                }
                // angle(d, c) <= alpha + rho, with sin rho = reach / |d|.
                let d = u * u + v * v + 1.0;
                let rest = d - reach;
                rest <= 0.0 || s.at(u, v) >= (k * rest).sqrt() - sine * reach.sqrt() - CONIC_MARGIN
            }
            Kind::Polygon(halves) => halves.iter().all(|half| half.most(r) >= -CONE_MARGIN),
            Kind::Everything => true,
        }
    }

    /// A rectangle around the silhouette, if the shape lies in front of the face's
    /// eye: exact for conics, and no help for polygons.
    pub(crate) fn conic_rect(&self) -> Option<Rect> {
        let Kind::Conic { s, k, u0, v0, e, sine } = &self.kind else { return None };
        if *e == 0.0 {
            return Some(Rect { u0: u0 - s.c, v0: v0 - s.c, u1: u0 + s.c, v1: v0 + s.c });
        }
        if s.c <= sine + 1e-3 {
            return None;
        }
        // Tangents from the eye in the plane of each axis and the depth.
        let span = |a: f64| {
            let root = (a * a + s.c * s.c - sine * sine).max(0.0).sqrt();
            let below = s.c * s.c - sine * sine;
            ((a * s.c - sine * root) / below, (a * s.c + sine * root) / below)
        };
        let _ = k;
        let ((u0, u1), (v0, v1)) = (span(s.a), span(s.b));
        Some(Rect { u0, v0, u1, v1 })
    }

    /// The columns between which a line `v` runs inside a conic: from a rounded root, to be verified.
    #[inline]
    fn chord(s: &Linear, k: f64, (u0, v0, e): (f64, f64, f64), v: f64) -> Option<(f64, f64)> {
        let rest = s.b * v + s.c;
        let dv = v - v0;
        let a = s.a * s.a - k;
        let b = s.a * rest + k * u0;
        let c = rest * rest - k * (u0 * u0 + dv * dv + e);
        let disc = b * b - a * c;
        if disc.is_nan() || disc <= 0.0 {
            return None;
        }
        let root = disc.sqrt();
        if a < -1e-12 {
            let (x, y) = ((-b + root) / a, (-b - root) / a);
            (s.a * (x + y) * 0.5 + rest > 0.0).then_some((x, y))
        } else if a > 1e-12 {
            // The branch of the hyperbola on which s is positive.
            if s.a > 0.0 { Some(((-b + root) / a, 2.0)) } else { Some((-2.0, (-b - root) / a)) }
        } else {
            // A parabola: 2 b u + c = 0.
            if b > 0.0 { Some((-c / (2.0 * b), 2.0)) } else { Some((-2.0, -c / (2.0 * b))) }
        }
    }

    /// For `rows` rows of height `step` from `v`, calls `row` with the columns between which the
    /// row is surely covered. For conics the ends are rounded roots, which `covers` must confirm.
    #[inline]
    pub(crate) fn rows(&self, v: f64, step: f64, rows: usize, mut row: impl FnMut(usize, f64, f64)) {
        match &self.kind {
            Kind::Conic { s, k, u0, v0, e, .. } => {
                let chord = |i: usize| Self::chord(s, *k, (*u0, *v0, *e), v + step * i as f64);
                let mut above = chord(0);
                for i in 0..rows {
                    let below = chord(i + 1);
                    if let (Some(a), Some(b)) = (above, below) {
                        row(i, a.0.max(b.0), a.1.min(b.1));
                    }
                    above = below;
                }
            }
            Kind::Polygon(halves) => {
                let inverses: SmallVec<[f64; 8]> = halves.iter().map(|half| -1.0 / half.a).collect();
                for i in 0..rows {
                    let (near, far) = (v + step * i as f64, v + step * (i + 1) as f64);
                    let (mut lo, mut hi) = (-1.0f64, 1.0f64);
                    for (half, inverse) in halves.iter().zip(&inverses) {
                        let rest = (half.b * near).min(half.b * far) + half.c - CONE_MARGIN;
                        // Where a u + rest >= 0.
                        if half.a > 0.0 {
                            lo = lo.max(rest * inverse);
                        } else if half.a < 0.0 {
                            hi = hi.min(rest * inverse);
                        } else if rest < 0.0 {
                            hi = f64::NEG_INFINITY;
                        }
                    }
                    row(i, lo, hi);
                }
            }
            Kind::Everything => {}
        }
    }

    /// Whether row spans are rounded roots that need confirming.
    pub(crate) fn is_conic(&self) -> bool {
        matches!(self.kind, Kind::Conic { .. })
    }
}

/// Nearness of a convex shape's front on a face, from both sides: each direction in
/// the silhouette enters the shape where the least of its front planes says, or at the front of a ball.
#[derive(Debug, Clone)]
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

    /// The depth at which a direction enters; `None` if it barely does or not at all, or
    /// if the eye is about as close as coordinates are exact.
    #[inline]
    fn enters(&self, u: f64, v: f64) -> Option<f64> {
        let c = self.center;
        if self.across > 0.0 {
            let (du, dv) = ((u - c.x) / self.across, (v - c.y) / self.across);
            let q = 1.0 - (du * du + dv * dv);
            return (q > 1e-9).then(|| c.z - self.radius * q.sqrt());
        }
        let s = u * c.x + v * c.y + c.z;
        let d2 = u * u + v * v + 1.0;
        let q = s * s - d2 * self.power;
        // The root keeps more than half of its digits.
        (s > 0.0 && q > 1e-9 * s * s && self.power > 1e-6 * s * s).then(|| self.power / (s + q.sqrt()))
    }
}

impl Front {
    /// `planes` are the half-spaces of the faces turned to the eye; `farthest` is the greatest depth
    /// of the silhouette along the face's axis, `reach` bounds the coordinates of the shape.
    pub(crate) fn new(
        face: &Face,
        outline: &Outline,
        planes: &[HalfSpace],
        farthest: f64,
        reach: f64,
    ) -> Self {
        // Planes too close to the eye, or seen edge-on, are not known well enough.
        let known = |p: &&HalfSpace| face.parallel || p.offset.abs() > 1e-7 * reach;
        let found = planes.iter().filter(known).filter_map(|plane| face.nearness(plane));
        let found: SmallVec<[Linear; 3]> = found.collect();
        let ball = match outline {
            Outline::Sphere { center, radius } => Some(Ball::new(face, *center, *radius)),
            _ => None,
        };
        let complete = found.len() == planes.len();
        // What lies behind the eye on this face says nothing.
        let floor = if face.parallel || farthest > 0.0 { face.nearness_of(farthest) } else { 0.0 };
        Self { planes: found, complete, ball, floor }
    }

    /// What is less near than this on the whole rectangle, and in the silhouette, is behind.
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

    /// As [`Front::behind`], for a rectangle inside the silhouette: the depth at which
    /// a ball is entered is greatest at a corner, since what is entered no deeper than some
    /// depth is the shadow of a convex part of the ball.
    #[inline]
    pub(crate) fn behind_inside(&self, r: &Rect) -> f64 {
        let planes = self.behind(r);
        let Some(ball) = &self.ball else { return planes };
        let mut deepest = f64::NEG_INFINITY;
        for (u, v) in r.corners() {
            match ball.enters(u, v) {
                Some(z) => deepest = deepest.max(z),
                None => return planes,
            }
        }
        planes.max(if ball.across > 0.0 { -deepest } else { 1.0 / deepest })
    }

    /// Whether the shape is nowhere in the rectangle nearer than a plane. Both are linear: their
    /// difference is least at a corner. By a margin for planes known to a part in 10^9.
    #[inline]
    pub(crate) fn is_behind(&self, plane: &Linear, r: &Rect) -> bool {
        self.ball.is_none()
            && self.planes.iter().any(|f| {
                let margin = 1e-8
                    * (plane.a.abs() + plane.b.abs() + plane.c.abs() + f.a.abs() + f.b.abs() + f.c.abs());
                Linear { a: plane.a - f.a, b: plane.b - f.b, c: plane.c - f.c }.least(r) >= margin
            })
    }

    /// Nearness of the front in one direction that is in the silhouette, but for rounding.
    pub(crate) fn at(&self, u: f64, v: f64) -> f64 {
        match &self.ball {
            Some(ball) => {
                ball.enters(u, v).map_or(self.floor, |z| if ball.across > 0.0 { -z } else { 1.0 / z })
            }
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
        // It lies behind any plane that touches it. The one where the direction nearest to its
        // middle enters bounds it well; on its rim, a direction a little farther in.
        let c = ball.center;
        let (mut u, mut v) = ((r.u0 + r.u1) * 0.5, (r.v0 + r.v1) * 0.5);
        if c.z > 0.0 {
            (u, v) = ((c.x / c.z).clamp(r.u0, r.u1), (c.y / c.z).clamp(r.v0, r.v1));
        }
        let mut enters = ball.enters(u, v);
        if enters.is_none() && c.z > 0.0 {
            let (du, dv) = (c.x / c.z - u, c.y / c.z - v);
            let step = (2.0 * (r.u1 - r.u0 + r.v1 - r.v0) / (du.abs() + dv.abs())).min(1.0);
            (u, v) = (u + du * step, v + dv * step);
            enters = ball.enters(u, v);
        }
        let Some(z) = enters else { return f64::INFINITY };
        let n = ball.center - DVec3::new(u, v, 1.0) * z;
        let h = n.dot(ball.center) - ball.radius * n.length();
        if h <= 1e-6 * n.length() * ball.center.length() {
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
