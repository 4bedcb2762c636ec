//! The view: an eye or a direction, and the planes that bound what it sees.

pub(crate) mod cut;

use crate::error::{Error, finite3};
use crate::geometry::plane::HalfSpace;
use crate::geometry::{Block, Obb, Plane, Sphere};
use crate::object::Bounds;
use crate::shape::Shape;
use glam::{DMat3, DVec3, DVec4, Mat4, Vec3};
use smallvec::SmallVec;

/// The most planes that can bound a view.
pub const MAX_PLANES: usize = 32;

/// An element of a matrix is off by up to two roundings to single precision.
const ROUNDING: f64 = 1.0 / (1u64 << 22) as f64;

/// A plane through the eye is off by this share of the eye's distance from the origin, if the matrix is
/// a product or an inverse in single precision: 16 roundings of 2^-24, of which a product of three matrices makes up to 14.
const EYE_ROUNDING: f64 = 1.0 / (1u64 << 20) as f64;

/// A given eye is refused if it is farther than this from a plane that holds the matrix's, as a share of
/// its distance from the origin plus that of what it looks at. Four times [`EYE_ROUNDING`]: in between, where longer
/// chains of products lead and targets far from the origin, the eye is taken to be known roughly.
const EYE_REFUSED: f64 = 4.0 * EYE_ROUNDING;

/// What a camera looks at, such as the target of an orbit, lies no farther from it than this many times its near
/// distance, or than its far plane: with the usual 0.1, a thousand units.
const SIGHT: f64 = 1e4;

/// What is left of two rows that cancel is rounding up to this share of them: 8 roundings of each. It is the far
/// plane of an infinite projection then, or so far away that leaving it out makes little difference.
const CANCELLED: f64 = 1.0 / (1u64 << 20) as f64;

/// Rays are parallel if w changes across the view by this share of what x or y do. For a perspective it is about half
/// the field of view in radians; zero, exactly, for products with an orthographic matrix.
const PARALLEL: f64 = 1e-9;

/// Three normals of length 1 whose volume is less are taken to lie in one plane. Nothing rests on the exact value:
/// the error of an eye found grows with the inverse of the volume.
const FLAT_VOLUME: f64 = 1e-9;

