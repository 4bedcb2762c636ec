//! What is in view, and where on the screen.

use casca_scenes::world::{Object, Shape, Sides};
use glam::DVec3;
use rayon::prelude::*;

use super::super::frustum::Frustum;
use super::super::geometry::{MeshCache, Primitive, safe_inverse, sides_of};
use super::frame::Entry;
use super::pixel_rays::PixelRays;
use crate::numeric::oracle::{KEY, RECTANGLE};

/// Finds what to draw, and where on the screen.
pub(super) struct Setup<'a> {
    pub(super) frustum: &'a Frustum,
    pub(super) rays: PixelRays,
    pub(super) width: usize,
    pub(super) height: usize,
}

impl Setup<'_> {
    pub(super) fn solid(&self, index: u32, object: &Object) -> Option<Entry> {
        let is_mesh = matches!(object.shape, Shape::Mesh { .. });
        if is_mesh || (!object.occludes && !object.tested) || !Primitive::of(&object.shape, 0).is_sound() {
            return None;
        }
        let eye = self.frustum.eye();
        let (rect, near) = match object.shape {
            Shape::Sphere { center, radius } => {
                let (center, radius) = (center.as_dvec3() - eye, f64::from(radius));
                let depth = self.frustum.forward().dot(center);
                if depth + radius < self.rays.near || !self.frustum.may_meet_sphere(center + eye, radius) {
                    return None;
                }
                let range = |axis| self.frustum.sphere_range(center, radius, axis);
                if let (Some(x), Some(y)) = (range(0), range(1)) {
                    (self.rect([x[0], y[0]], [x[1], y[1]])?, depth - radius)
                } else {
                    (self.box_rect(center - radius, center + radius)?.0, depth - radius)
                }
            }
            Shape::Box { min, max } => self.box_rect(min.as_dvec3() - eye, max.as_dvec3() - eye)?,
            Shape::Mesh { .. } => return None,
        };
        let (near, hides) = (self.key(near)?, object.occludes);
        Some(Entry { near, object: index, triangle: 0, slot: 0, hides, rect })
    }

    pub(super) fn mesh_in_view(&self, object: &Object, meshes: &MeshCache) -> bool {
        if !matches!(object.shape, Shape::Mesh { .. }) || (!object.occludes && !object.tested) {
            return false;
        }
        let (min, max) = meshes.bounds(&object.shape);
        min.cmple(max).all() && self.frustum.may_meet_box(min, max)
    }

    /// Vertices relative to the eye, and the triangles on screen.
    pub(super) fn mesh(&self, object: u32, slot: u32, shape: &Object) -> (Vec<DVec3>, Vec<Entry>) {
        let Shape::Mesh { mesh, transform } = &shape.shape else { return (Vec::new(), Vec::new()) };
        let transform = transform.as_daffine3();
        let eye = self.frustum.eye();
        let forward = self.frustum.forward();
        let clip = self.clip_depth();
        // Relative to the eye; on the screen in pixels; depth.
        let projected: Vec<(DVec3, [f64; 2], f64)> = mesh
            .positions
            .par_iter()
            .with_min_len(4096)
            .map(|position| {
                let relative = transform.transform_point3(position.as_dvec3()) - eye;
                (relative, self.pixel(self.frustum.project(relative)), forward.dot(relative))
            })
            .collect();
        let entries = mesh
            .triangles
            .par_iter()
            .enumerate()
            .with_min_len(4096)
            .filter_map(|(i, triangle)| {
                let corners = triangle.map(|v| &projected[v as usize]);
                let depths = corners.map(|c| c.2);
                let near = depths[0].min(depths[1]).min(depths[2]);
                let far = depths[0].max(depths[1]).max(depths[2]);
                if far < self.rays.near {
                    return None;
                }
                let rect = if near >= clip {
                    let [a, b, c] = corners.map(|c| c.1);
                    self.pixels(
                        [a[0].min(b[0]).min(c[0]), a[1].min(b[1]).min(c[1])],
                        [a[0].max(b[0]).max(c[0]), a[1].max(b[1]).max(c[1])],
                    )?
                } else {
                    let points = corners.map(|c| c.0);
                    self.clipped_rect(&points, &[(0, 1), (1, 2), (2, 0)])?
                };
                let hides = shape.occludes && self.stops(&shape.shape, i as u32, corners.map(|c| c.0));
                Some(Entry { near: self.key(near)?, object, triangle: i as u32, slot, hides, rect })
            })
            .collect();
        (projected.into_iter().map(|(relative, ..)| relative).collect(), entries)
    }

    /// Whether a triangle, given relative to the eye, stops the rays of pixels: all of them meet
    /// the same side of it.
    fn stops(&self, shape: &Shape, triangle: u32, [a, b, c]: [DVec3; 3]) -> bool {
        match (sides_of(shape, triangle), shape) {
            (Sides::Front, Shape::Mesh { transform, .. }) => {
                let way = if self.rays.perspective { a } else { self.rays.step(0, 0) };
                let front = (b - a).cross(c - a) * f64::from(transform.matrix3.determinant()).signum();
                front.dot(way) < 0.0
            }
            (sides, _) => sides != Sides::Neither,
        }
    }

    /// The rectangle and the least depth of a box given relative to the eye.
    pub(super) fn box_rect(&self, min: DVec3, max: DVec3) -> Option<([u16; 4], f64)> {
        const EDGES: [(usize, usize); 12] =
            [(0, 1), (2, 3), (4, 5), (6, 7), (0, 2), (1, 3), (4, 6), (5, 7), (0, 4), (1, 5), (2, 6), (3, 7)];
        let corners: [DVec3; 8] = std::array::from_fn(|i| {
            let pick = |bit: usize, low: f64, high: f64| if i >> bit & 1 == 0 { low } else { high };
            DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z))
        });
        let forward = self.frustum.forward();
        let depths = corners.map(|corner| forward.dot(corner));
        let near = depths.into_iter().fold(f64::INFINITY, f64::min);
        let far = depths.into_iter().fold(f64::NEG_INFINITY, f64::max);
        if far < self.rays.near || near > self.rays.far {
            return None;
        }
        Some((self.clipped_rect(&corners, &EDGES)?, near))
    }

    /// Points nearer than this cannot be projected.
    pub(super) fn clip_depth(&self) -> f64 {
        if self.rays.perspective { self.rays.near } else { f64::NEG_INFINITY }
    }

    pub(super) fn clipped_rect(&self, points: &[DVec3], edges: &[(usize, usize)]) -> Option<[u16; 4]> {
        let clip = self.clip_depth();
        let forward = self.frustum.forward();
        let mut min = [f64::INFINITY; 2];
        let mut max = [f64::NEG_INFINITY; 2];
        let mut add = |point: DVec3| {
            let at = self.frustum.project(point);
            for axis in 0..2 {
                min[axis] = min[axis].min(at[axis]);
                max[axis] = max[axis].max(at[axis]);
            }
        };
        for &point in points {
            if forward.dot(point) >= clip {
                add(point);
            }
        }
        for &(a, b) in edges {
            let (a, b) = (points[a], points[b]);
            let (da, db) = (forward.dot(a), forward.dot(b));
            if (da < clip) != (db < clip) {
                add(a + (b - a) * ((clip - da) / (db - da)));
            }
        }
        self.rect(min, max)
    }

    pub(super) fn pixel(&self, at: [f64; 2]) -> [f64; 2] {
        [(at[0] + 1.0) * 0.5 * self.width as f64, (1.0 - at[1]) * 0.5 * self.height as f64]
    }

    /// Pixels whose centre is in the range, given in device coordinates.
    pub(super) fn rect(&self, min: [f64; 2], max: [f64; 2]) -> Option<[u16; 4]> {
        let (a, b) = (self.pixel(min), self.pixel(max));
        self.pixels([a[0], b[1]], [b[0], a[1]])
    }

    /// Pixels whose centre is in the range, given in pixels.
    pub(super) fn pixels(&self, min: [f64; 2], max: [f64; 2]) -> Option<[u16; 4]> {
        let x0 = (min[0] - 0.5 - RECTANGLE).ceil().max(0.0);
        let y0 = (min[1] - 0.5 - RECTANGLE).ceil().max(0.0);
        let x1 = (max[0] - 0.5 + RECTANGLE).floor().min(self.width as f64 - 1.0);
        let y1 = (max[1] - 0.5 + RECTANGLE).floor().min(self.height as f64 - 1.0);
        (x0 <= x1 && y0 <= y1).then_some([x0 as u16, y0 as u16, x1 as u16, y1 as u16])
    }

    /// The key to sort by; None beyond the far plane.
    pub(super) fn key(&self, near: f64) -> Option<f32> {
        (near <= self.rays.far).then(|| ((near - self.rays.near) * (1.0 - KEY)).max(0.0) as f32)
    }

    /// Whether a tested solid holds the eye and reaches beyond the near plane
    /// in view.
    pub(super) fn holds_eye(&self, object: &Object) -> bool {
        if !object.tested {
            return false;
        }
        let eye = self.frustum.eye();
        let leave: Box<dyn Fn(DVec3) -> f64> = match object.shape {
            Shape::Sphere { center, radius } => {
                let to_center = center.as_dvec3() - eye;
                let outside = to_center.length_squared() - f64::from(radius) * f64::from(radius);
                if outside >= 0.0 {
                    return false;
                }
                Box::new(move |step| {
                    let (a, b) = (step.length_squared(), step.dot(to_center));
                    (b + (b * b - a * outside).sqrt()) / a
                })
            }
            Shape::Box { min, max } => {
                let (low, high) = (min.as_dvec3() - eye, max.as_dvec3() - eye);
                if !(low.max_element() < 0.0 && high.min_element() > 0.0) {
                    return false;
                }
                Box::new(move |step| {
                    let inverse = safe_inverse(step);
                    (low * inverse).max(high * inverse).min_element()
                })
            }
            Shape::Mesh { .. } => return false,
        };
        let (w, h) = (self.width - 1, self.height - 1);
        [(0, 0), (w, 0), (0, h), (w, h), (w / 2, h / 2)]
            .into_iter()
            .any(|(x, y)| leave(self.rays.step(x, y)) >= self.rays.near)
    }
}
