//! The fewest errors of discs of one size: with the true normals, and the radius chosen with the
//! truth at hand.

use crate::scenes::Scene;
use crate::truth::Samples;
use bitvec::vec::BitVec;
use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::Ray;
use rayon::prelude::*;
use std::time::Duration;

/// The radii that are tried, in spacings.
const RADII: usize = 40;
const STEP: f32 = 0.05;

/// Points nearer to the plane of a disc than this part of a spacing are on its face.
const SAME_FACE: f32 = 1e-3;

/// Truly visible, false visible and false hidden points from all eyes, and the radius in spacings.
pub fn best(scene: &Scene, samples: &Samples, truths: &[BitVec]) -> ([f64; 3], f32) {
    let largest = RADII as f32 * STEP * samples.spacing;
    let bounds: Vec<Aabb> = samples
        .points
        .iter()
        .map(|&p| Aabb { min: Vec3A::from(p) - largest, max: Vec3A::from(p) + largest })
        .collect();
    let tree = build_bvh2(&bounds, BvhBuildParams::fast_build(), &mut Duration::default());
    let mut of_radius = [[0.0; 3]; RADII];
    for (&eye, truth) in scene.eyes.iter().zip(truths) {
        let hiding: Vec<f32> = (0..samples.points.len())
            .into_par_iter()
            .map(|i| {
                let faces_away = samples.normals[i].dot(samples.points[i] - eye) > 0.0;
                // It is told which points are on closed bodies and not on sheets.
                if faces_away && !truth[i] { 0.0 } else { least_that_hides(&tree, samples, eye, i) }
            })
            .collect();
        for (k, counts) in of_radius.iter_mut().enumerate() {
            let radius = (k + 1) as f32 * STEP * samples.spacing;
            for (truth, hiding) in truth.iter().by_vals().zip(&hiding) {
                let found = *hiding > radius;
                let kinds = [truth, found && !truth, truth && !found];
                counts.iter_mut().zip(kinds).for_each(|(sum, is)| *sum += f64::from(u8::from(is)));
            }
        }
    }
    let errors = |counts: &[f64; 3]| counts[1] + counts[2];
    let best = (0..RADII).min_by(|&a, &b| errors(&of_radius[a]).total_cmp(&errors(&of_radius[b])));
    let best = best.unwrap_or_default();
    (of_radius[best], (best + 1) as f32 * STEP)
}

/// The least radius of discs that hides a point.
fn least_that_hides(tree: &Bvh2, samples: &Samples, eye: Vec3, i: usize) -> f32 {
    let (point, step) = (samples.points[i], samples.points[i] - eye);
    let mut least = f32::INFINITY;
    tree.ray_traverse_miss(Ray::new(eye.into(), step.into(), 0.0, 1.0), |_, k| {
        let j = tree.primitive_indices[k] as usize;
        let (normal, at) = (samples.normals[j], samples.points[j]);
        let (above, below) = (normal.dot(eye - at), normal.dot(point - at));
        if above * below < 0.0 && below.abs() > SAME_FACE * samples.spacing {
            least = least.min(at.distance(eye + step * (above / (above - below))));
        }
        f32::INFINITY
    });
    least
}
