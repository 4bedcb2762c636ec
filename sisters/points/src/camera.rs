//! A pinhole camera with a picture of whole pixels.

use glam::camera::rh::{proj::directx::perspective, view::look_to_mat4};
use glam::{Mat4, Vec3};

/// The largest width or height of a picture. Positions in it are counted in 1/256 of a pixel by floats.
pub const MAX_SIDE: u32 = 8192;

/// The largest number of pixels of a picture: 4 bytes each, in a few images of this size.
pub const MAX_PIXELS: u32 = 1 << 25;

/// A pinhole camera with square pixels. It looks at its target, which is in the middle of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    eye: Vec3,
    /// To the right and down, as long as there are pixels in a tangent of 1.
    right: Vec3,
    down: Vec3,
    forward: Vec3,
    pixels_per_tangent: f32,
    size: (u32, u32),
    near: f32,
    far: f32,
    view_projection: Mat4,
}

/// Where a camera sees a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projected {
    /// Pixels to the right of the left border.
    pub x: f32,
    /// Pixels below the upper border.
    pub y: f32,
    /// The distance from the plane through the eye that is parallel to the picture, in units of the world.
    pub depth: f32,
}

/// Why there is no camera.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A coordinate is infinite or not a number, or the distance to the target is more than a float can hold.
    #[error("the eye, the target or the direction upwards is not finite, or the target is too far")]
    NotFinite,
    /// The eye is at the target, or the direction upwards is that of the view or 0.
    #[error("the direction from the eye to the target and the one upwards span no plane")]
    NoDirection,
    /// The vertical angle is not between 0 and pi, or so near to them that its tangent is useless.
    #[error("the vertical field of view is {fov_y} radians, and must be from 0.001 to 3.1")]
    FieldOfView {
        /// The given angle.
        fov_y: f32,
    },
    /// A picture without pixels, or of too many.
    #[error(
        "a picture of {size:?} pixels: each side must be from 1 to {MAX_SIDE}, their product at most {MAX_PIXELS}"
    )]
    Size {
        /// The given size.
        size: (u32, u32),
    },
    /// Depths that are not in order.
    #[error("near is {near} and far is {far}: they must be finite, with 0 < near < far")]
    Depths {
        /// The given nearest depth.
        near: f32,
        /// The given farthest depth.
        far: f32,
    },
}

impl Camera {
    /// A camera at `eye`. `fov_y` is the vertical angle of the picture in radians, `size` its width and
    /// height in pixels; points nearer than the depth `near` or farther than `far` are not seen.
    ///
    /// # Errors
    /// [`CameraError`] names the parameter at fault.
    pub fn look_at(
        eye: Vec3,
        target: Vec3,
        up: Vec3,
        fov_y: f32,
        size: (u32, u32),
        near: f32,
        far: f32,
    ) -> Result<Self, CameraError> {
        if !((target - eye).is_finite() && up.is_finite() && eye.is_finite()) {
            return Err(CameraError::NotFinite);
        }
        if !(0.001..=3.1).contains(&fov_y) {
            return Err(CameraError::FieldOfView { fov_y });
        }
        let side = 1..=MAX_SIDE;
        if !(side.contains(&size.0) && side.contains(&size.1) && size.0 * size.1 <= MAX_PIXELS) {
            return Err(CameraError::Size { size });
        }
        if !(0.0 < near && near < far && far.is_finite()) {
            return Err(CameraError::Depths { near, far });
        }
        // Divided first, so that no square overflows or vanishes.
        let unit = |v: Vec3| (v / v.abs().max_element()).try_normalize();
        let (forward, upwards) = unit(target - eye).zip(unit(up)).ok_or(CameraError::NoDirection)?;
        let right = forward.cross(upwards).try_normalize().ok_or(CameraError::NoDirection)?;
        let pixels_per_tangent = size.1 as f32 / (2.0 * (fov_y / 2.0).tan());
        let aspect = size.0 as f32 / size.1 as f32;
        let view_projection = perspective(fov_y, aspect, near, far) * look_to_mat4(eye, forward, upwards);
        let down = forward.cross(right) * pixels_per_tangent;
        let right = right * pixels_per_tangent;
        Ok(Self { eye, right, down, forward, pixels_per_tangent, size, near, far, view_projection })
    }

    /// The position of the eye.
    pub fn eye(&self) -> Vec3 {
        self.eye
    }

    /// Width and height of the picture in pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// The least and the largest depth of a point that is seen.
    pub fn depths(&self) -> (f32, f32) {
        (self.near, self.far)
    }

