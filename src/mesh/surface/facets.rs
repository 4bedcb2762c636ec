//! The triangles of patches in the order of the patches, to be read again and again while groups
//! grow.

use glam::{DVec3, Vec3};

use crate::mesh::lists::Lists;
use crate::mesh::surface::grow::{Patches, Seed};
use crate::mesh::surface::weld::Welded;

/// The triangles of all patches. Patches stand in the order of
/// their first triangles: those of a group mostly lie together.
pub(super) struct Facets {
    /// Where the triangles of each patch start and end, and then its points.
    ranges: Vec<[u32; 4]>,
    /// The cross product of two sides of each triangle, as it is wound in its patch, and its
    /// length.
    crosses: Vec<(DVec3, f64)>,
    /// The corners of triangles, once for each patch.
    points: Vec<Vec3>,
}

impl Facets {
    pub(super) fn new(mesh: &Welded, grown: &Patches) -> Self {
        let count = grown.seeds.len();
        let all = grown.of.iter().zip(0u32..);
        let own = Lists::new(count, all.clone().map(|(of, t)| (of.0, t)));
        let mut facets =
            Self { ranges: vec![[0; 4]; count], crosses: Vec::with_capacity(own.len()), points: Vec::new() };
        // For each vertex, the last patch that it was taken for, and one.
        let mut taken = vec![0u32; mesh.positions.len()];
        for patch in all.map(|(of, _)| of.0) {
            if facets.ranges[patch as usize][1] > 0 {
                continue;
            }
            let triangles = own.of(patch);
            let (start, from) = (facets.crosses.len(), facets.points.len());
            let crosses = triangles.iter().map(|&t| grown.cross(t));
            facets.crosses.extend(crosses.map(|cross| (cross, cross.length())));
            // The last of equal corners counts: which zero bounds a box depends on the order.
            for &v in triangles.iter().flat_map(|&t| &mesh.triangles[t as usize]).rev() {
                if std::mem::replace(&mut taken[v as usize], patch + 1) != patch + 1 {
                    facets.points.push(mesh.positions[v as usize]);
                }
            }
            facets.points[from..].reverse();
            let ends = [start, facets.crosses.len(), from, facets.points.len()];
            facets.ranges[patch as usize] = ends.map(|end| end as u32);
        }
        facets
    }

    /// The cross products of a patch's triangles, with their lengths.
    pub(super) fn crosses(&self, patch: u32) -> &[(DVec3, f64)] {
        let [first, last, ..] = self.ranges[patch as usize];
        &self.crosses[first as usize..last as usize]
    }

    /// The corners of a patch's triangles.
    pub(super) fn points(&self, patch: u32) -> &[Vec3] {
        let [.., first, last] = self.ranges[patch as usize];
        &self.points[first as usize..last as usize]
    }

    /// Whether all triangles of a patch are of the group that grows from a seed.
    pub(super) fn fit(&self, patch: u32, seed: &Seed) -> bool {
        self.crosses(patch).iter().all(|(cross, length)| seed.is_along(*cross, *length))
            && self.points(patch).iter().all(|p| seed.is_near(p.as_dvec3()))
    }
}
