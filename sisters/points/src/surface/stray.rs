//! Points that are on no surface: mixed pixels, which are between two surfaces as a beam met both,
//! dust, and reflections. Alone they would have discs as large as the gaps around them.
//!
//! The more thinly points are spread than those of the surfaces around, the more neighbours must be
//! on one plane with them: a wall that is seen at a low angle has them, dust does not.

use super::disc::Margins;
use super::plane::{Input, Near};
use crate::spacing::{Neighbours, quantile};
use glam::Vec3A;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// The neighbour whose distance tells how thinly points are spread: beyond a small group of strays.
const RANK: usize = 8;
/// How thin is usual is told by some of the nearest of a sample of all points, one of so many: the
/// nearest of all would be other strays where these are many, as around a scanner.
const SAMPLED: usize = 64;
const AROUND: u32 = 16;
/// Smaller samples are useless.
const LEAST_SAMPLE: usize = 64;
/// The least cosine of the normals of points that support each other, and how far away they are at
/// most, in distances of the neighbour of that rank.
const TURN: f32 = 0.8;
const FAR: f32 = 3.0;

// Chosen on the scans that the example `accuracy` calls tuned, such that samples of clean meshes
// keep their points: where points are spread by a third more thinly than usual none need support.
/// How many neighbours on its plane a point needs: so many more as its distances are larger than
/// usual, less these, and at most.
const NEEDED: f32 = 3.0;
const SPARED: f32 = 4.0;
const ENOUGH: f32 = 14.0;

/// Whether each place is on no surface. `normals` are those of planes.
pub(super) fn strays(input: &Input, normals: &[Vec3A], margins: &Margins) -> Vec<bool> {
    let (places, count) = (&input.places, input.places.len());
    let thin = |i| {
        let near = input.around(i);
        near.get(RANK - 1).or(near.last()).map_or(0.0, |near| near.length())
    };
    let thin: Vec<f32> = (0..count).into_par_iter().map(thin).collect();
    let step = (count / LEAST_SAMPLE).clamp(1, SAMPLED);
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let one = |i: usize| i + random.random_range(0..step.min(count - i));
    let sample: Vec<usize> = (0..count).step_by(step).map(one).collect();
    let tree = Neighbours::new(sample.iter().map(|&i| places[i].into()));
    let is_stray = |i: usize| {
        let supports = |(j, v): &&Near| {
            let (own, other) = (normals[i], normals[*j as usize]);
            let level = margins.layer * thin[i].max(v.length());
            let level_with = |normal: Vec3A| v.dot(normal).abs() < level;
            v.length() < FAR * thin[i] && level_with(own) && level_with(other) && own.dot(other).abs() > TURN
        };
        let support = input.near(i).iter().filter(supports).count() as f32;
        if support >= ENOUGH {
            return false;
        }
        let around = tree.of(places[i].into(), AROUND).map(|k| thin[sample[k as usize]]);
        let usual = quantile(around.collect(), 0.5);
        usual > 0.0 && support < (NEEDED * thin[i] / usual - SPARED).min(ENOUGH)
    };
    (0..count).into_par_iter().map(is_stray).collect()
}
