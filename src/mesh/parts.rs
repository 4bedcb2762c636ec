//! Parts: convex solids around pieces of a mesh, to test its visibility with.
//!
//! Large meshes whose pieces fill much less than the whole are cut into pieces first.

use std::ops::Range;

use glam::{DVec3, Vec3, Vec3A};

use crate::mesh::around::around;
use crate::mesh::parallel;
use crate::shape::convex::Convex;

/// How often a mesh is halved, at most.
const DEPTH: u32 = 6;

/// Halves are kept if their cost together is less than this share of the cost of the whole.
const WORTH_CUTTING: f64 = 0.8;

/// The cost of an eye inside of a box, beside that of a ray that enters it: the area of a cube of
/// the same volume.
const INSIDE: f64 = 6.0;

/// What is asked of triangles while they are cut: the sum of the corners of each, and its box.
struct TriangleBoxes {
    sums: Vec<DVec3>,
    boxes: Vec<(Vec3A, Vec3A)>,
}

impl TriangleBoxes {
    fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let corners = || triangles.iter().map(|t| t.map(|v| positions[v as usize]));
        let around = |[a, b, c]: [Vec3; 3]| {
            let [a, b, c] = [a, b, c].map(Vec3A::from);
            (a.min(b).min(c), a.max(b).max(c))
        };
        Self {
            sums: corners().map(|[a, b, c]| a.as_dvec3() + b.as_dvec3() + c.as_dvec3()).collect(),
            boxes: corners().map(around).collect(),
        }
    }
}

/// A set of triangles with its box: a range of the list that is cut.
struct TriangleRange {
    own: Range<usize>,
    min: Vec3A,
    max: Vec3A,
    /// The cost of the box as a stand-in for its contents: rays that enter it, and eyes inside.
    cost: f64,
}

impl TriangleRange {
    fn new(order: &[u32], own: Range<usize>, extents: &TriangleBoxes) -> Self {
        let start = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
        let (min, max) = order[own.clone()].iter().fold(start, |(min, max), &t| {
            let (low, high) = extents.boxes[t as usize];
            (min.min(low), max.max(high))
        });
        let d = Vec3::from(max).as_dvec3() - Vec3::from(min).as_dvec3();
        let cost = d.x * d.y + d.y * d.z + d.z * d.x + INSIDE * (d.x * d.y * d.z).cbrt().powi(2);
        Self { own, min, max, cost }
    }
}

/// Triangles as they are cut into pieces.
struct Cutter<'a> {
    extents: &'a TriangleBoxes,
    order: Vec<u32>,
    /// Room for the triangles of an upper half.
    upper: Vec<u32>,
    done: Vec<TriangleRange>,
}

impl Cutter<'_> {
    /// Two halves, cut across the longest side; their triangles keep their order.
    fn halves(&mut self, whole: &TriangleRange) -> Option<[TriangleRange; 2]> {
        let (min, max) = (Vec3::from(whole.min).as_dvec3(), Vec3::from(whole.max).as_dvec3());
        let axis = (max - min).max_position();
        let middle = 1.5 * (min[axis] + max[axis]);
        let own = &mut self.order[whole.own.clone()];
        let (mut low, mut high) = (0, 0);
        for i in 0..own.len() {
            let t = own[i];
            let is_low = self.extents.sums[t as usize][axis] < middle;
            // Both are written, and one is kept.
            own[low] = t;
            self.upper[high] = t;
            low += usize::from(is_low);
            high += usize::from(!is_low);
        }
        own[low..].copy_from_slice(&self.upper[..high]);
        let cut = whole.own.start + low;
        let halves = [whole.own.start..cut, cut..whole.own.end];
        (low > 0 && high > 0).then(|| halves.map(|own| TriangleRange::new(&self.order, own, self.extents)))
    }

    /// Appends the pieces that one is best cut into.
    fn cut(&mut self, whole: TriangleRange, depth: u32) {
        let Some(halves) = (depth > 0).then(|| self.halves(&whole)).flatten() else {
            self.done.push(whole);
            return;
        };
        let first = self.done.len();
        halves.into_iter().for_each(|half| self.cut(half, depth - 1));
        let sum: f64 = self.done[first..].iter().map(|piece| piece.cost).sum();
        if sum < WORTH_CUTTING * whole.cost {
            return;
        }
        self.done.truncate(first);
        self.done.push(whole);
    }
}

/// Convex solids that together contain a mesh.
pub(crate) fn parts(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Convex> {
    let extents = TriangleBoxes::new(positions, triangles);
    let order: Vec<u32> = (0..triangles.len() as u32).collect();
    let upper = vec![0; order.len()];
    let whole = TriangleRange::new(&order, 0..order.len(), &extents);
    let mut cutter = Cutter { extents: &extents, order, upper, done: Vec::new() };
    cutter.cut(whole, DEPTH);
    let Cutter { order, mut done, .. } = cutter;
    drop(extents);
    // Large ones are seen first.
    done.sort_by(|a, b| b.cost.total_cmp(&a.cost));
    let mut parts = Vec::with_capacity(done.len());
    parallel::extend(&mut parts, done.len(), |i| {
        let own = order[done[i].own.clone()].iter().flat_map(|&t| triangles[t as usize]);
        around(&points(positions, own))
    });
    parts
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
