//! Outlines: the directions that a convex shape covers as seen from the origin, before they are
//! projected to a face.
//!
//! Seen from outside, a convex shape covers a convex cone of directions, bounded by
//! planes through the eye and its silhouette edges, or by a circular cone for a sphere.
//! A point in the cone is hidden by the shape if it lies behind every plane that
//! faces the eye: those of the faces turned to it, or a sphere's polar plane.
//! For parallel rays cones become cylinders.

use glam::{DMat3, DVec3};
use smallvec::SmallVec;

use crate::geometry::plane::HalfSpace;
use crate::geometry::{Block, Room};
use crate::numeric::greater;
use crate::numeric::occlusion::{REACH_SINE, REACH_STEEPEST};
use crate::numeric::shape::{NEAREST_EDGE, NO_EDGE, NO_WIDTH, STEEPEST_EDGE};

/// A convex shape relative to the origin of the rays. Lives on the stack.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Clone)]
pub(crate) enum Outline {
    Sphere {
        center: DVec3,
        radius: f64,
    },
    /// The directions inside all half-spaces; each plane runs along the rays.
    Cone(SmallVec<[HalfSpace; 8]>),
    /// Every direction: a shape around the eye, or too close to tell.
    Everything,
}

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

/// The silhouette of a box along the axes as seen from the origin, and its faces turned there: as
/// [`Polytope::outline`] and [`Polytope::fronts`] of [`Polytope::block`] give them.
///
/// The place of the eye along each axis (before the box, beside it or beyond it) tells the faces
/// and edges.
pub(crate) fn outline_of_block(b: &Block) -> (Outline, SmallVec<[HalfSpace; 3]>) {
    let (min, max) = (b.min.to_array(), b.max.to_array());
    let nothing = HalfSpace { normal: DVec3::ZERO, offset: 0.0 };
    let (mut fronts, mut count) = ([nothing; 3], 0);
    // Whether the lesser and the greater face along each axis is turned to the eye.
    let mut front = [[false; 2]; 3];
    for axis in 0..3 {
        front[axis] = [min[axis] > 0.0, max[axis] < 0.0];
        if front[axis][0] || front[axis][1] {
            let (sign, offset) = if front[axis][0] { (1.0, -min[axis]) } else { (-1.0, max[axis]) };
            fronts[count] = HalfSpace { normal: DVec3::AXES[axis] * sign, offset };
            count += 1;
        }
    }
    let fronts = SmallVec::from_buf_and_len(fronts, count);
    // A box has at most six edges between a face that is turned to the eye and one that is not.
    let (mut planes, mut count) = ([nothing; 8], 0);
    for (axis, i, j) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        let along = greater(min[axis].abs(), max[axis].abs());
        let middle = ((min[i] + max[i]) * 0.5, (min[j] + max[j]) * 0.5);
        for (side, other) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            if front[i][side] == front[j][other] {
                continue;
            }
            let (p, q) = ([min, max][side][i], [min, max][other][j]);
            let largest = greater(along, greater(p.abs(), q.abs()));
            if max[axis] - min[axis] <= NO_EDGE * largest {
                continue;
            }
            let distance = (p * p + q * q).sqrt();
            let inverse = 1.0 / distance;
            let (a, b) = (q * inverse, -p * inverse);
            let inside = a * middle.0 + b * middle.1;
            // Also if a number is NaN.
            if !(distance > NEAREST_EDGE * largest && inside.abs() >= NO_WIDTH * largest) {
                return (Outline::Everything, fronts);
            }
            let mut normal = [0.0; 3];
            (normal[i], normal[j]) = if inside < 0.0 { (-a, -b) } else { (a, b) };
            planes[count] = HalfSpace { normal: DVec3::from_array(normal), offset: 0.0 };
            count += 1;
        }
    }
    let known = count >= 3;
    (
        if known { Outline::Cone(SmallVec::from_buf_and_len(planes, count)) } else { Outline::Everything },
        fronts,
    )
}

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

    pub(crate) fn bounds(&self) -> Block {
        let mut b = Block { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };
        for &p in &self.vertices {
            b = Block { min: b.min.min(p), max: b.max.max(p) };
        }
        b
    }

    /// The faces turned to the eye.
    pub(crate) fn fronts(&self, direction: Option<DVec3>) -> SmallVec<[HalfSpace; 3]> {
        // Memory is taken once, for polytopes of many faces.
        let mut fronts = SmallVec::with_capacity(self.faces.len() / 2);
        fronts.extend(self.faces.iter().copied().filter(|face| is_front(face, direction)));
        fronts
    }

    /// The silhouette. `Everything` where it is not known well enough.
    ///
    /// With `room`, only the directions whose rays keep farther than that from all edges of the
    /// silhouette.
    pub(crate) fn outline(&self, direction: Option<DVec3>, room: &Room) -> Outline {
        let fronts: TurnedFaces = self.faces.iter().map(|face| is_front(face, direction)).collect();
        outline(&self.vertices, &self.edges, &fronts, direction, room)
    }
}

/// Whether a face is turned to the eye at the origin, or to rays along `direction`.
fn is_front(face: &HalfSpace, direction: Option<DVec3>) -> bool {
    match direction {
        Some(d) => face.normal.dot(d) > 0.0,
        None => face.offset < 0.0,
    }
}

/// For each face, whether it is turned to the eye.
type TurnedFaces = SmallVec<[bool; 32]>;

