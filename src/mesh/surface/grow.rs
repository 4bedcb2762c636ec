//! Growing patches: triangles gathered around large ones.

use glam::DVec3;

use crate::mesh::surface::patch::{NONE, Rules};
use crate::mesh::surface::weld::{Neighbour, Welded};

/// How far a patch may rise above the plane of its first triangle, for each unit of distance from
/// its middle.
const SLOPE: f64 = 0.35;

/// Patches of triangles before they are gathered.
pub(crate) struct Patches {
    /// The patch of each triangle, and whether the triangle is turned over in it.
    pub(crate) of: Vec<(u32, bool)>,
    /// The cross product of two sides of each triangle as wound.
    pub(crate) crosses: Vec<DVec3>,
    /// The first triangle of each, in order of their [ranks](Patches::rank).
    pub(crate) seeds: Vec<u32>,
}

/// The greatest angle in a patch without parts, in degrees.
const FLAT: f64 = 10.0;

impl Patches {
    /// The direction of the first triangle of a patch.
    pub(crate) fn normal(&self, patch: u32) -> DVec3 {
        direction(self.crosses[self.seeds[patch as usize] as usize])
    }

    /// Orders patches: those that grew from larger triangles come first.
    pub(crate) fn rank(&self, patch: u32) -> (u64, u32) {
        let seed = self.seeds[patch as usize];
        rank(self.crosses[seed as usize], seed)
    }

    /// The cross product of two sides of a triangle as it is wound in its patch.
    #[inline]
    pub(crate) fn cross(&self, triangle: u32) -> DVec3 {
        let cross = self.crosses[triangle as usize];
        if self.of[triangle as usize].1 { -cross } else { cross }
    }
}

/// Gathers triangles: the largest one left over takes its neighbours, and theirs, as long as their
/// directions differ little from its own.
pub(crate) fn grow(mesh: &Welded, rules: &Rules) -> Patches {
    let count = mesh.triangles.len();
    let cross = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        (b - a).cross(c - a)
    };
    let crosses: Vec<DVec3> = (0..count).map(cross).collect();
    let mut of = vec![(NONE, false); count];
    let mut seeds = Vec::new();
    let mut order: Vec<(u64, u32)> = (0..count as u32).map(|t| rank(crosses[t as usize], t)).collect();
    order.sort_unstable();
    let neighbours = mesh.neighbours();
    let mut queue = Vec::new();
    for (_, seed) in order {
        if of[seed as usize].0 != NONE {
            continue;
        }
        let patch = seeds.len() as u32;
        seeds.push(seed);
        of[seed as usize] = (patch, false);
        let normal = direction(crosses[seed as usize]);
        let corners = mesh.corners(seed as usize);
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let cosine = rules.cosine.max(FLAT.to_radians().cos());
        let seed_plane = Seed { middle, normal, cosine, tolerance: rules.tolerance };
        queue.clear();
        queue.push(seed);
        let mut at = 0;
        while at < queue.len() {
            let t = queue[at] as usize;
            at += 1;
            for (next, same_way) in neighbours[t].into_iter().filter_map(Neighbour::get) {
                let next = next as usize;
                if of[next].0 != NONE {
                    continue;
                }
                // Two triangles wound alike run their edge in opposite directions.
                let turned = of[t].1 ^ same_way;
                if turned && rules.front {
                    continue;
                }
                let cross = if turned { -crosses[next] } else { crosses[next] };
                if seed_plane.takes(mesh.corners(next), cross) {
                    of[next] = (patch, turned);
                    queue.push(next as u32);
                }
            }
        }
    }
    Patches { of, crosses, seeds }
}

/// The direction of the cross product of two sides.
fn direction(cross: DVec3) -> DVec3 {
    cross.normalize_or(DVec3::Z)
}

/// Orders triangles, the largest first. Areas are not negative, so their bits are in order.
fn rank(cross: DVec3, triangle: u32) -> (u64, u32) {
    (!cross.length_squared().to_bits(), triangle)
}

/// What the triangles of a patch have in common: a plane near which they lie.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seed {
    pub(crate) middle: DVec3,
    pub(crate) normal: DVec3,
    /// The greatest angle between the normal and triangles, as a cosine.
    pub(crate) cosine: f64,
    /// How far triangles may rise above the plane in any case.
    pub(crate) tolerance: f64,
}

impl Seed {
    /// Whether a triangle of these corners and this cross product is of the patch.
    pub(crate) fn takes(&self, corners: [DVec3; 3], cross: DVec3) -> bool {
        corners.into_iter().all(|p| self.is_near(p)) && self.is_along(cross, cross.length())
    }

    /// Whether a corner of a triangle lies near enough to the plane.
    #[inline]
    pub(crate) fn is_near(&self, corner: DVec3) -> bool {
        let d = corner - self.middle;
        let height = self.normal.dot(d).abs();
        // Most need no root.
        height <= self.tolerance || height <= self.tolerance + SLOPE * d.length()
    }

    /// Whether a triangle with this cross product, of this length, is turned little enough from the
    /// plane.
    #[inline]
    pub(crate) fn is_along(&self, cross: DVec3, length: f64) -> bool {
        cross.dot(self.normal) >= self.cosine * length
    }
}
