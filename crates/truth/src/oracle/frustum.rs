//! The rays and the clip volume of a camera in f64, from its exact eye.

use glam::{DMat3, DMat4, DVec3};

use crate::numeric::oracle::{NEAREST, PLANE, SURELY_INSIDE};
use casca_scenes::world::Camera;

/// An affine function of a point, given relative to the eye.
#[derive(Debug, Clone, Copy)]
struct Row {
    normal: DVec3,
    constant: f64,
}

impl Row {
    fn at(&self, relative: DVec3) -> f64 {
        self.normal.dot(relative) + self.constant
    }
}

/// From where a point is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Viewpoint {
    /// From one point: perspective, or all-round.
    Eye(DVec3),
    /// Along parallel rays with this unit direction: orthographic.
    Direction(DVec3),
}

impl Viewpoint {
    /// The vector from `point` towards the viewer, not normalised.
    pub fn towards(&self, point: DVec3) -> DVec3 {
        match *self {
            Self::Eye(eye) => eye - point,
            Self::Direction(direction) => -direction,
        }
    }
}

/// The clip volume of a camera: -w <= x <= w, -w <= y <= w, 0 <= z <= w.
///
/// All in f64. For a perspective camera the centre of projection is exactly
/// `Camera::eye`; the rounding in the translation of the view matrix is left
/// out. Reversed and infinite depth work too. The planes of equal clip depth
/// must be parallel to the screen, so an oblique near plane is not supported.
#[derive(Debug, Clone, Copy)]
pub struct Frustum {
    eye: DVec3,
    rows: [Row; 4],
    /// The product of the matrices as a renderer rounds it to f32.
    rounded: DMat4,
    perspective: bool,
    forward: DVec3,
    near: f64,
    far: f64,
}

impl Frustum {
    /// The clip volume of `camera`.
    pub fn new(camera: &Camera) -> Self {
        let view = camera.view.as_dmat4();
        let projection = camera.projection.as_dmat4();
        let eye = camera.eye.as_dvec3();
        let turn = [view.row(0).truncate(), view.row(1).truncate(), view.row(2).truncate()];
        let bottom = projection.row(3).truncate();
        let perspective = bottom != DVec3::ZERO;
        // In view space the eye is the origin; orthographic rays have no
        // centre, so there the translation is taken as it is.
        let origin = if perspective { DVec3::ZERO } else { view.transform_point3(eye) };
        let rows = [0, 1, 2, 3].map(|i| {
            let row = projection.row(i);
            Row {
                normal: turn[0] * row.x + turn[1] * row.y + turn[2] * row.z,
                constant: row.truncate().dot(origin) + row.w,
            }
        });
        let forward = if perspective { rows[3].normal } else { -turn[2] }.normalize();
        let mut frustum = Self {
            eye,
            rows,
            rounded: camera.view_projection().as_dmat4(),
            perspective,
            forward,
            near: f64::NEG_INFINITY,
            far: f64::INFINITY,
        };
        let [_, _, z, w] = rows;
        // z >= 0 and w - z >= 0 along the ray through the middle.
        let (start, step) = frustum.ray(0.0, 0.0);
        let w_minus_z = Row { normal: w.normal - z.normal, constant: w.constant - z.constant };
        for row in [z, w_minus_z] {
            let (value, slope) = (row.at(start), row.normal.dot(step));
            if slope > 0.0 {
                frustum.near = frustum.near.max(-value / slope);
            } else if slope < 0.0 {
                frustum.far = frustum.far.min(-value / slope);
            } else if value < 0.0 {
                frustum.far = f64::NEG_INFINITY;
            }
        }
        if perspective {
            frustum.near = frustum.near.max(NEAREST);
        }
        frustum
    }

    /// Whether all rays start at one point.
    pub fn is_perspective(&self) -> bool {
        self.perspective
    }

    /// The eye.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The unit direction in which depth grows.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// Depth of the near plane: metres along [`Self::forward`] from the eye.
    pub fn near(&self) -> f64 {
        self.near
    }

    /// Depth of the far plane; may be infinite.
    pub fn far(&self) -> f64 {
        self.far
    }

