//! Growing patches: triangles gathered around large ones.

use glam::DVec3;

use crate::mesh::surface::patch::{NONE, Rules};
use crate::mesh::surface::weld::Welded;

/// How far a patch may rise above the plane of its first triangle, for each unit of distance from its middle.
const SLOPE: f64 = 0.35;

/// Patches of triangles before they are gathered.
pub(crate) struct Patches {
    /// The patch of each triangle, and whether the triangle is turned over in it.
    pub(crate) of: Vec<(u32, bool)>,
    /// The cross product of two sides of each triangle as wound.
    pub(crate) crosses: Vec<DVec3>,
    /// Direction of the first triangle of each.
    pub(crate) normals: Vec<DVec3>,
}

/// The greatest angle in a patch without parts, in degrees.
const FLAT: f64 = 10.0;

impl Patches {
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
    let crosses: Vec<DVec3> = (0..count)
        .map(|t| {
            let [a, b, c] = mesh.corners(t);
            (b - a).cross(c - a)
        })
        .collect();
    let mut order: Vec<u32> = (0..count as u32).collect();
    let area = |t: u32| crosses[t as usize].length_squared();
    order.sort_by(|&a, &b| area(b).total_cmp(&area(a)).then(a.cmp(&b)));
    let mut of = vec![(NONE, false); count];
    let mut normals = Vec::new();
    let mut queue = Vec::new();
    for seed in order {
        if of[seed as usize].0 != NONE {
            continue;
        }
        let patch = normals.len() as u32;
        let normal = crosses[seed as usize].normalize_or(DVec3::Z);
        let corners = mesh.corners(seed as usize);
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let cosine = rules.cosine.max(FLAT.to_radians().cos());
        let seed_plane = Seed { middle, normal, cosine, tolerance: rules.tolerance };
        normals.push(normal);
        of[seed as usize] = (patch, false);
        queue.clear();
        queue.push(seed);
        let mut at = 0;
        while at < queue.len() {
            let t = queue[at] as usize;
            at += 1;
            for side in 0..3 {
                let beside = mesh.at_edge(mesh.sides[t][side]);
                let [one, two] = beside else { continue };
                let (own, other) = if one.2 as usize == t { (one, two) } else { (two, one) };
                let next = other.2 as usize;
                if of[next].0 != NONE {
                    continue;
                }
                // Two triangles wound alike run their edge in opposite directions.
                let turned = of[t].1 ^ (own.3 == other.3);
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
    Patches { of, crosses, normals }
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
        let flat = corners.iter().all(|&p| {
            let d = p - self.middle;
            self.normal.dot(d).abs() <= self.tolerance + SLOPE * d.length()
        });
        flat && cross.dot(self.normal) >= self.cosine * cross.length()
    }
}
