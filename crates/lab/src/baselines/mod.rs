//! The methods that engines use today, as a yardstick: a sampled depth buffer, tested by
//! rectangles. Fast code that one would ship, without casca's guarantee: what shows between the
//! samples is lost.
//!
//! - [`Hzb`]: triangles of occluders are rasterised front to back with pixel-centre sampling, and
//!   objects tested on the way by a pyramid of farthest depths (Greene, Kass & Miller 1993; as in
//!   software occlusion culling of today's engines).
//! - [`RayBuffer`]: a low-resolution depth buffer is ray-cast against a bounding volume
//!   hierarchy, and its pyramid tests all objects (as Godot does).
//!
//! Both are given the objects inside the frustum; finding those is not part of their time.

mod hzb;
mod pyramid;
mod rays;
#[cfg(test)]
mod tests;

pub use hzb::Hzb;
pub use pyramid::DepthPyramid;
pub use rays::RayBuffer;

use glam::{Mat4, Vec3, Vec4};

use crate::world::{Camera, Object, Shape};

/// A box in world space.
fn bounds(shape: &Shape) -> (Vec3, Vec3) {
    match shape {
        Shape::Sphere { center, radius } => (*center - *radius, *center + *radius),
        Shape::Box { min, max } => (*min, *max),
        Shape::Mesh { mesh, transform } => {
            let mut bounds = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            for p in &mesh.positions {
                let p = transform.transform_point3(*p);
                bounds = (bounds.0.min(p), bounds.1.max(p));
            }
            bounds
        }
    }
}

/// What a box covers on the screen: pixels and greatest nearness (1 / view depth).
struct ScreenBox {
    x: (f32, f32),
    y: (f32, f32),
    near: f32,
}

/// Where clip space falls on the pixels.
#[derive(Clone, Copy)]
struct Screen {
    matrix: Mat4,
    width: f32,
    height: f32,
    near: f32,
}

impl Screen {
    fn new(camera: &Camera, width: usize, height: usize) -> Self {
        let p = &camera.projection;
        // Depth 0 for a usual projection, 1 for a reversed one, whichever lies nearer.
        let (a, b) = (p.z_axis.z, p.w_axis.z);
        let near = [b / a, b / (a + 1.0)].into_iter().filter(|z| *z > 0.0).fold(f32::INFINITY, f32::min);
        let near = if near.is_finite() { near } else { 1e-3 };
        Self { matrix: camera.view_projection(), width: width as f32, height: height as f32, near }
    }

    fn clip(&self, p: Vec3) -> Vec4 {
        self.matrix * p.extend(1.0)
    }

    /// Pixel coordinates and nearness.
    fn project(&self, c: Vec4) -> Vec3 {
        let inverse = 1.0 / c.w;
        Vec3::new(
            (c.x * inverse * 0.5 + 0.5) * self.width,
            (0.5 - c.y * inverse * 0.5) * self.height,
            inverse,
        )
    }

    /// `None` if the box reaches in front of the near plane.
    fn rectangle(&self, (min, max): (Vec3, Vec3)) -> Option<ScreenBox> {
        let mut r = ScreenBox {
            x: (f32::INFINITY, f32::NEG_INFINITY),
            y: (f32::INFINITY, f32::NEG_INFINITY),
            near: 0.0,
        };
        for i in 0..8 {
            let corner = Vec3::new(
                if i & 1 == 0 { min.x } else { max.x },
                if i & 2 == 0 { min.y } else { max.y },
                if i & 4 == 0 { min.z } else { max.z },
            );
            let c = self.clip(corner);
            if c.w < self.near {
                return None;
            }
            let p = self.project(c);
            r.x = (r.x.0.min(p.x), r.x.1.max(p.x));
            r.y = (r.y.0.min(p.y), r.y.1.max(p.y));
            r.near = r.near.max(p.z);
        }
        Some(r)
    }
}

/// The objects given by distance from the eye to their boxes, nearest first.
fn front_to_back(objects: &[Object], given: &[usize], eye: Vec3) -> Vec<(f32, usize)> {
    let mut order: Vec<(f32, usize)> = given
        .iter()
        .map(|&i| {
            let (min, max) = bounds(&objects[i].shape);
            ((eye.clamp(min, max) - eye).length_squared(), i)
        })
        .collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    order
}
