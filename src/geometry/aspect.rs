//! Outlines: the directions that a convex shape covers as seen from the origin, before they are
//! projected to a face.
//!
//! Seen from outside, a convex shape covers a convex cone of directions, bounded by
//! planes through the eye and its silhouette edges, or by a circular cone for a sphere.
//! A point in the cone is hidden by the shape if it lies behind every plane that
//! faces the eye: those of the faces turned to it, or a sphere's polar plane.
//! For parallel rays cones become cylinders.

use glam::DVec3;

use crate::geometry::body::Body;
use crate::geometry::plane::HalfSpace;
use crate::geometry::polytope::{Part, Polytope};
use crate::geometry::{Block, Room};
use crate::numeric::greater;
use crate::numeric::occlusion::{REACH_SINE, REACH_STEEPEST};
use crate::numeric::shape::{NEAREST_EDGE, NO_EDGE, NO_WIDTH, STEEPEST_EDGE};

/// The kinds of outlines.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) enum Outline {
    Sphere {
        center: DVec3,
        radius: f64,
    },
    /// The directions inside all [`Aspect::sides`].
    Cone,
    /// Every direction: a shape around the eye, or too close to tell.
    #[default]
    Everything,
}

/// What is seen of a convex shape from the origin of the rays. It is filled again for each shape,
/// so that its lists keep their memory.
#[derive(Debug, Clone, Default)]
pub(crate) struct Aspect {
    pub(crate) outline: Outline,
    /// The half-spaces of a cone; each plane runs along the rays.
    pub(crate) sides: Vec<HalfSpace>,
    /// The half-spaces of the faces that are turned to the eye; none of a sphere.
    pub(crate) fronts: Vec<HalfSpace>,
    /// Its corners; none of spheres and of boxes along the axes.
    pub(crate) vertices: Vec<DVec3>,
    /// A box around it.
    pub(crate) block: Block,
    /// For each face, whether it is turned to the eye.
    turned: Vec<bool>,
}

impl Aspect {
    /// The greatest magnitude of the coordinates of its box.
    pub(crate) fn largest(&self) -> f64 {
        self.block.min.abs().max(self.block.max.abs()).max_element()
    }

    /// Makes it that of a body; see [`Aspect::set_part`].
    pub(crate) fn set_body(&mut self, body: &Body, direction: Option<DVec3>, room: &Room) {
        match body {
            Body::Sphere { center, radius } => self.set_sphere(*center, *radius),
            Body::Block(block) => self.set_block(block, direction, room),
            Body::Oriented { center, axes } => {
                let polytope = Polytope::boxed(*center, axes);
                let part = polytope.part(DVec3::ZERO, DVec3::ZERO);
                self.set_part(&part, part.bounds(), direction, room);
            }
            Body::Part(part) => self.set_part(part, part.bounds(), direction, room),
        }
    }

    pub(crate) fn set_sphere(&mut self, center: DVec3, radius: f64) {
        self.clear(Block { min: center - radius, max: center + radius });
        self.outline = Outline::Sphere { center, radius };
    }

