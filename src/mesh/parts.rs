//! Parts: convex solids around pieces of a mesh, to test its visibility with.
//!
//! A box, along the axes of the world or of the piece, with edges and corners cut off where the
//! piece leaves room (a discrete orientation polytope, Klosowski et al. 1998). Large meshes whose
//! pieces fill much less than the whole are cut into pieces first.

use glam::{DMat3, DVec3, Vec3};

use crate::geometry::plane::HalfSpace;
use crate::mesh::parallel;
use crate::numeric::mesh::{DIAGONAL, PART_CUT, PART_ROOM, PART_THICKNESS};
use crate::shape::convex::Convex;

/// How often a mesh is halved, at most.
const DEPTH: u32 = 6;

/// Halves are kept if their cost together is less than this share of the cost of the whole.
const WORTH_CUTTING: f64 = 0.8;

/// The cost of an eye inside of a box, beside that of a ray that enters it: the area of a cube of
/// the same volume.
const INSIDE: f64 = 6.0;

/// Axes whose determinant is greater span space: only rounding is between them and a rotation.
const TURNED: f64 = 0.99;

/// A box along the axes of the points is taken if its surface is less than this share of that of
/// the box along the axes of the world, which is quicker to compare with.
const WORTH_TURNING: f64 = 0.9;

/// Planes are added where they cut off this share of the diagonal.
const WORTH_A_PLANE: f64 = 0.02;

/// A set of triangles with its box.
struct Piece {
    triangles: Vec<u32>,
    min: Vec3,
    max: Vec3,
}

/// What is asked of triangles while they are cut: the sum of the corners of each, and its box.
struct Extents {
    sums: Vec<DVec3>,
    boxes: Vec<(Vec3, Vec3)>,
}

impl Extents {
    fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let corners = || triangles.iter().map(|t| t.map(|v| positions[v as usize]));
        Self {
            sums: corners().map(|[a, b, c]| a.as_dvec3() + b.as_dvec3() + c.as_dvec3()).collect(),
            boxes: corners().map(|[a, b, c]| (a.min(b).min(c), a.max(b).max(c))).collect(),
        }
    }
}

/// The cost of a box as a stand-in for its contents: rays that enter it, and eyes inside of it.
fn cost(piece: &Piece) -> f64 {
    let d = piece.max.as_dvec3() - piece.min.as_dvec3();
    d.x * d.y + d.y * d.z + d.z * d.x + INSIDE * (d.x * d.y * d.z).cbrt().powi(2)
}

impl Piece {
    fn new() -> Self {
        Self { triangles: Vec::new(), min: Vec3::INFINITY, max: Vec3::NEG_INFINITY }
    }

    fn add(&mut self, triangle: u32, extents: &Extents) {
        let (min, max) = extents.boxes[triangle as usize];
        (self.min, self.max) = (self.min.min(min), self.max.max(max));
        self.triangles.push(triangle);
    }

    /// Two halves, cut across the longest side.
    fn halves(&self, extents: &Extents) -> Option<[Self; 2]> {
        let (min, max) = (self.min.as_dvec3(), self.max.as_dvec3());
        let axis = (max - min).max_position();
        let middle = 1.5 * (min[axis] + max[axis]);
        let (mut low, mut high) = (Self::new(), Self::new());
        for &t in &self.triangles {
            let half = if extents.sums[t as usize][axis] < middle { &mut low } else { &mut high };
            half.add(t, extents);
        }
        (!low.triangles.is_empty() && !high.triangles.is_empty()).then_some([low, high])
    }

    /// The pieces that it is best cut into.
    fn cut(self, extents: &Extents, depth: u32) -> Vec<Self> {
        let Some(halves) = (depth > 0).then(|| self.halves(extents)).flatten() else { return vec![self] };
        let pieces: Vec<Self> = halves.into_iter().flat_map(|half| half.cut(extents, depth - 1)).collect();
        let sum: f64 = pieces.iter().map(cost).sum();
        if sum < WORTH_CUTTING * cost(&self) { pieces } else { vec![self] }
    }
}

