//! Convex solids as lists of faces, clipped by half-spaces.

use glam::{BVec3, DVec3};
use smallvec::SmallVec;

use crate::geometry::plane::HalfSpace;

/// The faces of a convex solid, each with its corners in a ring. Those of a frustum take no memory
/// from the heap.
pub(crate) type Faces = SmallVec<[SmallVec<[DVec3; 16]>; 12]>;

/// The sides of a box.
pub(crate) fn sides_of_box(min: DVec3, max: DVec3) -> Faces {
    let corner = |i: usize| DVec3::select(BVec3::new(i & 1 == 1, i & 2 == 2, i & 4 == 4), max, min);
    let side = |axis: usize, high: usize| {
        let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        SmallVec::from_iter([0, u, u | v, v].map(|i| corner(i | high << axis)))
    };
    (0..3).flat_map(|axis| [side(axis, 0), side(axis, 1)]).collect()
}

/// Cuts off the part of a convex solid, given by its faces, that lies outside of a half-space by
/// more than `slack`.
pub(crate) fn clip(faces: &mut Faces, plane: &HalfSpace, slack: f64) {
    let mut cut: SmallVec<[DVec3; 16]> = SmallVec::new();
    for face in faces.iter_mut() {
        let mut kept = SmallVec::new();
        for (i, &a) in face.iter().enumerate() {
            let b = face[(i + 1) % face.len()];
            let (da, db) = (plane.distance(a) + slack, plane.distance(b) + slack);
            if da >= 0.0 {
                kept.push(a);
            }
            if da == 0.0 {
                cut.push(a);
            } else if (da < 0.0) != (db < 0.0) {
                let crossing = a.lerp(b, (da / (da - db)).clamp(0.0, 1.0));
                kept.push(crossing);
                cut.push(crossing);
            }
        }
        *face = kept;
    }
    faces.retain(|face| !face.is_empty());
    // The new face: the points where edges were cut, in a ring around their middle.
    let middle = cut.iter().sum::<DVec3>() / cut.len().max(1) as f64;
    let (u, v) = plane.normal.any_orthonormal_pair();
    let turn = |p: &DVec3| turn(u.dot(*p - middle), v.dot(*p - middle));
    cut.sort_by(|p, q| turn(p).total_cmp(&turn(q)));
    if !cut.is_empty() {
        faces.push(cut);
    }
}

/// A number that grows with the angle of a direction, from -2 to 2; cheaper than the angle.
fn turn(x: f64, y: f64) -> f64 {
    (1.0 - x / (x.abs() + y.abs())).copysign(y)
}
