//! Scans of scenes as terrestrial scanners make them: rays on a grid of angles from some places,
//! with noise, mixed pixels and strays. Constants of `surface` were chosen on those called tuned.

use crate::gauss;
use crate::scenes::Scene;
use crate::truth::{Mesh, Sample, normal};
use glam::{Vec3, vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f32::consts::{PI, TAU};

/// A scene, the places of scanners, and numbers: the angle between rays, in degrees, the deviation and the
/// steps of ranges, in metres, and points between two surfaces, and in the air or behind walls, as parts of all
/// points.
pub type Plan = (Scene, Vec<Vec3>, [f32; 5]);

/// How low scanners see, in parts of a half turn from straight up.
const LOWEST: f32 = 0.85;

/// Where a beam, as wide as the angle between rays, meets two surfaces farther apart than this part
/// of their range, pixels may be mixed.
const EDGE: f32 = 0.02;

/// The parts of strays that are alone in the air, and in groups of [`GROUP`] (insects, drops);
/// others are behind surfaces, as reflections are.
const ALONE: f32 = 0.5;
const GROUPED: f32 = 0.2;
const GROUP: usize = 4;
const GROUP_SIZE: f32 = 0.05;
/// The nearest stray, in metres.
const NEAREST: f32 = 0.6;

/// What scanners deliver. Normals are towards them; those of points of no surface as a program might
/// estimate them.
pub fn scan((scene, scanners, [step, noise, rounded, mixed, strays]): &Plan) -> Vec<Sample> {
    let mut random = Pcg64Mcg::seed_from_u64(23);
    let mesh = Mesh::new(&scene.triangles);
    let step = step.to_radians();
    // The scanner, direction, range and triangle of each ray, and the ranges of two surfaces.
    let (mut rays, mut edges) = (Vec::new(), Vec::new());
    for &from in scanners {
        let turn = random.random_range(0.0..step);
        for row in 0..(LOWEST * PI / step) as usize {
            for column in 0..(TAU / step) as usize {
                let way = |dx: f32, dy: f32| {
                    let (sin, cos) = ((row as f32 + 0.5 + dy) * step).sin_cos();
                    let (y, x) = ((column as f32 + dx) * step + turn).sin_cos();
                    vec3(sin * x, cos, sin * y)
                };
                let Some((range, triangle)) = mesh.first(from, way(0.0, 0.0)) else { continue };
                let beam = [(0.5, 0.0), (-0.5, 0.0), (0.0, 0.5), (0.0, -0.5)];
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
    let mut off = vec![0.0; rays.len()];
    let chance = mixed * all / edges.len().max(1) as f32;
    for (i, other) in edges {
        if random.random::<f32>() < chance {
            off[i] = (other - rays[i].2) * random.random_range(0.1..0.9);
        }
    }
    let mut scan = Vec::new();
    for (&(from, way, range, triangle), off) in rays.iter().zip(off) {
        let place = from + way * range;
        let far = range + off + noise * gauss(&mut random);
        let at = from + way * if rounded > &0.0 { (far / rounded).round() * rounded } else { far };
        let front = normal(scene.triangles[triangle as usize]);
        let normal = if off == 0.0 { front * -front.dot(way).signum() } else { -way };
        scan.push(Sample { at, normal, place, triangle: Some(triangle).filter(|_| off == 0.0) });
    }
    let count = (strays * all) as usize;
    while scan.len() < rays.len() + count {
        let (from, way, range, _) = rays[random.random_range(0..rays.len())];
        let kind = random.random::<f32>();
        let part = if kind > ALONE + GROUPED { 1.1..1.6 } else { 0.1..0.95 };
        let far = range * random.random_range(part);
        let size = if (ALONE..ALONE + GROUPED).contains(&kind) { GROUP } else { 1 };
        for _ in 0..size {
            let off = Vec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0))) * GROUP_SIZE;
            let at = from + way * far.max(NEAREST) + if size > 1 { off } else { Vec3::ZERO };
            scan.push(Sample { at, normal: -way, place: at, triangle: None });
        }
    }
    scan
}
