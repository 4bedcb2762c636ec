//! The view: an eye or a direction, and the planes that bound what it sees.

use glam::{DMat3, DMat4, DVec3, DVec4, Mat4, Vec3};
use smallvec::SmallVec;

use crate::error::{Error, finite3};
use crate::geometry::Block;
use crate::shape::{Bounds, Shape};
use crate::{Obb, Sphere};

/// The most planes that can bound a view.
pub const MAX_PLANES: usize = 32;

/// An element of a matrix is off by up to two roundings to single precision.
const ROUNDING: f64 = 1.0 / (1u64 << 22) as f64;

/// Half a space: the points `p` with `normal.dot(p) + offset >= 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Points into the half-space; any length but zero.
    pub normal: Vec3,
    /// Zero for planes through the origin.
    pub offset: f32,
}

/// A half-space with a normal of length 1, in `f64`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct HalfSpace {
    pub(crate) normal: DVec3,
    pub(crate) offset: f64,
}

impl HalfSpace {
    /// Normalises a plane; `None` if it has no direction.
    fn new(v: DVec4) -> Option<Self> {
        let length = v.truncate().length();
        (length > 0.0 && length.is_finite() && v.w.is_finite())
            .then(|| Self { normal: v.truncate() / length, offset: v.w / length })
    }

    pub(crate) fn distance(&self, p: DVec3) -> f64 {
        self.normal.dot(p) + self.offset
    }

    /// Margin for decisions about coordinates up to `reach`: the sums and
    /// products of a distance err by less than 16 units in the last place.
    pub(crate) fn margin(&self, reach: f64) -> f64 {
        16.0 * f64::EPSILON * (reach + self.offset.abs())
    }
}

/// Where the view rays start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Origin {
    /// At a point, known to within `error` world units along each axis.
    Eye { at: DVec3, error: f64 },
    /// Infinitely far away: all rays run along this direction.
    Direction(DVec3),
}

/// What a camera sees: rays from an eye (or parallel ones), bounded by planes.
///
/// The planes of a matrix are moved outwards by what single precision leaves
/// open about them: about 2e-7 of the eye's distance from the origin.
/// Depth runs from 0 to 1 as in wgpu, Vulkan and Direct3D (glam's
/// `camera::rh::proj::directx` and the like), also reversed or with an infinite far plane;
/// OpenGL's -1 to 1 has its own constructor.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    pub(crate) origin: Origin,
    pub(crate) planes: SmallVec<[HalfSpace; 6]>,
    /// One bit for each plane that cuts the eye off from what lies inside it.
    cutting: u32,
    /// How far planes found from a matrix were moved outwards, at most.
    widened: f64,
    /// Whether it is known at which end parallel rays start.
    ordered: bool,
}

impl View {
    /// The view of a perspective or orthographic camera, from the matrix that
    /// takes world space to clip space with depth 0 to 1.
    ///
    /// Orthographic views from here get no occlusion (see [`View::orthographic`]).
    /// The eye is found from the matrix, to the precision that single floats
    /// leave (about 1e-6 of its distance from the origin): where that does not tell
    /// the eye's cell, the result is slightly larger. [`View::perspective`]
    /// takes the exact eye.
    ///
    /// # Errors
    /// Refuses a matrix that is not finite, or maps space to a plane, line or point.
    pub fn from_view_projection(matrix: Mat4) -> Result<Self, Error> {
        Self::from_clip(matrix, false, None)
    }

    /// As [`View::from_view_projection`], for depth from -1 to 1 (OpenGL).
    ///
    /// # Errors
    /// As [`View::from_view_projection`].
    pub fn from_view_projection_gl(matrix: Mat4) -> Result<Self, Error> {
        Self::from_clip(matrix, true, None)
    }

    /// The view of a perspective camera whose eye is known exactly; depth 0 to 1.
    ///
    /// # Errors
    /// As [`View::from_view_projection`]; also refuses an eye that is not
    /// finite, and an orthographic matrix.
    pub fn perspective(eye: Vec3, matrix: Mat4) -> Result<Self, Error> {
        finite3("the eye", eye)?;
        Self::from_clip(matrix, false, Some(eye.as_dvec3()))
    }

