//! Scans of scenes as terrestrial scanners make them: rays on a grid of angles from some places,
//! with noise, mixed pixels and strays. Constants of `surface` were chosen on those called tuned.

use crate::scenes::{self, Scene};
use crate::truth::{Mesh, Samples};
use glam::{Vec3, vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f32::consts::{PI, TAU};

/// A scene, and how it is scanned.
pub struct Plan {
    pub scene: Scene,
    from: Vec<Vec3>,
    /// The angle between rays, in degrees.
    step: f32,
    /// The deviation of ranges, in metres.
    noise: f32,
    /// Points between two surfaces, and in the air or behind walls, as parts of all points.
    pub mixed: f32,
    pub strays: f32,
}

/// What a scanner delivers, and where it met the surfaces: a point of no surface has none.
pub struct Scan {
    pub points: Vec<Vec3>,
    /// Of the surfaces, towards the scanner; of other points as a program might estimate them.
    pub normals: Vec<Vec3>,
    pub real: Vec<bool>,
    pub samples: Samples,
}

/// How high and low scanners see, in parts of a half turn from straight up.
const HEIGHTS: [f32; 2] = [0.0, 0.85];

/// A beam is so wide, as a part of the angle between rays; where it meets two surfaces farther
/// apart than this part of their range, pixels may be mixed.
const BEAM: f32 = 1.0;
const EDGE: f32 = 0.02;

/// The parts of strays that are alone in the air, and in groups of [`GROUP`] (insects, drops);
/// others are behind surfaces, as reflections are.
const ALONE: f32 = 0.5;
const GROUPED: f32 = 0.2;
const GROUP: usize = 4;
const GROUP_SIZE: f32 = 0.05;
/// The nearest stray, in metres.
const NEAREST: f32 = 0.6;

pub fn tuned(seed: u64) -> Vec<Plan> {
    let garden = vec![vec3(-1.0, 1.6, 2.5), vec3(4.5, 1.6, -5.0)];
    let office = vec![vec3(-2.5, 1.5, 0.6), vec3(2.6, 1.5, 0.8)];
    vec![
        plan(scenes::garden(seed), garden, [0.5, 0.004, 0.056, 0.010]),
        plan(scenes::office(seed), office, [0.6, 0.002, 0.007, 0.003]),
    ]
}

pub fn held_out(seed: u64) -> Vec<Plan> {
    vec![
        plan(scenes::plant(seed), vec![vec3(2.0, 1.4, 5.0), vec3(-3.0, 1.7, 5.5)], [0.3, 0.003, 0.03, 0.004]),
        plan(scenes::grove(seed), vec![vec3(2.0, 1.7, -2.0)], [0.4, 0.005, 0.04, 0.01]),
        plan(scenes::garden(seed + 1), vec![vec3(-2.0, 1.6, -1.0)], [0.35, 0.003, 0.056, 0.010]),
    ]
}

fn plan(scene: Scene, from: Vec<Vec3>, [step, noise, mixed, strays]: [f32; 4]) -> Plan {
    Plan { scene, from, step, noise, mixed, strays }
}

/// Scans a scene.
pub fn scan(plan: &Plan) -> Scan {
    let mut random = Pcg64Mcg::seed_from_u64(23);
    let mesh = Mesh::new(&plan.scene.triangles);
    let step = plan.step.to_radians();
    // The scanner, direction, range and triangle of each ray, and the ranges of two surfaces.
    let (mut rays, mut edges) = (Vec::new(), Vec::new());
    for &from in &plan.from {
        let turn = random.random_range(0.0..step);
        for row in (HEIGHTS[0] * PI / step) as usize..(HEIGHTS[1] * PI / step) as usize {
            for column in 0..(TAU / step) as usize {
                let way = |dx: f32, dy: f32| {
                    let ((sin, cos), (y, x)) = (
                        ((row as f32 + 0.5 + dy) * step).sin_cos(),
                        ((column as f32 + dx) * step + turn).sin_cos(),
                    );
                    vec3(sin * x, cos, sin * y)
                };
                let Some((range, triangle)) = mesh.first(from, way(0.0, 0.0)) else { continue };
                let half = BEAM / 2.0;
                let beam = [(half, 0.0), (-half, 0.0), (0.0, half), (0.0, -half)];
                let ranges = beam.map(|(dx, dy)| mesh.first(from, way(dx, dy)).map_or(range, |hit| hit.0));
                let other = ranges.into_iter().max_by(|a, b| (a - range).abs().total_cmp(&(b - range).abs()));
                let other = other.unwrap_or(range);
                // On one surface the other side is as far away in the other direction.
                let bend = ranges.iter().sum::<f32>() / 4.0 - range;
                if bend.abs() > EDGE * range / 4.0 && (other - range).abs() > EDGE * range {
                    edges.push((rays.len(), other));
                }
                rays.push((from, way(0.0, 0.0), range, triangle));
            }
        }
    }
    let all = rays.len() as f32;
    let mut mixed = vec![0.0; rays.len()];
    let chance = plan.mixed * all / edges.len().max(1) as f32;
    for (i, other) in edges {
        if random.random::<f32>() < chance {
            mixed[i] = (other - rays[i].2) * random.random_range(0.1..0.9);
        }
    }
    let mut noise = || plan.noise * ((0..12).map(|_| random.random::<f32>()).sum::<f32>() - 6.0);
    let samples = Samples { points: Vec::new(), normals: Vec::new(), triangle: Vec::new() };
    let mut scan = Scan { points: Vec::new(), normals: Vec::new(), real: Vec::new(), samples };
    for (&(from, way, range, triangle), mixed) in rays.iter().zip(mixed) {
        let at = from + way * range;
        let [a, b, c] = plan.scene.triangles[triangle as usize];
        let normal = (b - a).cross(c - a).normalize();
        scan.samples.points.push(at);
        scan.samples.normals.push(normal);
        scan.samples.triangle.push(triangle);
        scan.points.push(at + way * (mixed + noise()));
        scan.normals.push(if mixed == 0.0 { normal * -normal.dot(way).signum() } else { -way });
        scan.real.push(mixed == 0.0);
    }
    let count = (plan.strays * all) as usize;
    while scan.points.len() < rays.len() + count {
        let (from, way, range, _) = rays[random.random_range(0..rays.len())];
        let kind = random.random::<f32>();
        let behind = kind > ALONE + GROUPED;
        let far = if behind {
            range * random.random_range(1.1..1.6)
        } else {
            random.random_range(0.1..0.95) * range
        };
        let size = if (ALONE..ALONE + GROUPED).contains(&kind) { GROUP } else { 1 };
        for _ in 0..size {
            let off = Vec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0))) * GROUP_SIZE;
            let at = from + way * far.max(NEAREST) + if size > 1 { off } else { Vec3::ZERO };
            scan.samples.points.push(at);
            scan.samples.normals.push(-way);
            scan.samples.triangle.push(u32::MAX);
            scan.points.push(at);
            scan.normals.push(-way);
            scan.real.push(false);
        }
    }
    scan
}
