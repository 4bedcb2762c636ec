//! Convex solids around points: a box, along the axes of the world or of the points, with edges and
//! corners cut off where they leave room (a discrete orientation polytope, Klosowski et al. 1998).

use glam::{DMat3, DVec3};
use smallvec::SmallVec;

use crate::geometry::plane::HalfSpace;
use crate::numeric::mesh::{DIAGONAL, PART_CUT, PART_ROOM, PART_THICKNESS};
use crate::shape::convex::Convex;

/// Axes whose determinant is greater span space: only rounding is between them and a rotation.
const TURNED: f64 = 0.99;

/// A box along the axes of the points is taken if its surface is less than this share of that of
/// the box along the axes of the world, which is quicker to compare with.
const WORTH_TURNING: f64 = 0.9;

/// Planes are added where they cut off this share of the diagonal.
const WORTH_A_PLANE: f64 = 0.02;

/// The axes of a set of points: those of its scatter (Jacobi's rotations), least spread last.
fn own_axes(points: &[DVec3]) -> DMat3 {
    let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    let mut m = [[0.0f64; 3]; 3];
    for p in points {
        let d = *p - middle;
        m[0][0] += d.x * d.x;
        m[0][1] += d.x * d.y;
        m[0][2] += d.x * d.z;
        m[1][1] += d.y * d.y;
        m[1][2] += d.y * d.z;
        m[2][2] += d.z * d.z;
    }
    (m[1][0], m[2][0], m[2][1]) = (m[0][1], m[0][2], m[1][2]);
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
pub(super) fn around(points: &[DVec3]) -> Convex {
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (min, max) = points.iter().fold(start, |(min, max), &p| (p.min(min), p.max(max)));
    let largest = min.abs().max(max.abs()).max_element();
    let surface = |half: DVec3| half.x * half.y + half.y * half.z + half.z * half.x;
    let world = ((max - min) * 0.5, (min + max) * 0.5);
    let own = own_axes(points);
    let turned = own.determinant().abs() > TURNED;
    let (axes, (half, center)) = match box_along(points, &own) {
        fit if turned && surface(fit.0) < WORTH_TURNING * surface(world.0) => (own, fit),
        _ => (DMat3::IDENTITY, world),
    };
    // Flat pieces get some thickness: solids have an inside.
    let size = half.length();
    let room = PART_ROOM * (largest + size) + f64::MIN_POSITIVE;
    let thin = (PART_THICKNESS * size).max(room);
    let half = half.max(DVec3::splat(thin)) + room;
    let mut solid = CutSolid::boxed(&axes, center, half);
    // Where a plane cuts off most, first.
    let mut planes: SmallVec<[(f64, HalfSpace); 20]> = SmallVec::new();
    let directions =
        DIAGONALS.map(|(x, y, z)| (axes.x_axis * x + axes.y_axis * y + axes.z_axis * z).normalize());
    for (n, (lo, hi)) in directions.into_iter().zip(extents_along(points, &directions)) {
        for plane in [HalfSpace { normal: -n, offset: hi + room }, HalfSpace { normal: n, offset: room - lo }]
        {
            planes.push((solid.beyond(&plane), plane));
        }
    }
    planes.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (beyond, plane) in planes {
        if beyond > WORTH_A_PLANE * size {
            solid.cut(plane, PART_CUT * room);
        }
    }
    solid.convex()
}

/// The box around points along some axes: half of its size, and its middle.
fn box_along(points: &[DVec3], axes: &DMat3) -> (DVec3, DVec3) {
    let (mut half, mut center) = (DVec3::ZERO, DVec3::ZERO);
    let extents = extents_along(points, &[axes.x_axis, axes.y_axis, axes.z_axis]);
    for (i, (lo, hi)) in extents.into_iter().enumerate() {
        half[i] = (hi - lo) * 0.5;
        center += axes.col(i) * ((lo + hi) * 0.5);
    }
    (half, center)
}

/// The corners of a face in a ring.
type Ring = SmallVec<[u16; 12]>;

/// The corners of a ring, each with the next one.
fn pairs(ring: &[u16]) -> impl Iterator<Item = (u16, u16)> {
    let next = ring.get(1..).unwrap_or(&[]).iter().chain(ring.first());
    ring.iter().copied().zip(next.copied())
}

/// A convex solid as it is cut.
struct CutSolid {
    /// The corners, and those that were cut off.
    vertices: Vec<DVec3>,
    /// The half-space of each face, and its ring.
    faces: Vec<(HalfSpace, Ring)>,
}

impl CutSolid {
    fn boxed(axes: &DMat3, center: DVec3, half: DVec3) -> Self {
        let corner = |i: usize| {
            let s = |bit: usize| if i >> bit & 1 == 1 { half[bit] } else { -half[bit] };
            center + axes.x_axis * s(0) + axes.y_axis * s(1) + axes.z_axis * s(2)
        };
        let mut faces = Vec::with_capacity(16);
        for axis in 0..3 {
            let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
            let n = axes.col(axis);
            let (lower, upper) = (half[axis] - n.dot(center), half[axis] + n.dot(center));
            let ring = |corners: [u16; 4]| Ring::from_slice(&corners);
            faces.push((HalfSpace { normal: n, offset: lower }, ring([0, v, u | v, u])));
            let high = 1 << axis;
            let far = ring([high, high | u, high | u | v, high | v]);
            faces.push((HalfSpace { normal: -n, offset: upper }, far));
        }
        let mut vertices = Vec::with_capacity(32);
        vertices.extend((0..8).map(corner));
        Self { vertices, faces }
    }

    /// How far it reaches beyond a plane.
    fn beyond(&self, plane: &HalfSpace) -> f64 {
        self.vertices.iter().map(|v| plane.beyond(*v)).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Cuts off the part that lies beyond a plane by more than `eps`.
    fn cut(&mut self, plane: HalfSpace, eps: f64) {
        let Self { vertices, faces } = self;
        let above: SmallVec<[f64; 64]> = vertices.iter().map(|v| plane.beyond(*v)).collect();
        let above = above.as_slice();
        let out = |v: u16| above[usize::from(v)] > eps;
        let mut crossings: SmallVec<[([u16; 2], u16); 16]> = SmallVec::new();
        // The new face's edges, from corner to corner.
        let mut cut: SmallVec<[(u16, u16); 16]> = SmallVec::new();
        faces.retain_mut(|(_, ring)| {
            if !ring.iter().any(|&v| out(v)) {
                return true;
            }
            let mut kept = Ring::new();
            let (mut leaves, mut enters) = (None, None);
            for (a, b) in pairs(ring) {
                if !out(a) {
                    kept.push(a);
                }
                if out(a) != out(b) {
                    let edge = [a.min(b), a.max(b)];
                    let known = crossings.iter().find(|c| c.0 == edge).map(|c| c.1);
                    let at = known.unwrap_or_else(|| {
                        let [p, q] = edge.map(usize::from);
                        let t = (above[p] / (above[p] - above[q])).clamp(0.0, 1.0);
                        vertices.push(vertices[p].lerp(vertices[q], t));
                        let at = vertices.len() as u16 - 1;
                        crossings.push((edge, at));
                        at
                    });
                    kept.push(at);
                    if out(b) { leaves = Some(at) } else { enters = Some(at) }
                }
            }
            if let (Some(leaves), Some(enters)) = (leaves, enters) {
                cut.push((enters, leaves));
            }
            *ring = kept;
            ring.len() >= 3
        });
        let mut ring = Ring::new();
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
    }

    fn convex(self) -> Convex {
        const NONE: u16 = u16::MAX;
        let mut number = vec![NONE; self.vertices.len()];
        let mut vertices = Vec::with_capacity(self.vertices.len());
        let mut sides = 0;
        for &v in self.faces.iter().flat_map(|face| &face.1) {
            sides += 1;
            let number = &mut number[usize::from(v)];
            if *number == NONE {
                *number = vertices.len() as u16;
                vertices.push(self.vertices[usize::from(v)]);
            }
        }
        vertices.shrink_to_fit();
        let edges_of = |ring| {
            let number = |v: u16| usize::from(number[usize::from(v)]);
            pairs(ring).map(move |(a, b)| (number(a), number(b)))
        };
        // The first face that runs along an edge, by its ends.
        let mut first = vec![NONE; vertices.len() * vertices.len()];
        for (f, (_, ring)) in self.faces.iter().enumerate().rev() {
            for (a, b) in edges_of(ring) {
                first[a * vertices.len() + b] = f as u16;
            }
        }
        let mut edges: Vec<[u16; 4]> = Vec::with_capacity(sides / 2);
        for ((_, ring), f) in self.faces.iter().zip(0u16..) {
            for (a, b) in edges_of(ring) {
                let g = first[b * vertices.len() + a];
                if g != NONE && f < g {
                    edges.push([a as u16, b as u16, f, g]);
                }
            }
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
    use crate::random::Random;

    #[test]
    fn solids_around_points_hold_them_and_close() {
        let mut random = Random::new(1);
        for n in [1, 2, 3, 4, 8, 20, 100] {
            for round in 0..30 {
                let stretch = DVec3::new(1.0, if round % 3 == 0 { 0.0 } else { 1.0 }, 1e3);
                let points: Vec<DVec3> = (0..n)
                    .map(|_| DVec3::new(random.next(), random.next(), random.next()) * stretch)
                    .collect();
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