    /// From where this camera looks at points.
    pub fn viewpoint(&self) -> Viewpoint {
        if self.perspective {
            Viewpoint::Eye(self.eye)
        } else {
            Viewpoint::Direction(self.ray(0.0, 0.0).1.normalize())
        }
    }

    /// Depth of a point: metres along [`Self::forward`] from the eye.
    pub fn depth(&self, point: DVec3) -> f64 {
        self.forward.dot(point - self.eye)
    }

    /// The ray through normalised device coordinates (x right, y up, -1 to 1):
    /// its start relative to the eye at depth 0, and its step per metre of
    /// depth. Both are affine in `x` and `y`.
    pub fn ray(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        let [rx, ry, _, rw] = self.rows.map(|row| row.normal);
        let middle = rx.cross(ry);
        let scale = 1.0 / middle.dot(self.forward);
        if self.perspective {
            let step = middle + ry.cross(rw) * x + rw.cross(rx) * y;
            return (DVec3::ZERO, step * scale);
        }
        let [cx, cy, _, cw] = self.rows.map(|row| row.constant);
        let planes = DMat3::from_cols(rx, ry, self.forward).transpose();
        (planes.inverse() * DVec3::new(x * cw - cx, y * cw - cy, 0.0), middle * scale)
    }

    /// Whether `point` is in the clip volume by a margin, and also in
    /// the volume of the matrix product rounded to f32: a
    /// renderer's rounding cannot put it outside.
    pub fn surely_contains(&self, point: DVec3) -> bool {
        let rounded = self.rounded * point.extend(1.0);
        let [x, y, z, w] = self.rows.map(|row| row.at(point - self.eye));
        let depth = self.depth(point);
        depth >= self.near + SURELY_INSIDE * (1.0 + self.near.abs())
            && depth + SURELY_INSIDE * (1.0 + depth.abs()) <= self.far
            && [[x, y, z, w], rounded.to_array()].into_iter().all(inside)
    }

    /// Whether a box may meet the clip volume; false only if it does not (NaN may).
    pub fn may_meet_box(&self, min: DVec3, max: DVec3) -> bool {
        let half = (max - min) * 0.5;
        self.may_meet((min + max) * 0.5, |normal| normal.abs().dot(half))
    }

    /// Whether a sphere may meet the clip volume; false only if it does not (NaN may).
    pub fn may_meet_sphere(&self, center: DVec3, radius: f64) -> bool {
        self.may_meet(center, |normal| normal.length() * radius)
    }

    fn may_meet(&self, center: DVec3, reach: impl Fn(DVec3) -> f64) -> bool {
        let center = center - self.eye;
        self.planes().all(|row| {
            let (value, reach) = (row.at(center), reach(row.normal));
            let slack = PLANE * (row.normal.abs().dot(center.abs()) + reach + row.constant.abs());
            let outside = value + reach < -slack;
            !outside
        })
    }

    fn planes(&self) -> impl Iterator<Item = Row> {
        let [x, y, z, w] = self.rows;
        let combine = |a: Row, sign: f64, b: Row| Row {
            normal: a.normal + b.normal * sign,
            constant: a.constant + b.constant * sign,
        };
        [
            combine(w, 1.0, x),
            combine(w, -1.0, x),
            combine(w, 1.0, y),
            combine(w, -1.0, y),
            z,
            combine(w, -1.0, z),
        ]
        .into_iter()
    }

    /// Where the ray to `target` leaves the near plane; the target itself if
    /// it is nearer than that.
    pub fn start(&self, target: DVec3) -> DVec3 {
        let depth = self.depth(target);
        if depth <= self.near {
            target
        } else if self.perspective {
            self.eye + (target - self.eye) * (self.near / depth)
        } else {
            target - self.ray(0.0, 0.0).1 * (depth - self.near)
        }
    }
}

/// Whether a point of the clip space is surely inside. The margin is for x and y only: near an
/// infinite far plane z comes as near to w as it likes.
fn inside([x, y, z, w]: [f64; 4]) -> bool {
    let limit = w - SURELY_INSIDE * w.abs();
    w > 0.0 && x.abs() <= limit && y.abs() <= limit && z >= 0.0 && z <= w
}
