//! Silhouettes: outlines projected to a face, and tests of squares of directions against them.
//!
//! A sphere's silhouette is the conic `s^2 >= k (u^2 + v^2 + 1)` with `s` linear in the
//! direction (u, v): its inside is convex, so a square whose four corners are inside is inside.
//! A polytope's is the intersection of half-planes. Both are exact up to their margins.

use fearless_simd::f64x8;
use fearless_simd::prelude::*;
use glam::DVec3;
use smallvec::SmallVec;

use crate::geometry::aspect::{Aspect, Outline};
use crate::numeric::occlusion::{CONIC, CONIC_HORIZON};
use crate::numeric::shape::CONE_MARGIN;
use crate::occlusion::face::{Face, Linear, Rect};
use crate::occlusion::tiles::TILE;

/// The kinds of silhouettes.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) enum SilhouetteKind {
    /// `s^2 - k ((u - u0)^2 + (v - v0)^2 + e) >= 0` where `s > 0`.
    Conic { s: Linear, k: f64, u0: f64, v0: f64, e: f64, sine: f64 },
    /// All of the half-planes of the silhouette.
    Polygon,
    #[default]
    Everything,
}

/// Rows of a tile, and columns.
const ROWS: usize = TILE as usize;

/// The borders between the columns or rows of a tile.
pub(crate) type Borders = [f64; ROWS + 1];

/// The pixels of a tile that lie inside a half-plane.
#[inline(always)]
fn half_pixels<S: Simd>(simd: S, half: &Linear, us: &Borders, vs: &Borders) -> u64 {
    // The half-plane is least at one corner of each pixel, the same for all.
    let (left, lower) = (usize::from(half.a < 0.0), usize::from(half.b < 0.0));
    let columns = f64x8::from_slice(simd, &us[left..left + ROWS]) * half.a;
    let mut pixels = 0;
    for j in 0..ROWS {
        let rest = half.b * vs[j + lower] + half.c;
        pixels |= (columns + rest).simd_ge(CONE_MARGIN).to_bitmask() << (8 * j);
    }
    pixels
}

/// The pixels of a tile whose corners lie inside a conic `s^2 - k ((u - u0)^2 + (v - v0)^2 + e)`:
/// so do the pixels, as its inside is convex.
#[inline(always)]
fn conic_pixels<S: Simd>(
    simd: S,
    (s, k): (&Linear, f64),
    (u0, v0, e): (f64, f64, f64),
    us: &Borders,
    vs: &Borders,
) -> u64 {
    let square = |u: f64| k * (u - u0) * (u - u0);
    let (first, last) = (f64x8::from_slice(simd, &us[..ROWS]), us[ROWS]);
    let (along, squares) = (first * s.a, (first - u0) * k * (first - u0));
    let (along_last, square_last) = (s.a * last, square(last));
    let mut corners = [0; ROWS + 1];
    for (corners, &v) in corners.iter_mut().zip(vs) {
        let (rest, dv) = (s.b * v + s.c, v - v0);
        let own = k * (dv * dv + e);
        let at = along + rest;
        let inside = at.simd_gt(0.0) & (at * at - (squares + own)).simd_ge(CONIC);
        let at = along_last + rest;
        let last = at > 0.0 && at * at - (square_last + own) >= CONIC;
        *corners = inside.to_bitmask() | u64::from(last) << ROWS;
    }
    corners.windows(2).enumerate().fold(0, |pixels, (j, c)| {
        let both = c[0] & c[1];
        pixels | (both & both >> 1 & 0xff) << (8 * j)
    })
}

/// The directions of a face that a convex shape covers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Silhouette {
    kind: SilhouetteKind,
    /// Those of a polygon.
    halves: SmallVec<[Linear; 8]>,
}

/// A silhouette for tests of squares in one place, where only some of its half-planes matter.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LocalSilhouette<'a> {
    silhouette: &'a Silhouette,
    /// The half-planes of a polygon that matter, one bit each. Those from [`CHOSEN`] on all do.
    among: u64,
}

/// Half-planes that are told apart by the bits of a word.
const CHOSEN: usize = u64::BITS as usize;

