//! Silhouettes: outlines projected to a face, and tests of squares of directions against them.
//!
//! A sphere's silhouette is the conic `s^2 >= k (u^2 + v^2 + 1)` with `s` linear in the
//! direction (u, v): its inside is convex, so a square whose four corners are inside is inside.
//! A polytope's is the intersection of half-planes. Both are exact up to their margins.

use smallvec::SmallVec;

use crate::geometry::plane::HalfSpace;
use crate::geometry::polytope::Outline;
use crate::numeric::occlusion::{CONIC, CONIC_HORIZON};
use crate::numeric::shape::CONE_MARGIN;
use crate::occlusion::face::{Face, Linear, Rect};

/// The kinds of silhouettes.
#[derive(Debug, Clone)]
pub(crate) enum Kind {
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

/// The directions of a face that a convex shape covers.
#[derive(Debug, Clone)]
pub(crate) struct Silhouette {
    kind: Kind,
}

/// The half-planes of a cone. Those of usual cones are written in place, which is cheaper than to collect them.
fn halves(planes: &[HalfSpace], face: &Face) -> SmallVec<[Linear; 8]> {
    let half = |p: &HalfSpace| face.half(p.normal, p.offset);
    let mut few = [Linear { a: 0.0, b: 0.0, c: 0.0 }; 8];
    if planes.len() > few.len() {
        return planes.iter().map(half).collect();
    }
    few.iter_mut().zip(planes).for_each(|(out, plane)| *out = half(plane));
    SmallVec::from_buf_and_len(few, planes.len())
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
            Outline::Cone(planes) => Kind::Polygon(halves(planes, face)),
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
            Kind::Conic { .. } => r.corners().iter().all(|&(u, v)| self.inside(u, v, CONIC, 0.0)),
            Kind::Polygon(halves) => halves.iter().all(|half| half.least(r) >= CONE_MARGIN),
            Kind::Everything => false,
        }
    }

    /// Whether a direction is surely covered.
    pub(crate) fn holds(&self, u: f64, v: f64) -> bool {
        !matches!(self.kind, Kind::Everything) && self.inside(u, v, CONIC, CONE_MARGIN)
    }

    /// Whether a direction may be covered.
    pub(crate) fn may_hold(&self, u: f64, v: f64) -> bool {
        self.inside(u, v, -CONIC, -CONE_MARGIN)
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
                    return du * du + dv * dv <= s.c * s.c + CONIC;
                }
                // angle(d, c) <= alpha + rho, with sin rho = reach / |d|.
                let d = u * u + v * v + 1.0;
                let rest = d - reach;
                rest <= 0.0 || s.at(u, v) >= (k * rest).sqrt() - sine * reach.sqrt() - CONIC
            }
            Kind::Polygon(halves) => halves.iter().all(|half| half.most(r) >= -CONE_MARGIN),
            Kind::Everything => true,
        }
    }

    /// A rectangle around the silhouette of a sphere that lies in front of the eye on this face; `None` for
    /// all others.
    pub(crate) fn conic_rect(&self) -> Option<Rect> {
        let Kind::Conic { s, u0, v0, e, sine, .. } = &self.kind else { return None };
        if *e == 0.0 {
            return Some(Rect { u0: u0 - s.c, v0: v0 - s.c, u1: u0 + s.c, v1: v0 + s.c });
        }
        if s.c <= sine + CONIC_HORIZON {
            return None;
        }
        // Tangents from the eye in the plane of each axis and the depth.
        let span = |a: f64| {
            let root = (a * a + s.c * s.c - sine * sine).max(0.0).sqrt();
            let below = s.c * s.c - sine * sine;
            ((a * s.c - sine * root) / below, (a * s.c + sine * root) / below)
        };
        let ((u0, u1), (v0, v1)) = (span(s.a), span(s.b));
        Some(Rect { u0, v0, u1, v1 })
    }

    /// Its equations.
    pub(crate) fn kind(&self) -> &Kind {
        &self.kind
    }
}