/// The silhouette of a polytope with these corners and edges.
fn outline(
    vertices: &[DVec3],
    edges: &[[u16; 4]],
    fronts: &[bool],
    direction: Option<DVec3>,
    room: &Room,
) -> Outline {
    let mut planes = SmallVec::new();
    let center = vertices.iter().sum::<DVec3>() / vertices.len().max(1) as f64;
    for &[a, b, f, g] in edges {
        if fronts[usize::from(f)] == fronts[usize::from(g)] {
            continue;
        }
        let (p, q) = (vertices[usize::from(a)], vertices[usize::from(b)]);
        let edge = q - p;
        let across = match direction {
            None => p.cross(edge),
            Some(d) => {
                let n = edge.cross(d);
                n - d * n.dot(d)
            }
        };
        let length = across.length();
        let largest = p.abs().max_element().max(q.abs().max_element());
        // Edges without length, as rays see them, bound nothing.
        if edge.length() <= NO_EDGE * largest || direction.is_some() && length <= NO_EDGE * largest {
            continue;
        }
        let known = match direction {
            // Twice the triangle's area is the edge's length times its distance.
            None => length > NEAREST_EDGE * largest * edge.length(),
            Some(_) => length > STEEPEST_EDGE * edge.length(),
        };
        if !known {
            return Outline::Everything;
        }
        let n = across / length;
        let h = if direction.is_some() { -n.dot(p) } else { 0.0 };
        let side = n.dot(center) + h;
        // A shape without width: which side is inside is rounding.
        if side.abs() < NO_WIDTH * largest {
            return Outline::Everything;
        }
        let (mut normal, offset) = if side < 0.0 { (-n, -h) } else { (n, h) };
        if room.radius() > 0.0 {
            let Some(turned) = turned_past(normal, p, edge, room) else {
                return Outline::Everything;
            };
            normal = turned;
        }
        planes.push(HalfSpace { normal, offset });
    }
    if planes.len() < 3 { Outline::Everything } else { Outline::Cone(planes) }
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
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (min, max) = self.vertices.iter().fold(start, |(min, max), &v| (min.min(v), max.max(v)));
        Block { min: min - self.origin, max: max - self.origin }
    }

    /// Its corners relative to the origin, its silhouette (see [`Polytope::outline`]), and its
    /// faces turned to the eye.
    #[allow(clippy::type_complexity)]
    pub(crate) fn seen(
        &self,
        direction: Option<DVec3>,
        room: &Room,
    ) -> (SmallVec<[DVec3; 8]>, Outline, SmallVec<[HalfSpace; 3]>) {
        let vertices: SmallVec<[DVec3; 8]> = self.vertices.iter().map(|&v| v - self.origin).collect();
        let mut turned = TurnedFaces::with_capacity(self.faces.len());
        // Memory is taken once, for polytopes of many faces.
        let mut fronts = SmallVec::with_capacity(self.faces.len() / 2);
        for placed in self.faces() {
            turned.push(is_front(&placed, direction));
            if is_front(&placed, direction) {
                fronts.push(placed);
            }
        }
        let outline = outline(&vertices, self.edges, &turned, direction, room);
        (vertices, outline, fronts)
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

/// The normal of a plane through the eye and the edge from `p` along `edge`, turned until the edge
/// lies outside, for eyes anywhere in a room; `None` if the edge is too near.
///
/// Let c be the point of the edge that is nearest to the eye. Then c . x >= |c|^2 for each point x
/// of the edge, so that the unit vector m = n cos a - c / |c| sin a has a product of -|c| sin a
/// with it at most. The room goes no farther along m than its radius, and than the sum of cos a
/// times as far as along n and sin a times as far as along c. So it is enough if sin a is the
/// radius over |c|, or if tan a is the way along n over |c| less the way along c.
fn turned_past(normal: DVec3, p: DVec3, edge: DVec3, room: &Room) -> Option<DVec3> {
    let nearest = p + edge * (-p.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
    let distance = nearest.length();
    let left = distance - room.along(nearest / distance);
    let tangent = room.along(normal) / left;
    let of_box = if left > 0.0 { tangent / (1.0 + tangent * tangent).sqrt() } else { 1.0 };
    let sine = (room.radius() / distance).min(of_box) + REACH_SINE;
    // Nor if it is NaN.
    (sine < REACH_STEEPEST).then(|| normal * (1.0 - sine * sine).sqrt() - nearest * (sine / distance))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn boxes_have_the_outlines_of_their_polytopes() {
        let mut random = Random::new(5);
        let mut next = || random.next() - 0.5;
        let mut cones = 0;
        for i in 0..2000 {
            let (a, b) = (DVec3::new(next(), next(), next()), DVec3::new(next(), next(), next()));
            let mut block = Block { min: a.min(b), max: a.max(b) };
            if i % 4 == 0 {
                // Flat.
                block.max[i / 4 % 3] = block.min[i / 4 % 3];
            }
            let (outline, fronts) = outline_of_block(&block);
            let general = Polytope::block(&block);
            assert_eq!(fronts, general.fronts(None));
            match (outline, general.outline(None, &Room::NONE)) {
                (Outline::Cone(own), Outline::Cone(other)) => {
                    cones += 1;
                    assert_eq!(own.len(), other.len());
                    let near = |a: &HalfSpace, b: &HalfSpace| (a.normal - b.normal).length() < 1e-12;
                    assert!(own.iter().all(|a| other.iter().any(|b| near(a, b))), "{block:?}");
                }
                (own, other) => {
                    assert!(matches!((own, other), (Outline::Everything, Outline::Everything)), "{block:?}");
                }
            }
        }
        assert!(cones > 1000, "{cones}");
    }
}