    /// The view of an orthographic camera that looks along `forward`; depth 0 to 1, also reversed.
    ///
    /// A matrix alone does not tell at which end parallel rays start: views of orthographic
    /// matrices from the other constructors get no occlusion.
    ///
    /// # Errors
    /// As [`View::from_view_projection`]; also refuses a direction that is not finite or runs across the
    /// rays, and a perspective matrix.
    pub fn orthographic(forward: Vec3, matrix: Mat4) -> Result<Self, Error> {
        finite3("the direction", forward)?;
        let mut view = Self::from_clip(matrix, false, None)?;
        let Origin::Direction(d) = view.origin else {
            return Err(Error::Matrix("it is no orthographic camera's"));
        };
        let along = d.dot(forward.as_dvec3().normalize_or_zero());
        if along.abs() < 0.5 {
            return Err(Error::Matrix("its rays do not run along the direction given"));
        }
        view.origin = Origin::Direction(d * along.signum());
        view.ordered = true;
        Ok(view)
    }

    /// Parallel rays that start infinitely far away and run along `direction`, inside all of the half-spaces.
    /// Directions and normals have length 1.
    pub(crate) fn parallel(direction: DVec3, planes: SmallVec<[HalfSpace; 6]>) -> Self {
        Self { origin: Origin::Direction(direction), planes, cutting: 0, widened: 0.0, ordered: true }
    }

    /// Whether it is known where rays start.
    pub(crate) fn is_ordered(&self) -> bool {
        self.ordered || self.eye().is_some()
    }

    /// All that an eye sees, in every direction and however far.
    ///
    /// # Errors
    /// Refuses an eye that is not finite.
    pub fn around(eye: Vec3) -> Result<Self, Error> {
        Self::from_planes(eye, &[])
    }

    /// What an eye sees inside all of the half-spaces given. Planes closer to the eye than about a part in
    /// 10^7 of their coordinates count as planes through it, since single precision does not tell them apart.
    ///
    /// # Errors
    /// Refuses an eye that is not finite, planes without direction and more than
    /// [`MAX_PLANES`] planes.
    pub fn from_planes(eye: Vec3, planes: &[Plane]) -> Result<Self, Error> {
        finite3("the eye", eye)?;
        if planes.len() > MAX_PLANES {
            return Err(Error::TooManyPlanes { given: planes.len(), max: MAX_PLANES });
        }
        let planes = planes.iter().enumerate().map(|(i, p)| {
            let v = p.normal.as_dvec3().extend(f64::from(p.offset));
            HalfSpace::new(v).ok_or(Error::Plane(i))
        });
        let planes: SmallVec<[HalfSpace; 6]> = planes.collect::<Result<_, _>>()?;
        let at = eye.as_dvec3();
        // Planes through the eye miss it by their rounding to single precision.
        let rounding = |p: &HalfSpace| 2f64.powi(-23) * (at.abs().dot(p.normal.abs()) + p.offset.abs());
        let cuts = |p: &HalfSpace| p.distance(at) < -rounding(p);
        let cutting = planes.iter().zip(0..).filter(|(p, _)| cuts(p)).map(|(_, i)| 1 << i).sum();
        Ok(Self { origin: Origin::Eye { at, error: 0.0 }, planes, cutting, widened: 0.0, ordered: false })
    }

    fn from_clip(matrix: Mat4, gl_depth: bool, eye: Option<DVec3>) -> Result<Self, Error> {
        if !matrix.is_finite() {
            return Err(Error::Matrix("it has elements that are not finite"));
        }
        let m = matrix.as_dmat4();
        let rows = [m.row(0), m.row(1), m.row(2), m.row(3)];
        let [x, y, z, w] = rows;
        let origin = match eye {
            Some(at) => {
                if is_parallel(&m) {
                    return Err(Error::Matrix("it is orthographic and has no eye"));
                }
                Origin::Eye { at, error: 0.0 }
            }
            None if is_parallel(&m) => Origin::Direction(direction(x, y, z, w)?),
            None => find_eye(x, y, w)?,
        };
        let mut planes: SmallVec<[HalfSpace; 6]> = SmallVec::new();
        let (mut cutting, mut widened) = (0, 0f64);
        let near = if gl_depth { w + z } else { z };
        let sides = [(w + x, [w, x]), (w - x, [w, x]), (w + y, [w, y]), (w - y, [w, y])];
        for (i, (plane, parts)) in sides.into_iter().chain([(near, [w, z]), (w - z, [w, z])]).enumerate() {
            // What remains of two rows that cancel is rounding: an infinite far plane.
            let size = parts[0].truncate().length() + parts[1].truncate().length();
            if plane.truncate().length() > 1e-6 * size {
                planes.extend(HalfSpace::new(plane).map(|mut space| {
                    let reach = match origin {
                        Origin::Eye { at, .. } => at.length(),
                        Origin::Direction(_) => 0.0,
                    };
                    let unsure = ROUNDING * (reach + space.offset.abs());
                    widened = unsure.max(widened);
                    // Of near and far plane, whichever may lie between the eye and the rest.
                    if let (Origin::Eye { at, .. }, true) = (origin, i >= 4) {
                        cutting |= u32::from(space.distance(at) < unsure) << planes.len();
                    }
                    space.offset += unsure;
                    space
                }));
            }
        }
        if planes.len() < 4 {
            return Err(Error::Matrix("it maps space to a plane, a line or a point"));
        }
        Ok(Self { origin, planes, cutting, widened, ordered: false })
    }

