//! Facets grown into flat patches.

use glam::DVec3;

use super::axes::axes;
use super::facets::Facet;
use super::plane::Plane;
use super::voxels::Voxels;

/// The least cosine between the planes of a facet and of its patch: 14 degrees.
const ALIKE: f64 = 0.97;
/// The greatest distance of the mean of a facet from the plane of its patch, in cells.
const BESIDE: f64 = 1.0;
/// The fewest facets of a patch.
const FEWEST: usize = 3;

/// A flat patch: a place on its plane, and a frame whose third axis is the normal.
pub(super) struct Patch {
    pub middle: DVec3,
    pub axes: [DVec3; 3],
    pub facets: Vec<u32>,
}

/// All patches. Each facet is in one of them at most.
pub(super) fn grow(voxels: &Voxels) -> Vec<Patch> {
    let mut seeds: Vec<u32> = (0..voxels.facets.len() as u32).collect();
    let variance = |i: u32| voxels.facets[i as usize].plane.variance;
    seeds.sort_by(|&a, &b| variance(a).total_cmp(&variance(b)));
    let mut taken = vec![false; voxels.facets.len()];
    let mut patches = Vec::new();
    for seed in seeds {
        if taken[seed as usize] {
            continue;
        }
        let (plane, facets) = patch(voxels, seed, &mut taken);
        if facets.len() >= FEWEST {
            let means: Vec<DVec3> = facets.iter().map(|&i| voxels.facets[i as usize].plane.mean).collect();
            patches.push(Patch { middle: plane.mean, axes: axes(plane.normal, &means), facets });
        }
    }
    patches
}

/// Grows one patch from a facet. The plane is fitted anew each time that the patch has doubled.
fn patch(voxels: &Voxels, seed: u32, taken: &mut [bool]) -> (Plane, Vec<u32>) {
    let mut members = vec![seed];
    taken[seed as usize] = true;
    let Facet { mut spread, mut plane } = voxels.facets[seed as usize];
    let (mut next, mut fit_at) = (0, 2);
    while let Some(&member) = members.get(next) {
        next += 1;
        for other in voxels.around(member).flat_map(|voxel| voxels.facets_of(voxel)) {
            let its = &voxels.facets[other as usize];
            let alike = its.plane.normal.dot(plane.normal).abs() >= ALIKE;
            if !taken[other as usize] && alike && plane.distance(its.plane.mean).abs() <= BESIDE * voxels.cell
            {
                taken[other as usize] = true;
                members.push(other);
                spread = spread.with(&its.spread);
            }
        }
        if members.len() >= fit_at {
            fit_at = 2 * members.len();
            plane = Plane::fit(&spread, voxels.cell).unwrap_or(plane);
        }
    }
    (Plane::fit(&spread, voxels.cell).unwrap_or(plane), members)
}
