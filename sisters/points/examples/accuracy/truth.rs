//! Points of triangles, and whether an eye sees them: by rays, in double precision.

use crate::scenes::Scene;
use casca_scenes::world::Sides;
use casca_truth::oracle::tree::{Part, Primitive, Tree};
use glam::Vec3;
use obvhs::BvhBuildParams;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::collections::HashMap;

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

/// The share of a segment at its end that crosses nothing: the point lies on its own surface there.
const END: f64 = 1e-5;

/// The triangles of a scene, ready for rays.
pub struct Mesh(Tree);

impl Mesh {
    pub fn new(triangles: &[[Vec3; 3]]) -> Self {
        let part = |(object, t): (u32, &[Vec3; 3])| {
            let shape = Primitive::Triangle(t.map(|p| p.as_dvec3()));
            Part { shape, object, triangle: 0, sides: Sides::Both }
        };
        Self(Tree::of((0..).zip(triangles).map(part).collect(), BvhBuildParams::medium_build()))
    }

    /// The first triangle that a ray meets, and how far away that is.
    pub fn first(&self, from: Vec3, direction: Vec3) -> Option<(f32, u32)> {
        let mut best = None;
        self.0.first(from.as_dvec3(), direction.as_dvec3(), &mut best);
        best.map(|(triangle, far)| (far as f32, triangle))
    }

    /// Whether `eye` sees each point: no triangle but those that are its own is between them.
    pub fn seen(&self, points: &[Vec3], eye: Vec3, own: impl Fn(usize, u32) -> bool + Sync) -> Vec<bool> {
        let from = eye.as_dvec3();
        let is_seen = |(i, &point): (usize, &Vec3)| {
            let step = (point - eye).as_dvec3();
            let hides = |part: &Part| {
                !own(i, part.object) && part.enter(from, step, false).is_some_and(|far| far < 1.0 - END)
            };
            self.0.any(from, step, 1.0, hides).is_none()
        };
        points.par_iter().enumerate().map(is_seen).collect()
    }
}