impl LocalSilhouette<'_> {
    /// Whether all of those half-planes of a polygon pass a test.
    #[inline(always)]
    fn all(&self, test: impl Fn(&Linear) -> bool) -> bool {
        let (mut rest, halves) = (self.among, &self.silhouette.halves);
        while rest != 0 {
            let Some(half) = halves.get(rest.trailing_zeros() as usize) else { break };
            if !test(half) {
                return false;
            }
            rest &= rest - 1;
        }
        halves.get(CHOSEN..).is_none_or(|more| more.iter().all(test))
    }

    /// The half-planes that matter, for [`Silhouette::local`].
    pub(crate) fn among(&self) -> u64 {
        self.among
    }

    /// As [`Silhouette::covers`].
    #[inline]
    pub(crate) fn covers(&self, r: &Rect) -> bool {
        match &self.silhouette.kind {
            SilhouetteKind::Polygon => self.all(|half| half.least(r) >= CONE_MARGIN),
            _ => self.silhouette.covers(r),
        }
    }

    /// As [`Silhouette::touches`].
    #[inline]
    pub(crate) fn touches(&self, r: &Rect) -> bool {
        match &self.silhouette.kind {
            SilhouetteKind::Polygon => self.all(|half| half.most(r) >= -CONE_MARGIN),
            _ => self.silhouette.touches(r),
        }
    }

    /// As [`Silhouette::holds`].
    #[inline]
    pub(crate) fn holds(&self, u: f64, v: f64) -> bool {
        match &self.silhouette.kind {
            SilhouetteKind::Polygon => self.all(|half| half.at(u, v) >= CONE_MARGIN),
            _ => self.silhouette.holds(u, v),
        }
    }

    /// As [`Silhouette::may_hold`].
    #[inline]
    pub(crate) fn may_hold(&self, u: f64, v: f64) -> bool {
        match &self.silhouette.kind {
            SilhouetteKind::Polygon => self.all(|half| half.at(u, v) >= -CONE_MARGIN),
            _ => self.silhouette.may_hold(u, v),
        }
    }
}

impl SilhouetteKind {
    /// That of a sphere.
    pub(crate) fn sphere(center: DVec3, radius: f64, face: &Face) -> Self {
        let (c, distance) = (face.local(center), center.length());
        if face.parallel {
            let r = radius * face.right.length();
            let s = Linear { a: 0.0, b: 0.0, c: r };
            Self::Conic { s, k: 1.0, u0: c.x, v0: c.y, e: 0.0, sine: 0.0 }
        } else if distance > radius {
            let (c, sine) = (c / distance, radius / distance);
            let s = Linear { a: c.x, b: c.y, c: c.z };
            Self::Conic { s, k: (1.0 - sine) * (1.0 + sine), u0: 0.0, v0: 0.0, e: 1.0, sine }
        } else {
            Self::Everything
        }
    }

    /// A rectangle around the silhouette of a sphere that lies in front of the eye on this face;
    /// `None` for all others.
    pub(crate) fn conic_rect(&self) -> Option<Rect> {
        let Self::Conic { s, u0, v0, e, sine, .. } = self else { return None };
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
}

impl Silhouette {
    /// Makes it that of a shape on a face.
    pub(crate) fn set(&mut self, aspect: &Aspect, face: &Face) {
        self.halves.clear();
        self.kind = match aspect.outline {
            Outline::Everything => SilhouetteKind::Everything,
            Outline::Sphere { center, radius } => SilhouetteKind::sphere(center, radius, face),
            Outline::Cone => {
                self.halves.extend(aspect.sides.iter().map(|side| face.half(side.normal, side.offset)));
                SilhouetteKind::Polygon
            }
        };
    }

    /// Whether a direction is inside by more than `margin`, in units of the conic or of distance.
    #[inline]
    fn inside(&self, u: f64, v: f64, conic: f64, cone: f64) -> bool {
        match &self.kind {
            SilhouetteKind::Conic { s, k, u0, v0, e, .. } => {
                let (du, dv, at) = (u - u0, v - v0, s.at(u, v));
                at > 0.0 && at * at - k * (du * du + dv * dv + e) >= conic
            }
            SilhouetteKind::Polygon => self.halves.iter().all(|half| half.at(u, v) >= cone),
            SilhouetteKind::Everything => true,
        }
    }

    /// Whether every direction of a square is surely covered.
    #[inline]
    pub(crate) fn covers(&self, r: &Rect) -> bool {
        match &self.kind {
            SilhouetteKind::Conic { .. } => r.corners().iter().all(|&(u, v)| self.inside(u, v, CONIC, 0.0)),
            SilhouetteKind::Polygon => self.halves.iter().all(|half| half.least(r) >= CONE_MARGIN),
            SilhouetteKind::Everything => false,
        }
    }

    /// Whether a direction is surely covered.
    pub(crate) fn holds(&self, u: f64, v: f64) -> bool {
        !matches!(self.kind, SilhouetteKind::Everything) && self.inside(u, v, CONIC, CONE_MARGIN)
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
            SilhouetteKind::Conic { s, k, u0, v0, e, sine } => {
                let (u, v) = ((r.u0 + r.u1) * 0.5, (r.v0 + r.v1) * 0.5);
                let (hu, hv) = ((r.u1 - r.u0) * 0.5, (r.v1 - r.v0) * 0.5);
                let squared = hu * hu + hv * hv;
                if *e == 0.0 {
                    let (du, dv) = (((u - u0).abs() - hu).max(0.0), ((v - v0).abs() - hv).max(0.0));
                    return du * du + dv * dv <= s.c * s.c + CONIC;
                }
                // angle(d, c) <= alpha + rho, with sin rho = reach / |d|.
                let d = u * u + v * v + 1.0;
                let rest = d - squared;
                rest <= 0.0 || s.at(u, v) >= (k * rest).sqrt() - sine * squared.sqrt() - CONIC
            }
            SilhouetteKind::Polygon => self.halves.iter().all(|half| half.most(r) >= -CONE_MARGIN),
            SilhouetteKind::Everything => true,
        }
    }