    /// The half-spaces that do not hold the eye, such as that of a near plane.
    pub(crate) fn cutting_planes(&self) -> impl Iterator<Item = &HalfSpace> {
        self.planes.iter().zip(0..).filter(|(_, i)| self.cutting >> i & 1 != 0).map(|(p, _)| p)
    }

    /// Whether some plane may cut off the part of a box that parallel rays along
    /// `direction` meet first.
    pub(crate) fn cuts_front(&self, direction: DVec3, b: &Block) -> bool {
        let reach = b.min.abs().max(b.max.abs()).max_element();
        self.planes.iter().filter(|p| p.normal.dot(direction) > 1e-6).any(|p| {
            let nearest = DVec3::select(p.normal.cmpge(DVec3::ZERO), b.min, b.max);
            p.distance(nearest) < 2.0 * self.widened + p.margin(reach)
        })
    }

    /// What each cutting plane cuts away of the view: convex regions with their
    /// bounding box, as far as they lie in the box from `min` to `max`.
    pub(crate) fn cut_regions(&self, min: DVec3, max: DVec3) -> impl Iterator<Item = (Self, Block)> {
        self.cutting_planes().filter_map(move |cut| {
            let others = self.planes.iter().zip(0..).filter(|(_, i)| self.cutting >> i & 1 == 0);
            let mut planes: SmallVec<[HalfSpace; 6]> = others.map(|(p, _)| *p).collect();
            planes.push(HalfSpace { normal: -cut.normal, offset: 2.0 * self.widened - cut.offset });
            let region = Self { origin: self.origin, planes, cutting: 0, widened: 0.0, ordered: false };
            let corners = region.corners(min, max);
            let block = corners.iter().fold(None, |b: Option<Block>, &c| {
                Some(b.map_or(Block { min: c, max: c }, |b| Block { min: b.min.min(c), max: b.max.max(c) }))
            })?;
            Some((region, block))
        })
    }