/// Convex solids that together contain a mesh.
pub(crate) fn parts(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Convex> {
    let extents = Extents::new(positions, triangles);
    let mut whole = Piece::new();
    (0..triangles.len() as u32).for_each(|t| whole.add(t, &extents));
    let mut done = whole.cut(&extents, DEPTH);
    drop(extents);
    // Large ones are seen first.
    done.sort_by(|a, b| cost(b).total_cmp(&cost(a)));
    let points = |piece: &Piece| {
        let corners = piece.triangles.iter().flat_map(|&t| triangles[t as usize]);
        let mut vertices: Vec<u32> = corners.collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices.into_iter().map(|v| positions[v as usize].as_dvec3()).collect::<Vec<_>>()
    };
    let mut parts = Vec::with_capacity(done.len());
    parallel::extend(&mut parts, done.len(), |i| around(&points(&done[i])));
    parts
}

/// The axes of a set of points: those of its scatter (Jacobi's rotations), least spread last.
fn own_axes(points: &[DVec3]) -> DMat3 {
    let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    let mut m = [[0.0f64; 3]; 3];
    for p in points {
        let d = *p - middle;
        for (i, row) in m.iter_mut().enumerate() {
            for (entry, other) in row.iter_mut().zip(d.to_array()) {
                *entry += d[i] * other;
            }
        }
    }
    let mut axes = [DVec3::X, DVec3::Y, DVec3::Z];
    for _ in 0..12 {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            if m[i][j].abs() <= DIAGONAL * (m[i][i].abs() + m[j][j].abs()) {
                continue;
            }
            let theta = (m[j][j] - m[i][i]) / (2.0 * m[i][j]);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for row in &mut m {
                (row[i], row[j]) = (c * row[i] - s * row[j], s * row[i] + c * row[j]);
            }
            let (a, b) = (m[i], m[j]);
            for k in 0..3 {
                (m[i][k], m[j][k]) = (c * a[k] - s * b[k], s * a[k] + c * b[k]);
            }
            (axes[i], axes[j]) = (axes[i] * c - axes[j] * s, axes[i] * s + axes[j] * c);
        }
    }
    DMat3::from_cols(axes[0], axes[1], axes[2])
}

/// How far points reach along each direction, both ways.
fn extents_along<const N: usize>(points: &[DVec3], directions: &[DVec3; N]) -> [(f64, f64); N] {
    let along: [[f64; N]; 3] = [0, 1, 2].map(|axis| directions.map(|n| n[axis]));
    let (mut lo, mut hi) = ([f64::INFINITY; N], [f64::NEG_INFINITY; N]);
    for p in points {
        for i in 0..N {
            let at = along[0][i] * p.x + along[1][i] * p.y + along[2][i] * p.z;
            lo[i] = if at < lo[i] { at } else { lo[i] };
            hi[i] = if at > hi[i] { at } else { hi[i] };
        }
    }
    std::array::from_fn(|i| (lo[i], hi[i]))
}

/// A convex solid around points.
fn around(points: &[DVec3]) -> Convex {
    let largest = points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let box_of = |axes: &DMat3| {
        let mut half = DVec3::ZERO;
        let mut center = DVec3::ZERO;
        for (i, (lo, hi)) in
            extents_along(points, &[axes.x_axis, axes.y_axis, axes.z_axis]).into_iter().enumerate()
        {
            half[i] = (hi - lo) * 0.5;
            center += axes.col(i) * ((lo + hi) * 0.5);
        }
        (half, center)
    };
    let surface = |half: DVec3| half.x * half.y + half.y * half.z + half.z * half.x;
    let world = box_of(&DMat3::IDENTITY);
    let own = own_axes(points);
    let turned = own.determinant().abs() > TURNED;
    let (axes, (half, center)) = match box_of(&own) {
        fit if turned && surface(fit.0) < WORTH_TURNING * surface(world.0) => (own, fit),
        _ => (DMat3::IDENTITY, world),
    };
    // Flat pieces get some thickness: solids have an inside.
    let size = half.length();
    let room = PART_ROOM * (largest + size) + f64::MIN_POSITIVE;
    let thin = (PART_THICKNESS * size).max(room);
    let half = half.max(DVec3::splat(thin)) + room;
    let mut solid = Solid::boxed(&axes, center, half);
    // Where a plane cuts off most, first.
    let mut planes: Vec<(f64, HalfSpace)> = Vec::new();
    let directions =
        DIAGONALS.map(|(x, y, z)| (axes.x_axis * x + axes.y_axis * y + axes.z_axis * z).normalize());
    for (n, (lo, hi)) in directions.into_iter().zip(extents_along(points, &directions)) {
        for plane in [HalfSpace { normal: -n, offset: hi + room }, HalfSpace { normal: n, offset: room - lo }]
        {
            planes.push((solid.beyond(&plane), plane));
        }
    }
    planes.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, plane) in planes {
        if solid.beyond(&plane) > WORTH_A_PLANE * size {
            solid.cut(plane, PART_CUT * room);
        }
    }
    solid.convex()
}

/// A convex solid as it is cut.
struct Solid {
    vertices: Vec<DVec3>,
    /// The half-space of each face, and its corners in a ring.
    faces: Vec<(HalfSpace, Vec<usize>)>,
}

impl Solid {
    fn boxed(axes: &DMat3, center: DVec3, half: DVec3) -> Self {
        let corner = |i: usize| {
            let s = |bit: usize| if i >> bit & 1 == 1 { half[bit] } else { -half[bit] };
            center + axes.x_axis * s(0) + axes.y_axis * s(1) + axes.z_axis * s(2)
        };
        let mut faces = Vec::new();
        for axis in 0..3 {
            let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
            let n = axes.col(axis);
            let (lower, upper) = (half[axis] - n.dot(center), half[axis] + n.dot(center));
            faces.push((HalfSpace { normal: n, offset: lower }, vec![0, v, u | v, u]));
            let high = 1 << axis;
            let ring = vec![high, high | u, high | u | v, high | v];
            faces.push((HalfSpace { normal: -n, offset: upper }, ring));
        }
        Self { vertices: (0..8).map(corner).collect(), faces }
    }