/// Regions are cut at planes moved outwards by this share of the coordinates. Distances from planes err by a
/// quarter of it, and so do crossings along the normal.
const CUT_SLACK: f64 = 64.0 * f64::EPSILON;

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
    /// How far planes found from a matrix that cut off the eye, or any of parallel rays, were moved outwards, at most.
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
    /// Visibility is that from the eye given. Planes are moved outwards until they hold it. Where it differs from the
    /// matrix's eye by more than products of matrices in single precision usually explain (a millionth of its
    /// distance from the origin), it counts as known to within that difference.
    ///
    /// # Errors
    /// As [`View::from_view_projection`]; also refuses an eye that is not
    /// finite, an orthographic matrix, and with [`Error::EyeMismatch`] an eye that is not the matrix's: off by more
    /// than about four millionths of twice its distance from the origin and of its sight (the distance of the far plane, at most
    /// 10,000 times that of the near plane).
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
        let near = if gl_depth { w + z } else { z };
        let mut beside = 0.0;
        let origin = match eye {
            Some(at) => {
                if is_parallel(x, y, w) {
                    return Err(Error::Matrix("it is orthographic and has no eye"));
                }
                let error;
                (error, beside) = check_eye(at, [x, y, w], sight(at, [near, w - z], w))?;
                Origin::Eye { at, error }
            }
            None if is_parallel(x, y, w) => Origin::Direction(direction(x, y, z, w)?),
            None => find_eye(x, y, w)?,
        };
        let mut planes: SmallVec<[HalfSpace; 6]> = SmallVec::new();
        let (mut cutting, mut widened) = (0, 0f64);
        let sides = [(w + x, [w, x]), (w - x, [w, x]), (w + y, [w, y]), (w - y, [w, y])];
        for (i, (plane, parts)) in sides.into_iter().chain([(near, [w, z]), (w - z, [w, z])]).enumerate() {
            let size = parts[0].truncate().length() + parts[1].truncate().length();
            let length = plane.truncate().length();
            if length > CANCELLED * size {
                planes.extend(HalfSpace::new(plane).map(|mut space| {
                    // What cancels leaves the rounding of what it cancelled with: a far plane is known worse.
                    let worse = (size / length).max(1.0);
                    let mut unsure = ROUNDING * worse * space.offset.abs();
                    let mut cuts = false;
                    if let Origin::Eye { at, .. } = origin {
                        unsure += ROUNDING * worse * at.length();
                        if i < 4 {
                            // The sides of a view meet in its eye.
                            unsure += if eye.is_some() { (-space.distance(at)).max(0.0) } else { 0.0 };
                        } else {
                            unsure += beside;
                            // Of near and far plane, whichever may lie between the eye and the rest.
                            cuts = space.distance(at) < unsure;
                        }
                    }
                    cutting |= u32::from(cuts) << planes.len();
                    if cuts || matches!(origin, Origin::Direction(_)) {
                        widened = unsure.max(widened);
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

    /// The corners of the view's half-spaces cut with a box, and some points of its surface: the region lies in
    /// their hull. Rounded outwards.
    fn corners(&self, min: DVec3, max: DVec3) -> Vec<DVec3> {
        let reach = min.abs().max(max.abs()).max_element();
        let mut faces = sides_of_box(min, max);
        for plane in &self.planes {
            let slack = CUT_SLACK * (reach + plane.offset.abs());
            cut(&mut faces, plane, slack);
        }
        faces.concat()
    }
}

/// The sides of a box, each with its corners in a ring.
fn sides_of_box(min: DVec3, max: DVec3) -> Vec<Vec<DVec3>> {
    let corner = |i: usize| DVec3::select(glam::BVec3::new(i & 1 == 1, i & 2 == 2, i & 4 == 4), max, min);
    let side = |axis: usize, high: usize| {
        let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        [0, u, u | v, v].map(|i| corner(i | high << axis)).to_vec()
    };
    (0..3).flat_map(|axis| [side(axis, 0), side(axis, 1)]).collect()
}

/// Takes from a convex solid, given by its faces, what lies outside of a half-space by more than `slack`.
fn cut(faces: &mut Vec<Vec<DVec3>>, plane: &HalfSpace, slack: f64) {
    let mut rim: Vec<DVec3> = Vec::new();
    for face in faces.iter_mut() {
        let mut kept = Vec::with_capacity(face.len() + 1);
        for (i, &a) in face.iter().enumerate() {
            let b = face[(i + 1) % face.len()];
            let (da, db) = (plane.distance(a) + slack, plane.distance(b) + slack);
            if da >= 0.0 {
                kept.push(a);
            }
            if da == 0.0 {
                rim.push(a);
            } else if (da < 0.0) != (db < 0.0) {
                let crossing = a.lerp(b, (da / (da - db)).clamp(0.0, 1.0));
                kept.push(crossing);
                rim.push(crossing);
            }
        }
        *face = kept;
    }
    faces.retain(|face| !face.is_empty());
    // The new face: what was cut, in a ring around its middle.
    let middle = rim.iter().sum::<DVec3>() / rim.len().max(1) as f64;
    let (u, v) = plane.normal.any_orthonormal_pair();
    let turn = |p: &DVec3| v.dot(*p - middle).atan2(u.dot(*p - middle));
    rim.sort_by(|p, q| turn(p).total_cmp(&turn(q)));
    if !rim.is_empty() {
        faces.push(rim);
    }
}

/// Whether w is the same everywhere: an orthographic projection. However far the eye is, since distances from
/// the origin do not count.
fn is_parallel(x: DVec4, y: DVec4, w: DVec4) -> bool {
    let across = x.truncate().length().max(y.truncate().length());
    w.truncate().length() <= PARALLEL * across
}

/// How far a camera sees, as far as that says something about the coordinates that its matrix comes from.
fn sight(at: DVec3, depths: [DVec4; 2], w: DVec4) -> f64 {
    let distance = |plane: DVec4| {
        let length = plane.truncate().length();
        let known = length > CANCELLED * w.truncate().length();
        if known { (plane.truncate().dot(at) + plane.w).abs() / length } else { f64::INFINITY }
    };
    let [a, b] = depths.map(distance);
    let sight = a.max(b).min(SIGHT * a.min(b));
    if sight.is_finite() { sight } else { 0.0 }
}

/// How far a given eye may be from the matrix's along each axis (0 where rounding explains it), and how far it
/// lies beside the planes that hold the matrix's. In the matrix's eye x, y and w of clip space are zero; one that
/// is off by a rounding lies next to these planes, however unsure it is where they meet.
fn check_eye(at: DVec3, rows: [DVec4; 3], sight: f64) -> Result<(f64, f64), Error> {
    let (mut sure, mut beside) = (true, 0f64);
    let mut refused = None;
    for row in rows {
        let length = row.truncate().length();
        let (off, far) = ((row.truncate().dot(at) + row.w).abs() / length, row.w.abs() / length);
        // A row without direction says nothing.
        if !off.is_finite() || !far.is_finite() {
            continue;
        }
        let coordinates = at.length() + far;
        let allowed = EYE_REFUSED * (coordinates + sight);
        sure &= off <= EYE_ROUNDING * coordinates;
        if off > allowed && off > refused.map_or(0.0, |r: (f64, f64)| r.0) {
            refused = Some((off, allowed));
        }
        beside = beside.max(off);
    }
    let [x, y, w] = rows;
    let found = || match find_eye(x, y, w) {
        Ok(Origin::Eye { at, .. }) => Some(at),
        _ => None,
    };
    if let Some((off, allowed)) = refused {
        return Err(Error::EyeMismatch { given: at, found: found().unwrap_or(DVec3::NAN), off, allowed });
    }
    let unsure = || found().map_or(at.length() + sight, |found| (found - at).length());
    Ok((if sure { 0.0 } else { unsure() }, beside))
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
    let [a, b, c] = [x, y, w].map(|row| {
        let length = row.truncate().length();
        if length > 0.0 { row / length } else { row }
    });
    let m = DMat3::from_cols(a.truncate(), b.truncate(), c.truncate()).transpose();
    if m.determinant().abs() < FLAT_VOLUME {
        return Err(Error::Matrix("it maps space to a plane, a line or a point"));
    }
    let inverse = m.inverse();
    let at = inverse * -DVec3::new(a.w, b.w, c.w);
    if !at.is_finite() {
        return Err(Error::Matrix("its eye is not at a finite point"));
    }
    // Each of the three planes may be off by its rounding; the more askew they meet, the farther their point is off.
    let spread: f64 = inverse.to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt();
    let error = spread * EYE_ROUNDING * at.length();
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

    /// Three planes so nearly parallel that their normals span no volume worth the name still meet in a corner.
    #[test]
    fn corners_of_nearly_parallel_planes_count() {
        let (min, max) = (DVec3::splat(-1.0), DVec3::ONE);
        for tilt in [1e-1f32, 1e-3, 1e-5, 1e-7, 1e-9] {
            // A tent: y <= tilt (1 - ...) on three sides.
            let side = |x: f32, z: f32| Plane { normal: Vec3::new(-x * tilt, -1.0, -z * tilt), offset: tilt };
            let tent = [side(1.0, 0.5), side(-1.0, 0.5), side(0.0, -1.0)];
            let tent = View::from_planes(Vec3::new(0.0, -0.9, 0.0), &tent).unwrap();
            let below = |h: f32| {
                let plane = Plane { normal: Vec3::NEG_Y, offset: h * tilt };
                View::from_planes(Vec3::new(0.0, -0.9, 0.0), &[plane]).unwrap()
            };
            let top = DVec3::new(0.0, 0.99 * f64::from(tilt), 0.0);
            assert!(tent.planes.iter().all(|p| p.distance(top) > 0.0));
            assert!(!below(0.9).holds(&tent, min, max), "{tilt}");
            assert!(below(1.1).holds(&tent, min, max) || tilt < 1e-8, "{tilt}");
            // As a near plane that cuts off the eye: what it cuts away reaches as far.
            let planes =
                tent.planes.iter().copied().chain([HalfSpace { normal: DVec3::NEG_Y, offset: -3.0 }]);
            let cut = View { planes: planes.collect(), cutting: 1 << 3, ..tent.clone() };
            let (region, block) = cut.cut_regions(min, max).next().unwrap();
            assert!(block.contains_point(top), "{tilt}");
            assert!(region.may_see_block(&Block { min: top, max: top }));
        }
    }

    /// Of narrow and wide views, all points that they see lie in the block around the view, and in views that hold it.
    #[test]
    fn regions_hold_what_is_in_all_of_their_planes() {
        let mut state = 7u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24) * 2.0 - 1.0
        };
        let mut held = 0;
        for round in 0..200 {
            let fov = [0.01f32, 0.1, 5.0, 170.0][round % 4].to_radians();
            let eye = Vec3::new(next() as f32, next() as f32, next() as f32) * 10f32.powi(round as i32 % 5);
            let dir = Vec3::new(next() as f32, next() as f32, -1.0).normalize();
            let view = |fov: f32| {
                let m = directx::perspective(fov, 1.5, 0.1, 1e3) * look_to_mat4(eye, dir, Vec3::Y);
                View::perspective(eye, m).unwrap()
            };
            let (own, wider) = (view(fov), view((fov * 1.02).min(3.1)));
            let (min, max) = (eye.as_dvec3() - 300.0, eye.as_dvec3() + 300.0);
            let corners = own.corners(min, max);
            let holds = wider.holds(&own, min, max);
            held += usize::from(holds);
            let (lo, hi) = corners
                .iter()
                .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |b, c| (b.0.min(*c), b.1.max(*c)));
            for _ in 0..300 {
                let across = DVec3::new(next(), next(), 0.0) * (f64::from(fov) * 0.5).tan().min(5.0);
                let d = DMat3::from_mat4(look_to_mat4(Vec3::ZERO, dir, Vec3::Y).as_dmat4()).transpose()
                    * (across - DVec3::Z);
                let p = eye.as_dvec3() + d * (next().abs() * 280.0);
                let inside = p.cmpge(min).all() && p.cmple(max).all();
                if inside && own.planes.iter().all(|h| h.distance(p) >= 0.0) {
                    assert!(lo.cmple(p).all() && p.cmple(hi).all(), "{p}");
                    assert!(!holds || wider.planes.iter().all(|h| h.distance(p) >= 0.0), "{p}");
                }
            }
        }
        assert!(held > 20, "{held}");
    }

    /// An infinite far plane cuts off nothing, through however many products the matrix went.
    #[test]
    fn what_rounding_leaves_of_an_infinite_far_plane_cuts_off_nothing() {
        let flip = Mat4::from_cols_array(&[1., 0., 0., 0., 0., 1., 0., 0., 0., 0., -1., 0., 0., 0., 1., 1.]);
        let squeeze =
            Mat4::from_cols_array(&[1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 0.7, 0., 0., 0., 0.3, 1.]);
        let mut state = 9u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24) * 2.0 - 1.0
        };
        for round in 0..600 {
            let eye = Vec3::new(next() as f32, next() as f32, next() as f32) * 10f32.powi(round % 6);
            let dir = Vec3::new(next() as f32, next() as f32, next() as f32 - 1.5).normalize();
            let world = Mat4::from_rotation_z(next() as f32) * Mat4::from_rotation_x(next() as f32);
            let p = directx::perspective_infinite(1.0, 1.5, 0.1);
            let p = [p, flip * p, squeeze * p, flip * (squeeze * p)][round as usize % 4];
            let own = world.as_dmat4().inverse().transform_point3(eye.as_dvec3());
            let m = p * look_to_mat4(eye, dir, Vec3::Y) * world;
            let view = View::from_view_projection(m).unwrap();
            let ahead = world.as_dmat4().inverse().transform_vector3(dir.as_dvec3());
            for far in [1.0, 1e2, 1e3, 1e4, 1e5] {
                let q = own + ahead * (far + 3e-6 * own.length());
                assert!(view.planes.iter().all(|h| h.distance(q) >= -1e-4 * far), "{round} {eye} {far}");
            }
        }
    }
}