    /// Makes it that of a box along the axes; see [`Aspect::set_part`].
    ///
    /// The place of the eye along each axis (before the box, beside it or beyond it) tells the
    /// faces and edges.
    pub(crate) fn set_block(&mut self, b: &Block, direction: Option<DVec3>, room: &Room) {
        if direction.is_some() || room.radius() > 0.0 {
            let polytope = Polytope::block(b);
            return self.set_part(&polytope.part(DVec3::ZERO, DVec3::ZERO), *b, direction, room);
        }
        self.clear(*b);
        let (min, max) = (b.min.to_array(), b.max.to_array());
        // Whether the lesser and the greater face along each axis is turned to the eye.
        let mut front = [[false; 2]; 3];
        for axis in 0..3 {
            front[axis] = [min[axis] > 0.0, max[axis] < 0.0];
            if front[axis][0] || front[axis][1] {
                let (sign, offset) = if front[axis][0] { (1.0, -min[axis]) } else { (-1.0, max[axis]) };
                self.fronts.push(HalfSpace { normal: DVec3::AXES[axis] * sign, offset });
            }
        }
        // A box has at most six edges between a face that is turned to the eye and one that is not.
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
                    return;
                }
                let mut normal = [0.0; 3];
                (normal[i], normal[j]) = if inside < 0.0 { (-a, -b) } else { (a, b) };
                self.sides.push(HalfSpace { normal: DVec3::from_array(normal), offset: 0.0 });
            }
        }
        if self.sides.len() >= 3 {
            self.outline = Outline::Cone;
        }
    }

    /// Makes it that of a part inside a box. Its outline is `Everything` where it is not known well
    /// enough.
    ///
    /// With `room`, the outline holds only the directions whose rays keep farther than that from
    /// all edges of the silhouette.
    pub(crate) fn set_part(&mut self, part: &Part, block: Block, direction: Option<DVec3>, room: &Room) {
        self.clear(block);
        self.vertices.extend(part.corners());
        for face in part.faces() {
            let is_front = match direction {
                Some(d) => face.normal.dot(d) > 0.0,
                None => face.offset < 0.0,
            };
            self.turned.push(is_front);
            if is_front {
                self.fronts.push(face);
            }
        }
        if self.find_sides(part.edges, direction, room) && self.sides.len() >= 3 {
            self.outline = Outline::Cone;
        }
    }

    /// Empties the lists, for a shape in a box.
    fn clear(&mut self, block: Block) {
        (self.outline, self.block) = (Outline::Everything, block);
        self.sides.clear();
        self.fronts.clear();
        self.vertices.clear();
        self.turned.clear();
    }

    /// Finds the half-spaces along the edges of the silhouette. Returns whether all of them are
    /// known well enough.
    fn find_sides(&mut self, edges: &[[u16; 4]], direction: Option<DVec3>, room: &Room) -> bool {
        let Self { sides, vertices, turned, .. } = self;
        let center = vertices.iter().sum::<DVec3>() / vertices.len().max(1) as f64;
        for &[a, b, f, g] in edges {
            if turned[usize::from(f)] == turned[usize::from(g)] {
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
                return false;
            }
            let n = across / length;
            let h = if direction.is_some() { -n.dot(p) } else { 0.0 };
            let side = n.dot(center) + h;
            // A shape without width: which side is inside is rounding.
            if side.abs() < NO_WIDTH * largest {
                return false;
            }
            let (mut normal, offset) = if side < 0.0 { (-n, -h) } else { (n, h) };
            if room.radius() > 0.0 {
                let Some(turned) = turned_past(normal, p, edge, room) else { return false };
                if turned.dot(center) <= NO_WIDTH * largest {
                    sides.push(HalfSpace { normal, offset });
                }
                normal = turned;
            }
            sides.push(HalfSpace { normal, offset });
        }
        true
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
///
/// Behind the eye c . x is less than zero, and the plane is turned outwards. If the middle lies
/// inside all of the turned planes, no ray outside of the outline does: on the way to it from the
/// middle one leaves the outline across an edge, where c . x > 0, so that its turned plane is passed
/// there or before. Where the middle lies outside of a turned plane, which may be passed inwards
/// beyond the edge, the plane itself counts, too.
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

    /// Two ways to the same unit vector differ by some thousand units in the last place at most.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn boxes_have_the_outlines_of_their_polytopes() {
        let mut random = Random::new(5);
        let mut next = || random.next() - 0.5;
        let (mut own, mut other) = (Aspect::default(), Aspect::default());
        let mut cones = 0;
        for i in 0..2000 {
            let (a, b) = (DVec3::new(next(), next(), next()), DVec3::new(next(), next(), next()));
            let mut block = Block { min: a.min(b), max: a.max(b) };
            if i % 4 == 0 {
                // Flat.
                block.max[i / 4 % 3] = block.min[i / 4 % 3];
            }
            own.set_block(&block, None, &Room::NONE);
            let general = Polytope::block(&block);
            other.set_part(&general.part(DVec3::ZERO, DVec3::ZERO), block, None, &Room::NONE);
            assert_eq!(own.fronts, other.fronts);
            match (own.outline, other.outline) {
                (Outline::Cone, Outline::Cone) => {
                    cones += 1;
                    assert_eq!(own.sides.len(), other.sides.len());
                    let near = |a: &HalfSpace, b: &HalfSpace| (a.normal - b.normal).length() < ROUNDING;
                    assert!(own.sides.iter().all(|a| other.sides.iter().any(|b| near(a, b))), "{block:?}");
                }
                outlines => {
                    assert!(matches!(outlines, (Outline::Everything, Outline::Everything)), "{block:?}");
                }
            }
        }
        assert!(cones > 1000, "{cones}");
    }
}
