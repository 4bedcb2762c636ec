//! The walls of a level: faces of its boxes, and rectangles that its triangles cover.

use std::collections::BTreeMap;

use casca::glam::{Affine3A, Vec3};
use casca::{Facing, Motion, Occluder, Scene, TriMesh};

use crate::region::{Rectangle, Region};
use crate::wall::{Side, Wall, along};

/// What lies in planes, by the axis, the bits of the place on it, and from where it hides.
type Planes = BTreeMap<(usize, u32, Side), Region>;

/// The walls of a level that are at least so wide and high.
pub(crate) fn find(level: &Scene, least_side: f32) -> Vec<Wall> {
    let mut planes = Planes::new();
    for (_, object) in level.iter() {
        if object.motion() != Motion::Static || object.layers() != u64::MAX {
            continue;
        }
        match object.occluder() {
            Some(Occluder::Box(b)) => add_box(&mut planes, b.min, b.max),
            Some(Occluder::Mesh(mesh)) => add_mesh(&mut planes, mesh, &Affine3A::IDENTITY),
            Some(Occluder::Instance(instance)) => {
                add_mesh(&mut planes, instance.mesh(), &instance.transform());
            }
            _ => {}
        }
    }
    let mut walls = Vec::new();
    for ((axis, at, from), region) in planes {
        let at = f64::from(f32::from_bits(at));
        let large = |r: &Rectangle| (0..2).all(|i| r.1[i] - r.0[i] >= least_side);
        let all = region.rectangles().into_iter().filter(large);
        walls.extend(all.map(|(min, max)| Wall {
            axis,
            at,
            from,
            min: min.map(f64::from),
            max: max.map(f64::from),
        }));
    }
    walls
}

fn plane(planes: &mut Planes, axis: usize, at: f32, from: Side) -> &mut Region {
    // Two zeros are one plane.
    planes.entry((axis, (at + 0.0).to_bits(), from)).or_default()
}

fn add_box(planes: &mut Planes, min: Vec3, max: Vec3) {
    for axis in 0..3 {
        for at in [min[axis], max[axis]] {
            let side = |p: Vec3| along(axis).map(|i| p[i] + 0.0);
            plane(planes, axis, at, Side::Both).rectangles.push((side(min), side(max)));
        }
    }
}

/// Adds the triangles that lie across an axis.
fn add_mesh(planes: &mut Planes, mesh: &TriMesh, transform: &Affine3A) {
    let is_front = mesh.facing() == Facing::Front;
    // A mirror leaves a doubt about which side is the front.
    if is_front && transform.matrix3.determinant() <= 0.0 {
        return;
    }
    for triangle in mesh.triangles() {
        let corners = triangle.map(|v| mesh.positions().get(v as usize).copied().unwrap_or(Vec3::NAN));
        let corners = corners.map(|p| transform.transform_point3(p));
        let Some(axis) = (0..3).find(|&a| corners.iter().all(|p| p[a] == corners[0][a])) else { continue };
        let flat = corners.map(|p| along(axis).map(|i| p[i] + 0.0));
        if flat.iter().flatten().all(|v| v.is_finite()) {
            let [a, b, c] = corners.map(|p| p.as_dvec3());
            let from = match is_front {
                false => Side::Both,
                true if (b - a).cross(c - a)[axis] > 0.0 => Side::Above,
                true => Side::Below,
            };
            plane(planes, axis, corners[0][axis], from).triangles.push(flat);
        }
    }
}
