//! Flat parts among the points of a voxel.

use glam::DVec3;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

use super::plane::{Moments, Plane, Spread};

/// The fewest points of a facet.
const FEWEST: usize = 12;
/// The most facets of a voxel: as many as meet in the corner of a room.
const MOST: usize = 3;
/// Planes through three points that are tried for each. If a third of the points are of one facet,
/// all tries miss it once in three times, and one of a half once in 70.
const TRIES: usize = 32;
/// How often a plane is fitted to the points near it: which these are changes with it.
const FITS: usize = 8;
/// How far points of a facet lie off it at most, in cells: both sides of a thin board are one.
const NEAR: f64 = 1.0;
/// The deviation of points from a plane, in cells, below which they are a surface in any case:
/// points spread evenly over the distance have 0.58.
const THIN: f64 = 0.35;
/// Of points that spread farther, the most that lie up to twice as far off the plane, over those
/// near it: for points that fill the voxel they are as many, and half as many where these end.
const BESIDE: f64 = 0.25;

/// Points of a voxel that lie near a plane.
#[derive(Clone, Copy)]
pub(super) struct Facet {
    pub spread: Spread,
    pub plane: Plane,
}

/// The facets of points relative to the middle of their voxel, in cells: the plane that has most
/// points near it, then the one that has most of the others (random samples: Fischler & Bolles
/// 1981). The same for the same `seed`.
pub(super) fn facets(mut points: Vec<DVec3>, middle: DVec3, cell: f64, seed: [u32; 3]) -> Vec<Facet> {
    let seed =
        seed.into_iter().fold(0_u64, |sum, i| (sum ^ u64::from(i)).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut found = Vec::new();
    while points.len() >= FEWEST && found.len() < MOST {
        let Some(first) = best(&points, &mut random) else { break };
        let fit = |plane: Plane| {
            let near = points.iter().filter(|p| plane.distance(**p).abs() <= NEAR);
            let mut moments = Moments::default();
            near.for_each(|p| moments.add(p.as_vec3()));
            let spread = (moments.count as usize >= FEWEST).then(|| moments.about(DVec3::ZERO))?;
            Some((spread, Plane::fit(&spread, 1.0)?))
        };
        let mut fits = fit(first);
        for _ in 1..FITS {
            fits = fits.and_then(|(_, plane)| fit(plane));
        }
        let Some((spread, plane)) = fits else { break };
        let distances = || points.iter().map(|p| plane.distance(*p).abs());
        let inner = distances().filter(|&d| d <= NEAR).count() as f64;
        let outer = distances().filter(|&d| d > NEAR && d <= 2.0 * NEAR).count() as f64;
        if plane.variance > THIN * THIN && outer > BESIDE * inner {
            break;
        }
        points.retain(|p| plane.distance(*p).abs() > NEAR);
        found.push(Facet { spread: spread.placed(middle, cell), plane: plane.placed(middle, cell) });
    }
    found
}

/// The plane through three of the points that has most of them near it, nearer ones counted more
/// (MSAC: Torr & Zisserman 2000): one aslant through both sides of a board has more than one along
/// a side, but farther ones.
fn best(points: &[DVec3], random: &mut Pcg64Mcg) -> Option<Plane> {
    let mut best = (0.0, None);
    for _ in 0..TRIES {
        let [a, b, c] = std::array::from_fn(|_| points[random.next_u32() as usize % points.len()]);
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
        let plane = Plane { mean: a, normal, variance: 0.0 };
        let near = |p: &DVec3| (1.0 - (plane.distance(*p) / NEAR).powi(2)).max(0.0);
        let score: f64 = points.iter().map(near).sum();
        if score > best.0 {
            best = (score, Some(plane));
        }
    }
    best.1
}