    /// Where an eye that is not known exactly may lie, as a region with its box.
    pub(crate) fn eye_region(&self) -> Option<(Self, Block)> {
        let Origin::Eye { at, error } = self.origin else { return None };
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|n| [n, -n]);
        let planes = axes.map(|n| HalfSpace { normal: n, offset: error - n.dot(at) }).collect();
        let region = Self { origin: self.origin, planes, cutting: 0, widened: 0.0, ordered: false };
        (error > 0.0).then_some((region, Block { min: at - error, max: at + error }))
    }

    /// The eye; `None` for parallel rays.
    pub fn eye(&self) -> Option<DVec3> {
        match self.origin {
            Origin::Eye { at, .. } => Some(at),
            Origin::Direction(_) => None,
        }
    }

    /// Whether the box or sphere may meet every half-space of the view, or holds
    /// the eye: before a near plane that is known to a few digits only, that is doubt enough.
    pub(crate) fn may_see(&self, bounds: &Bounds) -> bool {
        let meets = match bounds {
            Bounds::Sphere(s) => self.may_see_sphere(s),
            Bounds::Oriented(b) => self.may_see_oriented(b),
            other => self.may_see_block(&other.block()),
        };
        let holds_eye = |at: DVec3, error: f64| {
            let block = bounds.block();
            let around = Block { min: block.min - error, max: block.max + error };
            around.contains_point(at) && (error > 0.0 || bounds.contains_point(at))
        };
        meets || matches!(self.origin, Origin::Eye { at, error } if holds_eye(at, error))
    }

    /// As [`Self::may_see`], for something anywhere in a box.
    pub(crate) fn may_see_volume(&self, b: &Block) -> bool {
        let holds_eye =
            |at: DVec3, error: f64| Block { min: b.min - error, max: b.max + error }.contains_point(at);
        self.may_see_block(b) || matches!(self.origin, Origin::Eye { at, error } if holds_eye(at, error))
    }

    pub(crate) fn may_see_sphere(&self, s: &Sphere) -> bool {
        let (c, r) = (s.center.as_dvec3(), f64::from(s.radius));
        let reach = c.abs().max_element() + r;
        self.planes.iter().all(|p| p.distance(c) >= -(r + p.margin(reach)))
    }

    pub(crate) fn may_see_oriented(&self, b: &Obb) -> bool {
        let (c, axes, _) = b.parts();
        let reach = c.abs().max_element() + b.half.as_dvec3().element_sum();
        self.planes.iter().all(|p| {
            let half: f64 = (0..3).map(|i| axes.col(i).dot(p.normal).abs()).sum();
            p.distance(c) >= -(half + p.margin(reach))
        })
    }

    pub(crate) fn may_see_block(&self, b: &Block) -> bool {
        let reach = b.min.abs().max(b.max.abs()).max_element();
        self.planes.iter().all(|p| {
            let farthest = DVec3::select(p.normal.cmpge(DVec3::ZERO), b.max, b.min);
            p.distance(farthest) >= -p.margin(reach)
        })
    }

    /// Whether all that `other` sees inside the box from `min` to `max` lies in
    /// this view's half-spaces. Exact up to rounding, in doubt no.
    pub(crate) fn holds(&self, other: &Self, min: DVec3, max: DVec3) -> bool {
        self.planes.iter().all(|plane| {
            if other.planes.iter().any(|o| o == plane) {
                return true;
            }
            let corners = other.corners(min, max);
            let reach = min.abs().max(max.abs()).max_element();
            corners.iter().all(|&c| plane.distance(c) >= plane.margin(reach))
        })
    }

    /// The corners of the view's half-spaces cut with a box: every vertex
    /// of the convex region, found as the meeting points of three planes.
    fn corners(&self, min: DVec3, max: DVec3) -> Vec<DVec3> {
        let mut planes: Vec<HalfSpace> = self.planes.to_vec();
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            planes.push(HalfSpace { normal: axis, offset: -axis.dot(min) });
            planes.push(HalfSpace { normal: -axis, offset: axis.dot(max) });
        }
        let slack = 1e-9 * (max - min).length() + planes.iter().map(|p| p.margin(1.0)).fold(0.0, f64::max);
        let mut corners = Vec::new();
        for i in 0..planes.len() {
            for j in 0..i {
                for k in 0..j {
                    let [a, b, c] = [&planes[i], &planes[j], &planes[k]];
                    let m = DMat3::from_cols(a.normal, b.normal, c.normal).transpose();
                    if m.determinant().abs() < 1e-12 {
                        continue;
                    }
                    let p = m.inverse() * -DVec3::new(a.offset, b.offset, c.offset);
                    if planes.iter().all(|plane| plane.distance(p) >= -slack) {
                        corners.push(p);
                    }
                }
            }
        }
        corners
    }
}

/// Whether w is the same everywhere: an orthographic projection.
fn is_parallel(m: &DMat4) -> bool {
    let w = m.row(3);
    let reach = m.col(3).truncate().abs().max_element().max(1.0);
    w.truncate().length() * reach <= 1e-9 * w.w.abs()
}

/// The direction in which depth grows along the rays of an orthographic camera.
fn direction(x: DVec4, y: DVec4, z: DVec4, w: DVec4) -> Result<DVec3, Error> {
    let d = x.truncate().cross(y.truncate());
    let d = d.try_normalize().ok_or(Error::Matrix("it maps space to a plane, a line or a point"))?;
    let along = d.dot(z.truncate()) * w.w.signum();
    if along == 0.0 {
        return Err(Error::Matrix("its depth does not change along its rays"));
    }
    Ok(d * along.signum())
}

/// The eye of a perspective camera: where x, y and w of clip space are all zero.
fn find_eye(x: DVec4, y: DVec4, w: DVec4) -> Result<Origin, Error> {
    let mut error = 0.0;
    let [a, b, c] = [x, y, w].map(|row| {
        let length = row.truncate().length();
        if length > 0.0 { row / length } else { row }
    });
    let m = DMat3::from_cols(a.truncate(), b.truncate(), c.truncate()).transpose();
    if m.determinant().abs() < 1e-9 {
        return Err(Error::Matrix("it maps space to a plane, a line or a point"));
    }
    let inverse = m.inverse();
    let at = inverse * -DVec3::new(a.w, b.w, c.w);
    if !at.is_finite() {
        return Err(Error::Matrix("its eye is not at a finite point"));
    }
    // Each element of a row may be off by two roundings to single precision.
    let spread: f64 = inverse.to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt();
    error += spread * 2.0 * 2f64.powi(-22) * 2.0 * at.length();
    Ok(Origin::Eye { at, error })
}

#[cfg(test)]
mod tests {
    use glam::camera::rh::{proj::directx, view::look_to_mat4};

    use super::*;

