//! A camera, as scenes give it and as renderers take it.

use glam::{Mat4, Vec3, camera};

/// A camera: the exact eye, and the matrices that a renderer uses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Position of the eye in world space.
    pub eye: Vec3,
    /// World to view space, right-handed, looking along -z.
    pub view: Mat4,
    /// View to clip space, y up, depth 0 to 1.
    pub projection: Mat4,
}

impl Camera {
    /// A perspective camera at `eye` looking at `target`, y up.
    pub fn look_at(eye: Vec3, target: Vec3, fov_y_degrees: f32, aspect: f32, near: f32, far: f32) -> Self {
        let forward = (target - eye).normalize_or(Vec3::NEG_Z);
        let up = if forward.y.abs() > 0.999 { Vec3::Z } else { Vec3::Y };
        Self {
            eye,
            view: camera::rh::view::look_to_mat4(eye, forward, up),
            projection: camera::rh::proj::directx::perspective(fov_y_degrees.to_radians(), aspect, near, far),
        }
    }

    /// The same camera at another place, not turned.
    pub fn at(mut self, eye: Vec3) -> Self {
        self.eye = eye;
        self.view.w_axis = (-self.view.transform_vector3(eye)).extend(1.0);
        self
    }

    /// World to clip space.
    pub fn view_projection(&self) -> Mat4 {
        self.projection * self.view
    }
}