    /// The matrix from the world to clip space, with depths from 0 at `near` to 1 at `far`.
    pub fn view_projection(&self) -> Mat4 {
        self.view_projection
    }

    /// The pixels that a length of 1, parallel to the picture, covers at the depth 1: half the
    /// height over the tangent of half the angle.
    pub fn pixels_per_tangent(&self) -> f32 {
        self.pixels_per_tangent
    }

    /// The directions right, down and forward, in this order. The first two are
    /// [`Camera::pixels_per_tangent`] long, the third is 1 long.
    pub fn axes(&self) -> [Vec3; 3] {
        [self.right, self.down, self.forward]
    }

    /// Where a point is in the picture; `None` outside, nearer than `near`, farther than `far`, or
    /// if it is not finite.
    pub fn project(&self, p: Vec3) -> Option<Projected> {
        let at = self.place(p);
        let seen = at.depth >= self.near && at.depth <= self.far;
        let inside = |x: f32, side: u32| x >= 0.0 && x < side as f32;
        (seen && inside(at.x, self.size.0) && inside(at.y, self.size.1)).then_some(at)
    }

    /// The projection of any point; no use for those behind the eye.
    #[inline(always)]
    pub(crate) fn place(&self, p: Vec3) -> Projected {
        let offset = p - self.eye;
        let depth = self.forward.dot(offset);
        let inverse = 1.0 / depth;
        let x = self.size.0 as f32 * 0.5 + self.right.dot(offset) * inverse;
        let y = self.size.1 as f32 * 0.5 + self.down.dot(offset) * inverse;
        Projected { x, y, depth }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_projection_is_that_of_the_matrix() {
        let eye = Vec3::new(1.0, 2.0, 3.0);
        let camera = Camera::look_at(eye, Vec3::ZERO, Vec3::Y, 0.8, (641, 480), 0.5, 50.0).unwrap();
        for p in [Vec3::ZERO, Vec3::new(0.3, -0.5, 0.2), Vec3::new(-1.0, 0.4, 0.3)] {
            let at = camera.project(p).unwrap();
            let clip = camera.view_projection() * p.extend(1.0);
            let expected = [(clip.x / clip.w + 1.0) * 320.5, (1.0 - clip.y / clip.w) * 240.0, clip.w];
            for (found, expected) in [at.x, at.y, at.depth].into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-3, "{p} {found} {expected}");
            }
        }
        for (p, why) in [(eye * 2.0, "behind the eye"), (Vec3::NAN, "nowhere"), (eye * 0.9, "too near")] {
            assert_eq!(camera.project(p), None, "{why}");
        }
    }

    #[test]
    fn the_matrix_looks_where_the_projection_does_far_from_zero() {
        let eye = Vec3::new(1e6, 1.75, 7e5);
        let forward = Vec3::new(0.6, 0.0, -0.8);
        let camera =
            Camera::look_at(eye, eye + forward * 1024.0, Vec3::Y, 0.8, (640, 480), 1.0, 1e4).unwrap();
        // The eye's own coordinates in a matrix of floats are off by a few units at such a
        // distance, its direction is not.
        let row = camera.view_projection().row(3).truncate();
        let [_, _, along] = camera.axes();
        assert!((row - along).length() < 1e-6, "{row} {along}");
    }

    #[test]
    fn errors_name_the_cause() {
        let make =
            |target, up, fov, size, near| Camera::look_at(Vec3::ZERO, target, up, fov, size, near, 9.0);
        let (z, y) = (Vec3::Z, Vec3::Y);
        assert_eq!(make(Vec3::NAN, y, 1.0, (1, 1), 1.0), Err(CameraError::NotFinite));
        for (target, up) in [(Vec3::ZERO, y), (z, z * 3.0)] {
            assert_eq!(make(target, up, 1.0, (1, 1), 1.0), Err(CameraError::NoDirection));
        }
        assert_eq!(make(z, y, -1.0, (1, 1), 1.0), Err(CameraError::FieldOfView { fov_y: -1.0 }));
        for size in [(0, 1), (8192, 8192)] {
            assert_eq!(make(z, y, 1.0, size, 1.0), Err(CameraError::Size { size }));
        }
        assert_eq!(make(z, y, 1.0, (1, 1), 9.0), Err(CameraError::Depths { near: 9.0, far: 9.0 }));
        assert!(make(z * 1e-38, y * 1e38, 1.0, (8192, 4096), 1e-30).is_ok());
    }
}
