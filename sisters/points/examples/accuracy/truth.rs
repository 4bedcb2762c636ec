//! Points of triangles, and whether an eye sees them: by rays, in double precision.

use crate::scenes::Scene;
use glam::{DVec3, Vec3, Vec3A};
use obvhs::bvh2::{Bvh2, builder::build_bvh2};
use obvhs::ray::{Ray, RayHit};
use obvhs::{BvhBuildParams, aabb::Aabb};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::collections::HashMap;
use std::time::Duration;

/// A point, and the place on a triangle that it stands for: a point of no surface has no triangle.
pub struct Sample {
    pub at: Vec3,
    pub normal: Vec3,
    pub place: Vec3,
    pub triangle: Option<u32>,
}

pub fn normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a).normalize()
}

/// Samples of triangles: each piece of area is as likely as any other, but points keep a distance
/// from each other.
pub fn sample(scene: &Scene, count: usize) -> Vec<Sample> {
    let mut random = Pcg64Mcg::seed_from_u64(11);
    let (mut sum, mut areas) = (0.0, Vec::new());
    for [a, b, c] in &scene.triangles {
        sum += f64::from((b - a).cross(c - a).length()) / 2.0;
        areas.push(sum);
    }
    let distance = 0.75 * (sum / count as f64).sqrt() as f32;
    let mut cells: HashMap<[i32; 3], Vec<Vec3>> = HashMap::new();
    let mut samples = Vec::new();
    for _ in 0..count * 15 {
        if samples.len() == count {
            break;
        }
        let at = random.random_range(0.0..sum);
        let triangle = areas.partition_point(|&area| area <= at).min(areas.len() - 1);
        let [a, b, c] = scene.triangles[triangle];
        let (mut u, mut v) = (random.random::<f32>(), random.random::<f32>());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let point = a + (b - a) * u + (c - a) * v;
        let cell = (point / distance).floor().as_ivec3();
        let near = (0..27).any(|i| {
            let cell = [cell.x + i % 3 - 1, cell.y + i / 3 % 3 - 1, cell.z + i / 9 - 1];
            cells.get(&cell).is_some_and(|points| points.iter().any(|p| p.distance(point) < distance))
        });
        if near {
            continue;
        }
        cells.entry(cell.to_array()).or_default().push(point);
        let normal = normal([a, b, c]);
        samples.push(Sample { at: point, normal, place: point, triangle: Some(triangle as u32) });
    }
    samples
}

/// Boxes of triangles are larger by so much, in metres: the tree finds them in single precision.
const GROWN: f32 = 1e-4;

/// The share of a segment at its end that crosses nothing: the point lies on its own surface there.
const END: f64 = 1e-5;

/// The triangles of a scene, ready for rays.
pub struct Mesh<'a> {
    triangles: &'a [[Vec3; 3]],
    tree: Bvh2,
}

impl<'a> Mesh<'a> {
    pub fn new(triangles: &'a [[Vec3; 3]]) -> Self {
        let bounds = |t: &[Vec3; 3]| {
            let [a, b, c] = t.map(Vec3A::from);
            Aabb { min: a.min(b).min(c) - GROWN, max: a.max(b).max(c) + GROWN }
        };
        let bounds: Vec<Aabb> = triangles.iter().map(bounds).collect();
        let tree = build_bvh2(&bounds, BvhBuildParams::medium_build(), &mut Duration::default());
        Self { triangles, tree }
    }

    /// The first triangle that a ray meets, and how far away that is.
    pub fn first(&self, from: Vec3, direction: Vec3) -> Option<(f32, u32)> {
        let (mut hit, (start, step)) = (RayHit::none(), (from.as_dvec3(), direction.as_dvec3()));
        let triangle = |k: u32| self.tree.primitive_indices[k as usize];
        self.tree.ray_traverse(Ray::new_inf(from.into(), direction.into()), &mut hit, |_, k| {
            crosses(start, step, self.triangles[triangle(k as u32) as usize])
                .map_or(f32::INFINITY, |far| far as f32)
        });
        hit.t.is_finite().then(|| (hit.t, triangle(hit.primitive_id)))
    }

    /// Whether `eye` sees each point: no triangle but those that are its own is between them.
    pub fn seen(&self, points: &[Vec3], eye: Vec3, own: impl Fn(usize, u32) -> bool + Sync) -> Vec<bool> {
        let is_seen = |(i, &point): (usize, &Vec3)| {
            let (from, step) = (eye.as_dvec3(), (point - eye).as_dvec3());
            let ray = Ray::new(eye.into(), (point - eye).into(), 0.0, 1.0);
            let mut hidden = false;
            self.tree.ray_traverse_miss(ray, |_, k| {
                let t = self.tree.primitive_indices[k];
                hidden |= !own(i, t)
                    && crosses(from, step, self.triangles[t as usize]).is_some_and(|far| far < 1.0 - END);
                if hidden { f32::NEG_INFINITY } else { f32::INFINITY }
            });
            !hidden
        };
        points.par_iter().enumerate().map(is_seen).collect()
    }
}

/// Where a ray meets a triangle (Möller & Trumbore 1997), in steps from its start.
fn crosses(from: DVec3, step: DVec3, triangle: [Vec3; 3]) -> Option<f64> {
    let [a, b, c] = triangle.map(|p| p.as_dvec3());
    let (u, v) = (b - a, c - a);
    let p = step.cross(v);
    let det = u.dot(p);
    if det == 0.0 {
        return None;
    }
    let t = from - a;
    let q = t.cross(u);
    let (x, y, z) = (t.dot(p) / det, step.dot(q) / det, v.dot(q) / det);
    (x >= 0.0 && y >= 0.0 && x + y <= 1.0 && z > 0.0).then_some(z)
}
