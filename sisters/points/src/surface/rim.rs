//! Points on the rims of thin plates, which have too few points for planes of their own: points
//! between two parallel faces. They face away from the points of these.

use super::disc::Margins;
use super::plane::{Input, Near};
use glam::{Vec2, Vec3A};
use rayon::prelude::*;
use std::f32::consts::TAU;

// Lengths in spacings, chosen on the kinds of scenes that the example `accuracy` calls tuned.
/// How near points of the two faces are, how far above or below they may be, and the least cosine
/// of their normals with that of the plate.
const NEAR: f32 = 1.6;
const THICK: f32 = 1.0;
const PARALLEL: f32 = 0.9;
/// Neighbours whose planes are tried.
const TRIED: usize = 8;
/// How far apart the middles of the points above and below may be: on a bent surface they are on
/// different sides of the point.
const APART: f32 = 0.9;
/// A point whose plane holds so many near neighbours with normals like its own is on a face, unless
/// the cosine of its normal with that of the plate is less.
const KEPT: usize = 5;
const ACROSS: f32 = 0.3;
/// How near points count when it is sought where the plate is, and how far from the rim they count in full.
const AROUND: f32 = 2.0;
const STEP: f32 = 0.3;
/// Other points of rims count as much for a straight rim that they are nearer to than this.
const ON_LINE: f32 = 0.2;
/// The part of the points around that may be beyond the rim.
const BEYOND: f32 = 0.2;
/// Directions that are tried, beside those across lines to other points of rims.
const DIRECTIONS: usize = 32;

/// The normals of points on rims, out of their plates; none for other points. `normals` are those of planes.
pub(super) fn normals(input: &Input, normals: &[Vec3A], margins: &Margins) -> Vec<Option<Vec3A>> {
    let all = 0..normals.len();
    let of =
        |i: usize| Surroundings { near: input.near(i), normals, own: normals[i], spacing: input.spacing[i] };
    let plates: Vec<Option<Vec3A>> = all.clone().into_par_iter().map(|i| of(i).plate(margins)).collect();
    all.into_par_iter().map(|i| plates[i].and_then(|plate| of(i).outwards(plate, &plates))).collect()
}

/// The neighbours of a point.
struct Surroundings<'a> {
    near: Vec<Near>,
    /// Those of all points, and of this one.
    normals: &'a [Vec3A],
    own: Vec3A,
    spacing: f32,
}

impl Surroundings<'_> {
    /// The normal of the plate on whose rim the point is.
    fn plate(&self, margins: &Margins) -> Option<Vec3A> {
        let close = self.near.iter().take_while(|(_, v)| v.length() < NEAR * self.spacing);
        let normal = |j: u32| self.normals[j as usize];
        let (level, within) = (margins.between * self.spacing, margins.inlier * self.spacing);
        let like_own = close
            .clone()
            .filter(|(j, v)| v.dot(self.own).abs() < within && normal(*j).dot(self.own).abs() > PARALLEL);
        let is_on_face = like_own.count() >= KEPT;
        let mut best = (0, None);
        for (j, v) in close.clone().take(TRIED) {
            let plate = normal(*j);
            let own_face = is_on_face && self.own.dot(plate).abs() > ACROSS;
            if v.dot(plate).abs() < level || own_face {
                continue;
            }
            // The points above and below, and the sums of their places.
            let (mut counts, mut sums, mut beside) = ([0_i32; 2], [Vec3A::ZERO; 2], 0);
            for (_, v) in close.clone().filter(|(j, _)| normal(*j).dot(plate).abs() > PARALLEL) {
                let height = v.dot(plate);
                if height.abs() < level {
                    beside += 1;
                } else if height.abs() < THICK * self.spacing {
                    let side = usize::from(height > 0.0);
                    counts[side] += 1;
                    sums[side] += v.reject_from_normalized(plate);
                }
            }
            let score = counts[0].min(counts[1]) - beside;
            let apart = || (sums[0] / counts[0] as f32).distance(sums[1] / counts[1] as f32);
            if score > best.0 && apart() < APART * self.spacing {
                best = (score, Some(plate));
            }
        }
        best.1
    }

    /// The direction in the plane of a plate that leads out of it; none if the point seems to be within it.
    fn outwards(&self, plate: Vec3A, plates: &[Option<Vec3A>]) -> Option<Vec3A> {
        let (u, v) = plate.any_orthonormal_pair();
        let flat = |p: Vec3A| Vec2::new(p.dot(u), p.dot(v)) / self.spacing;
        // The places of points, what they count, and whether they are on rims.
        let around: Vec<(Vec2, f32, bool)> = self
            .near
            .iter()
            .filter(|(_, p)| p.dot(plate).abs() < THICK * self.spacing)
            .map(|&(j, p)| (flat(p), plates[j as usize].is_some()))
            .filter(|(p, _)| p.length() < AROUND)
            .map(|(p, rim)| (p, (1.0 - (p.length() / AROUND).powi(2)).powi(2), rim))
            .collect();
        let score = |out: Vec2| -> f32 {
            let of = |&(p, weight, rim): &(Vec2, f32, bool)| {
                let far = out.dot(p);
                let line = if rim { (1.0 - far.abs() / ON_LINE).max(0.0) } else { 0.0 };
                weight * ((-far / STEP).clamp(-1.0, 1.0) + line)
            };
            around.iter().map(of).sum()
        };
        let mut tried: Vec<Vec2> = Vec::new();
        if self.own.dot(plate).abs() < ACROSS && self.own != Vec3A::ZERO {
            // The plane of the point is that of the rim: only the side is sought.
            tried.push(flat(self.own).normalize_or_zero());
        } else {
            tried.extend((0..DIRECTIONS).map(|k| Vec2::from_angle(k as f32 * TAU / DIRECTIONS as f32)));
            let others = around.iter().filter(|(_, _, rim)| *rim);
            tried.extend(others.map(|(p, ..)| p.perp().normalize_or_zero()));
        }
        let both = tried.into_iter().flat_map(|d| [d, -d]);
        let best = both.max_by(|a, b| score(*a).total_cmp(&score(*b)))?;
        let all: f32 = around.iter().map(|(_, weight, _)| weight).sum();
        let beyond = around.iter().filter(|(p, ..)| best.dot(*p) > ON_LINE);
        let beyond: f32 = beyond.map(|(_, weight, _)| weight).sum();
        (beyond <= BEYOND * all).then(|| (u * best.x + v * best.y).try_normalize()).flatten()
    }
}