    /// How far it reaches beyond a plane.
    fn beyond(&self, plane: &HalfSpace) -> f64 {
        self.vertices.iter().map(|v| plane.beyond(*v)).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Cuts off the part that lies beyond a plane by more than `eps`.
    fn cut(&mut self, plane: HalfSpace, eps: f64) {
        let above: Vec<f64> = self.vertices.iter().map(|v| plane.beyond(*v)).collect();
        let out = |v: usize| above[v] > eps;
        let mut crossings: Vec<((usize, usize), usize)> = Vec::new();
        // The new face's edges, from corner to corner.
        let mut cut: Vec<(usize, usize)> = Vec::new();
        let mut faces = Vec::new();
        for (own, ring) in std::mem::take(&mut self.faces) {
            let mut kept = Vec::with_capacity(ring.len() + 1);
            let (mut leaves, mut enters) = (None, None);
            for (i, &a) in ring.iter().enumerate() {
                let b = ring[(i + 1) % ring.len()];
                if !out(a) {
                    kept.push(a);
                }
                if out(a) != out(b) {
                    let edge = (a.min(b), a.max(b));
                    let known = crossings.iter().find(|c| c.0 == edge).map(|c| c.1);
                    let at = known.unwrap_or_else(|| {
                        let t = (above[edge.0] / (above[edge.0] - above[edge.1])).clamp(0.0, 1.0);
                        let p = self.vertices[edge.0].lerp(self.vertices[edge.1], t);
                        self.vertices.push(p);
                        crossings.push((edge, self.vertices.len() - 1));
                        self.vertices.len() - 1
                    });
                    kept.push(at);
                    if out(b) { leaves = Some(at) } else { enters = Some(at) }
                }
            }
            if let (Some(leaves), Some(enters)) = (leaves, enters) {
                cut.push((enters, leaves));
            }
            if kept.len() >= 3 {
                faces.push((own, kept));
            }
        }
        let mut ring: Vec<usize> = Vec::new();
        if let Some(&(first, mut at)) = cut.first() {
            ring.push(first);
            while at != first && ring.len() <= cut.len() {
                ring.push(at);
                at = cut.iter().find(|e| e.0 == at).map_or(first, |e| e.1);
            }
        }
        if ring.len() >= 3 {
            faces.push((plane, ring));
        }
        self.faces = faces;
    }

    fn convex(self) -> Convex {
        let mut number = vec![u16::MAX; self.vertices.len()];
        let mut vertices = Vec::new();
        let mut edges: Vec<[u16; 4]> = Vec::new();
        for (f, (_, ring)) in self.faces.iter().enumerate() {
            for (i, &a) in ring.iter().enumerate() {
                if number[a] == u16::MAX {
                    number[a] = vertices.len() as u16;
                    vertices.push(self.vertices[a]);
                }
                let b = ring[(i + 1) % ring.len()];
                let runs = |ring: &Vec<usize>| {
                    (0..ring.len()).any(|j| ring[j] == b && ring[(j + 1) % ring.len()] == a)
                };
                let other = self.faces.iter().position(|(_, ring)| runs(ring));
                if let Some(g) = other.filter(|&g| f < g) {
                    edges.push([a as u16, b as u16, f as u16, g as u16]);
                }
            }
        }
        for edge in &mut edges {
            (edge[0], edge[1]) = (number[usize::from(edge[0])], number[usize::from(edge[1])]);
        }
        Convex { vertices, faces: self.faces.iter().map(|f| f.0).collect(), edges, lost: 0.0 }
    }
}

/// Directions across the edges and corners of a box, one of each two.
const DIAGONALS: [(f64, f64, f64); 10] = [
    (1.0, 1.0, 0.0),
    (1.0, -1.0, 0.0),
    (1.0, 0.0, 1.0),
    (1.0, 0.0, -1.0),
    (0.0, 1.0, 1.0),
    (0.0, 1.0, -1.0),
    (1.0, 1.0, 1.0),
    (1.0, 1.0, -1.0),
    (1.0, -1.0, 1.0),
    (1.0, -1.0, -1.0),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solids_around_points_hold_them_and_close() {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        for n in [1, 2, 3, 4, 8, 20, 100] {
            for round in 0..30 {
                let stretch = DVec3::new(1.0, if round % 3 == 0 { 0.0 } else { 1.0 }, 1e3);
                let points: Vec<DVec3> =
                    (0..n).map(|_| DVec3::new(random(), random(), random()) * stretch).collect();
                let solid = around(&points);
                let (v, f, e) = (solid.vertices.len(), solid.faces.len(), solid.edges.len());
                assert_eq!(v + f, e + 2, "{n} points, round {round}: {v} corners, {f} faces, {e} edges");
                for face in &solid.faces {
                    assert!(points.iter().all(|p| face.distance(*p) >= 0.0));
                    // Corners lie inside all faces, but for rounding.
                    let room = 1e-9 * (1.0 + face.offset.abs());
                    assert!(solid.vertices.iter().all(|p| face.beyond(*p) <= room));
                }
            }
        }
    }
}