    fn camera(eye: Vec3, p: Mat4) -> Mat4 {
        p * look_to_mat4(eye, Vec3::new(0.3, -0.2, -1.0).normalize(), Vec3::Y)
    }

    #[test]
    fn finds_the_eye_of_every_perspective() {
        for eye in [Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0), Vec3::new(-500.0, 80.0, 1e5)] {
            for p in [
                directx::perspective(1.0, 1.5, 0.1, 100.0),
                directx::perspective_infinite(2.5, 0.7, 0.1),
                directx::perspective_infinite_reverse(0.03, 1.0, 0.1),
            ] {
                let view = View::from_view_projection(camera(eye, p)).unwrap();
                let Origin::Eye { at, error } = view.origin else { panic!() };
                let off = (at - eye.as_dvec3()).abs().max_element();
                assert!(off <= error + 1e-12, "{eye} {off} {error}");
                assert!(error <= 2e-4 * f64::from(eye.length()) + 1e-12, "{eye} {error}");
            }
        }
    }

    #[test]
    fn planes_bound_the_clip_volume() {
        let eye = Vec3::new(4.0, 5.0, 6.0);
        for (p, planes) in [
            (directx::perspective(1.0, 1.5, 0.1, 100.0), 6),
            (directx::perspective(1.0, 1.5, 100.0, 0.1), 6),
            (directx::perspective_infinite(1.0, 1.5, 0.1), 5),
            (directx::perspective_infinite_reverse(1.0, 1.5, 0.1), 5),
            (directx::orthographic(-3.0, 4.0, -2.0, 5.0, 0.1, 50.0), 6),
        ] {
            let m = camera(eye, p);
            let view = View::from_view_projection(m).unwrap();
            assert_eq!(view.planes.len(), planes);
            let mut state = 3u32;
            let mut next = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(state >> 8) / f64::from(1 << 24) * 120.0 - 60.0
            };
            for _ in 0..2000 {
                let q = eye.as_dvec3() + DVec3::new(next(), next(), next());
                let c = m.as_dmat4() * q.extend(1.0);
                let clip = c.x.abs() <= c.w && c.y.abs() <= c.w && c.z >= 0.0 && c.z <= c.w;
                let inside = view.planes.iter().all(|h| h.distance(q) >= 0.0);
                assert!(inside || !clip, "{q}");
                let barely = view.planes.iter().all(|h| h.distance(q) >= 1e-4);
                assert!(clip || !barely, "{q}");
            }
        }
    }

    #[test]
    fn orthographic_rays_run_away_from_the_camera() {
        let m = camera(Vec3::ONE, directx::orthographic(-3.0, 4.0, -2.0, 5.0, 0.1, 50.0));
        let View { origin: Origin::Direction(d), .. } = View::from_view_projection(m).unwrap() else {
            panic!()
        };
        assert!((d - DVec3::new(0.3, -0.2, -1.0).normalize()).length() < 1e-6);
        assert!(matches!(View::perspective(Vec3::ONE, m), Err(Error::Matrix(_))));
    }

    #[test]
    fn refuses_what_is_no_camera() {
        for m in [Mat4::ZERO, Mat4::NAN, Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0))] {
            assert!(View::from_view_projection(m).is_err(), "{m}");
        }
        assert!(View::around(Vec3::INFINITY).is_err());
        let flat = Plane { normal: Vec3::ZERO, offset: 1.0 };
        assert_eq!(View::from_planes(Vec3::ZERO, &[flat]), Err(Error::Plane(0)));
        let up = Plane { normal: Vec3::Y, offset: 1.0 };
        assert!(View::from_planes(Vec3::ZERO, &[up; 33]).is_err());
    }

    #[test]
    fn a_narrower_view_is_held_and_a_turned_one_is_not() {
        let view = |fov: f32, near: f32, dir: Vec3| {
            let m = directx::perspective(fov, 1.5, near, 100.0) * look_to_mat4(Vec3::ZERO, dir, Vec3::Y);
            View::perspective(Vec3::ZERO, m).unwrap()
        };
        let (wide, narrow) =
            (view(1.2, 0.1, Vec3::NEG_Z), view(0.8, 0.2, Vec3::new(0.1, 0.0, -1.0).normalize()));
        let (min, max) = (DVec3::splat(-50.0), DVec3::splat(50.0));
        assert!(wide.holds(&wide, min, max) && wide.holds(&narrow, min, max));
        assert!(!narrow.holds(&wide, min, max));
        assert!(!wide.holds(&view(0.8, 0.2, Vec3::X), min, max));
        let around = View::around(Vec3::ZERO).unwrap();
        assert!(around.holds(&wide, min, max) && !wide.holds(&around, min, max));
    }
}