    /// The silhouette for tests of squares inside a rectangle, without the half-planes that the
    /// rectangle lies inside of; `None` if the rectangle does not touch it.
    #[inline]
    pub(crate) fn crossing(&self, r: &Rect) -> Option<LocalSilhouette<'_>> {
        if !matches!(self.kind, SilhouetteKind::Polygon) {
            return self.touches(r).then(|| self.whole());
        }
        let mut among = 0;
        for (i, half) in self.halves.iter().enumerate() {
            if half.most(r) < -CONE_MARGIN {
                return None;
            }
            if half.least(r) < CONE_MARGIN && i < CHOSEN {
                among |= 1 << i;
            }
        }
        Some(LocalSilhouette { silhouette: self, among })
    }

    /// All of it.
    pub(crate) fn whole(&self) -> LocalSilhouette<'_> {
        self.local(u64::MAX)
    }

    /// It, with some half-planes that matter.
    #[inline]
    pub(crate) fn local(&self, among: u64) -> LocalSilhouette<'_> {
        LocalSilhouette { silhouette: self, among }
    }

    /// The pixels of a tile that are surely covered. The tile's borders between columns and rows
    /// are given.
    #[inline(always)]
    pub(crate) fn pixels<S: Simd>(&self, simd: S, us: &Borders, vs: &Borders) -> u64 {
        let tile = Rect { u0: us[0], v0: vs[0], u1: us[us.len() - 1], v1: vs[vs.len() - 1] };
        match &self.kind {
            SilhouetteKind::Conic { .. } if !self.touches(&tile) => 0,
            SilhouetteKind::Conic { .. } if self.covers(&tile) => u64::MAX,
            SilhouetteKind::Conic { s, k, u0, v0, e, .. } => {
                conic_pixels(simd, (s, *k), (*u0, *v0, *e), us, vs)
            }
            SilhouetteKind::Polygon => {
                let mut pixels = u64::MAX;
                for half in &self.halves {
                    let most = half.most(&tile);
                    // Nothing is inside one that is no number.
                    if most < CONE_MARGIN || most.is_nan() {
                        return 0;
                    }
                    if half.least(&tile) < CONE_MARGIN {
                        pixels &= half_pixels(simd, half, us, vs);
                    }
                }
                pixels
            }
            SilhouetteKind::Everything => 0,
        }
    }

    /// Its equations.
    pub(crate) fn kind(&self) -> &SilhouetteKind {
        &self.kind
    }

    /// The half-planes of a polygon.
    pub(crate) fn halves(&self) -> &[Linear] {
        &self.halves
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::Block;
    use crate::geometry::Room;
    use crate::geometry::body::Body;
    use crate::geometry::polytope::Polytope;
    use crate::simd::vectorized;

    #[test]
    fn pixels_of_a_tile_are_those_that_are_covered_one_by_one() {
        let face = Face { right: DVec3::X, up: DVec3::Y, forward: DVec3::Z, parallel: false };
        let block = Block { min: DVec3::new(-1.1, -0.7, 3.0), max: DVec3::new(1.3, 0.9, 5.0) };
        let boxed = Polytope::block(&block);
        let slanted = Polytope::boxed(
            DVec3::new(0.5, 0.2, 4.0),
            &glam::DMat3::from_euler(glam::EulerRot::XYZ, 0.4, 0.7, 0.2),
        );
        let bodies = [
            Body::Part(boxed.part(DVec3::ZERO, DVec3::ZERO)),
            Body::Part(slanted.part(DVec3::ZERO, DVec3::ZERO)),
            Body::Sphere { center: DVec3::new(0.3, 0.2, 4.0), radius: 1.2 },
        ];
        let mut partly = 0;
        let (mut aspect, mut whole) = (Aspect::default(), Silhouette::default());
        for body in &bodies {
            aspect.set_body(body, None, &Room::NONE);
            whole.set(&aspect, &face);
            for tile in 0..256 {
                let border = |t: i32| std::array::from_fn(|i| f64::from(8 * t + i as i32) / 64.0 - 1.0);
                let (us, vs): (Borders, Borders) = (border(tile % 16), border(tile / 16));
                let rect = Rect { u0: us[0], v0: vs[0], u1: us[8], v1: vs[8] };
                let crossing = whole.crossing(&rect);
                let mut covered = 0u64;
                for bit in 0..64 {
                    let (i, j) = (bit % 8, bit / 8);
                    let pixel = Rect { u0: us[i], v0: vs[j], u1: us[i + 1], v1: vs[j + 1] };
                    covered |= u64::from(whole.covers(&pixel)) << bit;
                    let part = crossing.as_ref();
                    assert_eq!(whole.touches(&pixel), part.is_some_and(|part| part.touches(&pixel)));
                    assert_eq!(whole.covers(&pixel), part.is_some_and(|part| part.covers(&pixel)));
                }
                let pixels = vectorized!(simd => whole.pixels(simd, &us, &vs));
                assert_eq!(pixels, covered, "{body:?} {tile}");
                partly += u32::from(covered != 0 && covered != u64::MAX);
            }
        }
        assert!(partly > 40, "{partly}");
    }
}
