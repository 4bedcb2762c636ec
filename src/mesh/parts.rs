//! The convex solid around a mesh, to test its visibility with.

use glam::{DVec3, Vec3};

use crate::mesh::around::around;
use crate::shape::convex::Convex;

/// Convex solids that together contain a mesh: one.
pub(crate) fn parts(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Convex> {
    vec![around(&points(positions, triangles.iter().flatten().copied()))]
}

/// The positions of some vertices in the order of their numbers, each once.
fn points(positions: &[Vec3], vertices: impl Iterator<Item = u32>) -> Vec<DVec3> {
    let mut taken = vec![0u64; positions.len().div_ceil(64)];
    vertices.for_each(|v| taken[v as usize / 64] |= 1 << (v % 64));
    let count = taken.iter().map(|word| word.count_ones() as usize).sum();
    let mut points = Vec::with_capacity(count);
    for (mut word, first) in taken.into_iter().zip((0..).step_by(64)) {
        while word != 0 {
            points.push(positions[first + word.trailing_zeros() as usize].as_dvec3());
            word &= word - 1;
        }
    }
    points
}
