//! Matrices as half-spaces: the sides, the near and the far plane of a camera.

use glam::{DVec3, DVec4, Mat4};
use smallvec::SmallVec;

use crate::error::Error;
use crate::geometry::plane::HalfSpace;
use crate::numeric::view::{CANCELLED, ELEMENT, PARALLEL};
use crate::view::eye::{Origin, check_eye, find_eye, sight};

/// The origin of a camera's rays and the planes that bound them.
#[derive(Debug, Clone)]
pub(crate) struct Frustum {
    pub(crate) origin: Origin,
    pub(crate) planes: SmallVec<[HalfSpace; 6]>,
    /// One bit for each plane that may lie between the eye and the rest.
    pub(crate) cutting: u32,
    /// One bit for each plane through the eye.
    pub(crate) sides: u32,
    /// How far planes that cut off the eye, or any of parallel rays, were moved outwards, at most.
    pub(crate) widened: f64,
}

impl Frustum {
    /// The frustum of a matrix from world space to clip space, with depth from 0 or (`gl_depth`)
    /// from -1 to 1.
    pub(crate) fn new(matrix: Mat4, gl_depth: bool, eye: Option<DVec3>) -> Result<Self, Error> {
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
        Self::bounded(origin, rows, near, eye.map(|_| beside))
    }

    /// Moves the planes of a matrix outwards by their rounding. An eye that was given lies `beside`
    /// those that should contain it, at most.
    fn bounded(
        origin: Origin,
        [x, y, z, w]: [DVec4; 4],
        near: DVec4,
        beside: Option<f64>,
    ) -> Result<Self, Error> {
        let mut planes: SmallVec<[HalfSpace; 6]> = SmallVec::new();
        let (mut cutting, mut sides, mut widened) = (0, 0, 0f64);
        let across = [(w + x, [w, x]), (w - x, [w, x]), (w + y, [w, y]), (w - y, [w, y])];
        for (i, (plane, parts)) in across.into_iter().chain([(near, [w, z]), (w - z, [w, z])]).enumerate() {
            let size = parts[0].truncate().length() + parts[1].truncate().length();
            let length = plane.truncate().length();
            if length > CANCELLED * size {
                planes.extend(HalfSpace::new(plane).map(|mut space| {
                    // Rows that cancel leave their rounding behind: a far plane is known worse.
                    let worse = (size / length).max(1.0);
                    let mut unsure = ELEMENT * worse * space.offset.abs();
                    let mut cuts = false;
                    if let Origin::Eye { at, .. } = origin {
                        unsure += ELEMENT * worse * at.length();
                        if i < 4 {
                            // The sides of a view meet in its eye.
                            sides |= 1 << planes.len();
                            unsure += if beside.is_some() { (-space.distance(at)).max(0.0) } else { 0.0 };
                        } else {
                            unsure += beside.unwrap_or(0.0);
                            // The near or far plane, whichever may lie between the eye and the
                            // rest.
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
        Ok(Self { origin, planes, cutting, sides, widened })
    }
}

/// Whether w is the same everywhere: an orthographic projection. However far the eye is, since
/// distances from the origin do not count.
fn is_parallel(x: DVec4, y: DVec4, w: DVec4) -> bool {
    let across = x.truncate().length().max(y.truncate().length());
    w.truncate().length() <= PARALLEL * across
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
