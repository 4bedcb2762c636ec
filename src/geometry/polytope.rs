//! Convex polytopes, and parts of meshes that are such.

use glam::{DMat3, DVec3};
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::geometry::plane::HalfSpace;

/// A convex polytope: its corners, the half-spaces of its faces, and edges as two
/// corners and the two faces on both sides.
#[derive(Debug, Clone)]
pub(crate) struct Polytope {
    pub(crate) vertices: SmallVec<[DVec3; 8]>,
    pub(crate) faces: SmallVec<[HalfSpace; 6]>,
    pub(crate) edges: SmallVec<[[u16; 4]; 12]>,
}

/// Corners are numbered by bits: 1 the greater x, 2 the greater y, 4 the greater z;
/// faces -x, +x, -y, +y, -z, +z.
const BOX_EDGES: [[u16; 4]; 12] = [
    [0, 1, 2, 4],
    [2, 3, 3, 4],
    [4, 5, 2, 5],
    [6, 7, 3, 5],
    [0, 2, 0, 4],
    [1, 3, 1, 4],
    [4, 6, 0, 5],
    [5, 7, 1, 5],
    [0, 4, 0, 2],
    [1, 5, 1, 2],
    [2, 6, 0, 3],
    [3, 7, 1, 3],
];

impl Polytope {
    /// A box of half-axes `axes` around `center`; the columns are at right angles.
    pub(crate) fn boxed(center: DVec3, axes: &DMat3) -> Self {
        let corner = |i: usize| {
            let s = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
            center + axes.x_axis * s(0) + axes.y_axis * s(1) + axes.z_axis * s(2)
        };
        let mut faces = SmallVec::new();
        for axis in [axes.x_axis, axes.y_axis, axes.z_axis] {
            let length = axis.length();
            let n = if length > 0.0 { axis / length } else { DVec3::ZERO };
            faces.push(HalfSpace { normal: n, offset: -n.dot(center) + length });
            faces.push(HalfSpace { normal: -n, offset: n.dot(center) + length });
        }
        Self { vertices: (0..8).map(corner).collect(), faces, edges: SmallVec::from_slice(&BOX_EDGES) }
    }

    pub(crate) fn block(b: &Block) -> Self {
        let mut faces = SmallVec::new();
        for (axis, n) in DVec3::AXES.into_iter().enumerate() {
            faces.push(HalfSpace { normal: n, offset: -b.min[axis] });
            faces.push(HalfSpace { normal: -n, offset: b.max[axis] });
        }
        Self { vertices: SmallVec::from_buf(b.corners()), faces, edges: SmallVec::from_slice(&BOX_EDGES) }
    }

    /// The polytope as a part whose space has its origin at `at`.
    pub(crate) fn part(&self, at: DVec3, origin: DVec3) -> Part<'_> {
        Part { vertices: &self.vertices, faces: &self.faces, edges: &self.edges, origin: origin - at }
    }
}

/// A convex polytope given in another space, of which little need be known: it is placed where it
/// is needed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part<'a> {
    pub(crate) vertices: &'a [DVec3],
    pub(crate) faces: &'a [HalfSpace],
    pub(crate) edges: &'a [[u16; 4]],
    /// The origin of the rays.
    pub(crate) origin: DVec3,
}

impl Part<'_> {
    /// A point inside, relative to the origin.
    pub(crate) fn middle(&self) -> DVec3 {
        self.vertices.iter().sum::<DVec3>() / self.vertices.len().max(1) as f64 - self.origin
    }

    /// Its corners, relative to the origin.
    pub(crate) fn corners(&self) -> impl Iterator<Item = DVec3> {
        self.vertices.iter().map(|&v| v - self.origin)
    }

    /// The box around it, relative to the origin.
    pub(crate) fn bounds(&self) -> Block {
        let Block { min, max } = Block::around(self.vertices.iter().copied());
        Block { min: min - self.origin, max: max - self.origin }
    }

    /// Its faces relative to the origin.
    pub(crate) fn faces(&self) -> impl Iterator<Item = HalfSpace> {
        self.faces.iter().map(|face| HalfSpace { offset: face.distance(self.origin), ..*face })
    }

    /// All of it, relative to the origin.
    pub(crate) fn polytope(&self) -> Polytope {
        Polytope {
            vertices: self.vertices.iter().map(|&v| v - self.origin).collect(),
            faces: self.faces().collect(),
            edges: SmallVec::from_slice(self.edges),
        }
    }
}
