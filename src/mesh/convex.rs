//! Meshes that are convex solids, and so can be drawn as one shape.
//!
//! Let a closed mesh be wound alike, with normals outwards. A point that lies behind the planes of
//! all triangles sees each of them from inside: their solid angles have one sign and do not cancel,
//! so the mesh winds around the point. If no vertex lies more than `dent` before any of these
//! planes, no point of the hull of all vertices does. So the hull, made smaller by `2 dent` on all
//! sides, lies behind all planes, inside the mesh.

use glam::{DVec3, Vec3};
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::mesh::surface::key;
use crate::numeric::mesh::{DENT, HULL_ROOM};
use crate::shape::{Convex, MAX_CONVEX};

/// A convex solid inside a mesh that is closed and wound alike, and hardly smaller: `None` if it is
/// not convex or has many vertices. `outward` is 1 if normals point outwards, -1 if inwards. The
/// solid is smaller by `room` at least on all sides. Costs triangles times vertices.
pub(super) fn convex_solid(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    outward: f64,
    room: f64,
) -> Option<Convex> {
    // A convex mesh of triangles has at most twice as many of them as vertices, but some may be
    // degenerate.
    if outward == 0.0 || triangles.len() > 4 * MAX_CONVEX {
        return None;
    }
    let mut vertices: SmallVec<[u32; 96]> = triangles.iter().flatten().copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    let mut points: Vec<Vec3> = vertices.into_iter().map(|v| positions[v as usize]).collect();
    points.sort_unstable_by_key(|&p| key(p));
    points.dedup_by_key(|p| key(*p));
    if points.len() > MAX_CONVEX {
        return None;
    }
    let points: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
    let Block { min, max } = Block::around(points.iter().copied());
    let (size, largest) = ((max - min).length(), min.abs().max(max.abs()).max_element());
    let mut dent = 0.0f64;
    for t in triangles {
        let [a, b, c] = t.map(|v| positions[v as usize].as_dvec3());
        let cross = (b - a).cross(c - a) * outward;
        if cross == DVec3::ZERO {
            // It has no solid angle.
            continue;
        }
        let normal = cross.normalize();
        if !normal.is_finite() {
            return None;
        }
        let lowest = normal.dot(a).min(normal.dot(b)).min(normal.dot(c));
        let before = points.iter().map(|p| normal.dot(*p) - lowest).fold(0.0, f64::max);
        if before > DENT * size {
            return None;
        }
        dent = dent.max(before);
    }
    Convex::inside_hull(&points, 2.0 * dent + room + HULL_ROOM * largest)
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use glam::{Affine3A, Quat};

    use super::*;
    use crate::mesh::{Facing, MeshOptions, TriMesh};

    const CUBE: [[u32; 3]; 12] = [
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
    ];

    fn cube(place: impl Fn(Vec3) -> Vec3, turned: bool, facing: Facing) -> TriMesh {
        let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32);
        let positions = (0..8).map(|i| place(corner(i))).collect();
        let mut triangles = CUBE.to_vec();
        if turned {
            triangles.iter_mut().for_each(|t| t.swap(0, 1));
        }
        TriMesh::prepare(positions, triangles, &MeshOptions::default().facing(facing), &mut |_| {
            ControlFlow::Continue(())
        })
        .unwrap()
    }

    #[test]
    fn convex_meshes_are_solids_hardly_smaller_than_they_are() {
        for turned in [false, true] {
            for far in [0.0, 300.0] {
                let placement = Affine3A::from_rotation_translation(
                    Quat::from_rotation_y(0.7) * Quat::from_rotation_x(0.4),
                    Vec3::new(far, 1.0, -far),
                );
                let mesh = cube(|p| placement.transform_point3(p), turned, Facing::Both);
                let solid = mesh.convex().expect("a cube is convex");
                for i in 0..1000u32 {
                    let share = |n: u32| f64::from(i.wrapping_mul(n) >> 22) / 1023.0;
                    let p = DVec3::new(share(2_654_435_761), share(2_246_822_519), share(3_266_489_917));
                    let at = placement.transform_point3(p.as_vec3()).as_dvec3();
                    let depth = p.min(1.0 - p).min_element();
                    let inside = solid.faces.iter().all(|f| f.distance(at) >= 0.0);
                    assert!(inside || depth < 1e-3, "{p} {turned} {far}");
                    assert!(!inside || depth > -1e-6, "{p} {turned} {far}");
                }
            }
        }
    }

    #[test]
    fn dents_and_wrong_sides_make_no_solid() {
        let dented = |p: Vec3| if p == Vec3::ONE { Vec3::splat(0.6) } else { p };
        assert!(cube(dented, false, Facing::Both).convex().is_none());
        // Its triangles hide from inside only.
        assert!(cube(|p| p, true, Facing::Front).convex().is_none());
        assert!(cube(|p| p, false, Facing::Front).convex().is_some());
        let flat = |p: Vec3| p.with_z(0.0);
        assert!(cube(flat, false, Facing::Both).convex().is_none());
        // Two cubes are closed, but not convex.
        let mesh = cube(|p| p, false, Facing::Both);
        let mut positions = mesh.positions().to_vec();
        positions.extend(mesh.positions().iter().map(|&p| p + 3.0));
        let second = mesh.triangles().iter().map(|t| t.map(|v| v + 8));
        let triangles = mesh.triangles().iter().copied().chain(second).collect();
        assert!(TriMesh::new(positions, triangles).unwrap().convex().is_none());
    }
}
