//! Rays through the centres of pixels.

use glam::DVec3;

use super::super::frustum::Frustum;

/// The rays through pixel centres: affine in pixel coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelRays {
    pub(super) perspective: bool,
    /// Start of the ray relative to the eye, at depth 0: value at (0, 0) and
    /// steps per pixel in x and y.
    pub(super) start: [DVec3; 3],
    /// Way per metre of depth.
    pub(super) step: [DVec3; 3],
    pub(super) forward: DVec3,
    pub(super) near: f64,
    pub(super) far: f64,
}

impl PixelRays {
    pub(super) fn new(frustum: &Frustum, width: usize, height: usize) -> Self {
        let (dx, dy) = (2.0 / width as f64, -2.0 / height as f64);
        let (start, step) = frustum.ray(-1.0 + 0.5 * dx, 1.0 + 0.5 * dy);
        let (start_x, step_x) = frustum.ray(0.0, 0.0);
        let (right, step_right) = frustum.ray(1.0, 0.0);
        let (up, step_up) = frustum.ray(0.0, 1.0);
        Self {
            perspective: frustum.is_perspective(),
            start: [start, (right - start_x) * dx, (up - start_x) * dy],
            step: [step, (step_right - step_x) * dx, (step_up - step_x) * dy],
            forward: frustum.forward(),
            near: frustum.near(),
            far: frustum.far(),
        }
    }

    /// Depth of a point relative to the eye.
    pub(super) fn depth(&self, relative: DVec3) -> f64 {
        self.forward.dot(relative)
    }

    pub(super) fn start(&self, x: usize, y: usize) -> DVec3 {
        self.start[0] + self.start[2] * y as f64 + self.start[1] * x as f64
    }

    pub(super) fn step(&self, x: usize, y: usize) -> DVec3 {
        self.step[0] + self.step[2] * y as f64 + self.step[1] * x as f64
    }
}
