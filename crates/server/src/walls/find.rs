//! The walls of a level: faces of its boxes, and rectangles of its triangles.

use std::collections::BTreeMap;

use casca::glam::{Affine3A, Vec3};
use casca::{Motion, ObjectId, Occluder, Scene, TriMesh};

use super::rectangles::{Rectangle, greatest};
use super::wall::{Wall, along};

/// Narrower walls hide too little to be asked, in metres: a wall must be as wide as the room that
/// the eye or the entity has.
const LEAST_SIDE: f32 = 0.6;

/// Rectangles by their planes: the axis, and the bits of the place on it.
type Planes = BTreeMap<(usize, u32), Vec<Rectangle>>;

/// The walls of a level, but for the objects that `leaves_out` tells. Costs some passes over all
/// triangles.
pub(super) fn find(level: &Scene, leaves_out: impl Fn(ObjectId) -> bool) -> Vec<Wall> {
    let mut planes = Planes::new();
    for (id, object) in level.iter() {
        if object.motion() != Motion::Static || object.layers() != u64::MAX || leaves_out(id) {
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
    for ((axis, at), rectangles) in planes {
        let at = f64::from(f32::from_bits(at));
        let large = |r: &Rectangle| (0..2).all(|i| r.1[i] - r.0[i] >= LEAST_SIDE);
        let all = greatest(&rectangles).into_iter().filter(large);
        walls.extend(all.map(|(min, max)| Wall {
            axis,
            at,
            min: min.map(f64::from),
            max: max.map(f64::from),
        }));
    }
    walls
}

fn add(planes: &mut Planes, axis: usize, min: Vec3, max: Vec3) {
    let [b, c] = along(axis);
    // Two zeros are one plane.
    let at = (min[axis] + 0.0).to_bits();
    planes.entry((axis, at)).or_default().push(([min[b] + 0.0, min[c] + 0.0], [max[b] + 0.0, max[c] + 0.0]));
}

fn add_box(planes: &mut Planes, min: Vec3, max: Vec3) {
    for axis in 0..3 {
        for at in [min[axis], max[axis]] {
            let (mut low, mut high) = (min, max);
            (low[axis], high[axis]) = (at, at);
            add(planes, axis, low, high);
        }
    }
}

/// Adds pairs of triangles that share their longest edge and make a rectangle.
fn add_mesh(planes: &mut Planes, mesh: &TriMesh, transform: &Affine3A) {
    // Halves of rectangles, by the corners of these.
    let mut halves: BTreeMap<[u32; 6], u8> = BTreeMap::new();
    for triangle in mesh.triangles() {
        let corners = triangle.map(|v| mesh.positions().get(v as usize).copied().unwrap_or(Vec3::NAN));
        let corners = corners.map(|p| transform.transform_point3(p));
        let (min, max) =
            (corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2]));
        let flat = (0..3).filter(|&a| min[a] == max[a]).count() == 1;
        // Each corner is one of the rectangle's: the fourth is where none is.
        let is_corner = |p: &Vec3| (0..3).all(|a| p[a] == min[a] || p[a] == max[a]);
        if !flat || !corners.iter().all(is_corner) {
            continue;
        }
        let axis = (0..3).find(|&a| min[a] == max[a]).unwrap_or(0);
        let [b, c] = along(axis);
        let number = |p: &Vec3| u8::from(p[b] == max[b]) | u8::from(p[c] == max[c]) << 1;
        let mask = corners.iter().fold(0, |mask, p| mask | 1u8 << number(p));
        if mask.count_ones() != 3 {
            continue;
        }
        let key = [min.x, min.y, min.z, max.x, max.y, max.z].map(|v| (v + 0.0).to_bits());
        let known = halves.entry(key).or_default();
        // Two halves with different missing corners that lie across cover the rectangle.
        let missing = |mask: u8| (!mask & 0xf).trailing_zeros();
        if *known != 0 && missing(*known) + missing(mask) == 3 {
            add(planes, axis, min, max);
        }
        *known = mask;
    }
}
