//! Ray-cast depth.

use std::time::Duration;

use fearless_simd::dispatch;
use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::{Ray, RayHit};

use super::DepthPyramid;
use super::models::Models;
use super::screen::{Boxes, Screen};
use casca_scenes::world::{Camera, Motion, Object, Shape};

/// A part of an object that a ray can hit.
#[derive(Debug, Clone, Copy)]
pub(super) enum Part {
    Sphere { center: Vec3A, radius: f32 },
    Box { min: Vec3A, max: Vec3A },
    Triangle([Vec3A; 3]),
}

/// A depth buffer of one ray a pixel.
///
/// The hierarchy over static occluders is built once; the one over moving ones is built
/// in each frame, quickly.
pub struct RayBuffer {
    depth: DepthPyramid,
    fixed: (Bvh2, Vec<Part>),
    models: Models,
    boxes: Boxes,
    order: Vec<u64>,
}

pub(super) fn parts(object: &Object, out: &mut Vec<Part>) {
    match &object.shape {
        Shape::Sphere { center, radius } => {
            out.push(Part::Sphere { center: (*center).into(), radius: *radius });
        }
        Shape::Box { min, max } => out.push(Part::Box { min: (*min).into(), max: (*max).into() }),
        Shape::Mesh { mesh, transform } => {
            let at = |v: u32| transform.transform_point3a(mesh.positions[v as usize].into());
            let hiding = mesh.hiding().map(|(triangles, _)| triangles).unwrap_or_default();
            out.extend(hiding.iter().map(|t| Part::Triangle(t.map(at))));
        }
    }
}

pub(super) fn tree(parts: Vec<Part>, params: BvhBuildParams) -> (Bvh2, Vec<Part>) {
    let boxes: Vec<Aabb> = parts
        .iter()
        .map(|part| match *part {
            Part::Sphere { center, radius } => Aabb { min: center - radius, max: center + radius },
            Part::Box { min, max } => Aabb { min, max },
            Part::Triangle([a, b, c]) => Aabb { min: a.min(b).min(c), max: a.max(b).max(c) },
        })
        .collect();
    if boxes.is_empty() {
        return (Bvh2::default(), parts);
    }
    let bvh = build_bvh2(&boxes, params, &mut Duration::default());
    let sorted = bvh.primitive_indices.iter().map(|&i| parts[i as usize]).collect();
    (bvh, sorted)
}

impl Part {
    /// Where a ray enters from outside; infinity if it does not.
    pub(super) fn hit(&self, ray: &Ray) -> f32 {
        match *self {
            Self::Sphere { center, radius } => {
                let to = center - ray.origin;
                let along = to.dot(ray.direction);
                let outside = to.length_squared() - radius * radius;
                let rest = along * along - outside;
                if outside > 0.0 && along > 0.0 && rest >= 0.0 { along - rest.sqrt() } else { f32::INFINITY }
            }
            Self::Box { min, max } => {
                let (a, b) = ((min - ray.origin) * ray.inv_direction, (max - ray.origin) * ray.inv_direction);
                let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
                if enter > 0.0 && enter <= leave { enter } else { f32::INFINITY }
            }
            Self::Triangle([a, b, c]) => {
                let (e, f) = (b - a, c - a);
                let p = ray.direction.cross(f);
                let inverse = 1.0 / e.dot(p);
                let s = ray.origin - a;
                let u = s.dot(p) * inverse;
                let q = s.cross(e);
                let v = ray.direction.dot(q) * inverse;
                let t = f.dot(q) * inverse;
                if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 { t } else { f32::INFINITY }
            }
        }
    }
}

impl RayBuffer {
    /// A buffer of `width` by `height` rays for a scene.
    pub fn new(objects: &[Object], width: usize, height: usize) -> Self {
        let mut fixed = Vec::new();
        for object in objects.iter().filter(|o| o.occludes && o.motion == Motion::Static) {
            parts(object, &mut fixed);
        }
        let params = BvhBuildParams::medium_build();
        Self {
            depth: DepthPyramid::new(width, height),
            fixed: tree(fixed, params),
            models: Models::default(),
            boxes: Boxes::default(),
            order: Vec::new(),
        }
    }

    /// The buffer as the last frame left it.
    pub fn depth(&self) -> &DepthPyramid {
        &self.depth
    }

    /// Which of the objects given are visible, front to back.
    pub fn frame(&mut self, objects: &[Object], in_frustum: &[usize], camera: &Camera) -> Vec<usize> {
        let (width, height) = (self.depth.width(), self.depth.height());
        let screen = Screen::new(camera, width, height);
        let mut moving = Vec::new();
        for &i in in_frustum {
            if objects[i].occludes && objects[i].motion != Motion::Static {
                parts(&objects[i], &mut moving);
            }
        }
        let moving = tree(moving, BvhBuildParams::fastest_build());
        let matrix = camera.view_projection();
        let inverse = matrix.inverse();
        let forward = Vec3A::from(matrix.row(3).truncate());
        let eye = camera.eye;
        let direction = |x: f32, y: f32| {
            let clip = Vec3::new(x / width as f32 * 2.0 - 1.0, 1.0 - y / height as f32 * 2.0, 0.5);
            inverse.project_point3(clip) - eye
        };
        // Directions are linear in the pixel on a plane of equal depth.
        let corner = direction(0.5, 0.5);
        let scaled = |d: Vec3| d / Vec3::from(forward).dot(d);
        let origin = scaled(corner);
        let across = (scaled(direction(width as f32 - 0.5, 0.5)) - origin) / (width as f32 - 1.0).max(1.0);
        let down = (scaled(direction(0.5, height as f32 - 0.5)) - origin) / (height as f32 - 1.0).max(1.0);
        self.depth.clear();
        for y in 0..height {
            let start = origin + down * y as f32;
            for x in 0..width {
                let d = Vec3A::from(start + across * x as f32);
                let length = d.length();
                let (way, mut first) = (d / length, f32::INFINITY);
                for (bvh, parts) in [&self.fixed, &moving] {
                    // Far from the origin, single precision may tell no direction.
                    if parts.is_empty() || !way.is_finite() {
                        continue;
                    }
                    let ray = Ray::new(eye.into(), way, 0.0, f32::MAX);
                    bvh.ray_traverse(ray, &mut RayHit::none(), |_, i| {
                        let t = parts[i].hit(&ray);
                        first = first.min(t);
                        t
                    });
                }
                // d has depth 1.
                self.depth.set(x, y, length / first);
            }
        }
        let Self { depth, models, boxes, order, .. } = self;
        models.of_scene(objects);
        boxes.fill(in_frustum.iter().map(|&i| models.bounds(i, &objects[i].shape)));
        dispatch!(depth.level(), simd => {
            boxes.project(simd, &screen);
            boxes.front_to_back(order);
            let numbers = order.iter().map(|&key| key as u32 as usize);
            let open = numbers.filter(|&n| !depth.hides_in(simd, &boxes.rects[n]));
            open.map(|n| in_frustum[n]).collect()
        })
    }
}
