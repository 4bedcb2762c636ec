//! Solids and surfaces in double precision: which segments they cut, and where eyes look past them.
//! Shares no code with the library.

mod rims;

use glam::{DAffine3, DMat3, DVec3};

use super::super::forms::{Form, base};
use crate::numeric::attack::{ASKEW, ON_SOLID, ROOM, ROOM_COORDINATES};

/// Where rays start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// At an eye.
    Eye(DVec3),
    /// This far before each point, along a direction of length 1.
    Before(DVec3, f64),
}

impl Start {
    /// The direction of the ray to a point, of any length.
    pub fn toward(&self, point: DVec3) -> DVec3 {
        match *self {
            Self::Eye(eye) => point - eye,
            Self::Before(along, far) => along * far,
        }
    }
}

/// What a body does to a segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    /// It is nowhere near it.
    Free,
    /// Rounding leaves it open.
    Doubt,
    /// It cuts it.
    Cut,
}

/// An edge of a polytope or a mesh.
#[derive(Debug, Clone)]
struct Edge {
    ends: [DVec3; 2],
    /// Normals of the faces beside it.
    normals: [Option<DVec3>; 2],
    /// A point of the solid, or of a face beside the edge.
    inner: DVec3,
}

#[derive(Debug, Clone)]
enum Body {
    Ball,
    /// Outward unit normals, and offsets from the middle.
    Convex(Vec<(DVec3, f64)>),
    /// Triangles, from the middle.
    Triangles(Vec<[DVec3; 3]>),
}

/// A solid or a surface.
#[derive(Debug, Clone)]
pub struct Solid {
    body: Body,
    edges: Vec<Edge>,
    /// A ball around it, or it itself.
    pub middle: DVec3,
    /// Its radius.
    pub radius: f64,
}

impl Solid {
    /// The true solid of a form.
    pub fn of(form: &Form) -> Self {
        match form {
            Form::Ball { center, radius } => Self {
                body: Body::Ball,
                edges: Vec::new(),
                middle: center.as_dvec3(),
                radius: f64::from(*radius),
            },
            Form::Block { min, max } => {
                let planes = (0..3).flat_map(|i| {
                    let axis = DVec3::AXES[i];
                    [(axis, f64::from(max[i])), (-axis, -f64::from(min[i]))]
                });
                Self::convex(planes.collect())
            }
            Form::Turned { center, half, turn } => {
                let (center, turn) = (center.as_dvec3(), DMat3::from_quat(turn.as_dquat().normalize()));
                let planes = (0..3).flat_map(|i| {
                    let (axis, half) = (turn.col(i), f64::from(half[i]));
                    [(axis, axis.dot(center) + half), (-axis, half - axis.dot(center))]
                });
                Self::convex(planes.collect())
            }
            Form::Cut { min, max, cuts, by } => {
                let outward = |p: &casca::Plane| {
                    let n = p.normal.as_dvec3();
                    let length = n.length();
                    (-n / length, (f64::from(p.offset) - n.dot(*by)) / length)
                };
                Self::convex(Form::planes(*min, *max, cuts).iter().map(outward).collect())
            }
            Form::Hull { points, by } => {
                Self::convex(hull(&points.iter().map(|p| p.as_dvec3() + *by).collect::<Vec<_>>()))
            }
            Form::Mesh { base: which, center, scale } => {
                let (positions, triangles) = base(*which);
                Self::mesh(&Form::positions(&positions, *center, *scale), &triangles, DAffine3::IDENTITY)
            }
            Form::Placed { base: which, transform } => {
                let (positions, triangles) = base(*which);
                Self::mesh(&positions, &triangles, exact(*transform))
            }
        }
    }

    /// An intersection of half-spaces `normal . p <= offset`.
    fn convex(planes: Vec<(DVec3, f64)>) -> Self {
        let corners = corners(&planes);
        let (min, max) = bounds(corners.iter().copied());
        let middle = (min + max) * 0.5;
        let size = (max - min).length();
        let on = |p: DVec3, (n, h): (DVec3, f64)| (n.dot(p) - h).abs() <= ON_SOLID * (size + h.abs());
        let mut edges = Vec::new();
        for (i, &a) in planes.iter().enumerate() {
            for &b in &planes[i + 1..] {
                let along = a.0.cross(b.0);
                if along.length() < ASKEW {
                    continue;
                }
                let shared = || corners.iter().copied().filter(|&p| on(p, a) && on(p, b));
                let least = shared().min_by(|p, q| along.dot(*p).total_cmp(&along.dot(*q)));
                let most = shared().max_by(|p, q| along.dot(*p).total_cmp(&along.dot(*q)));
                if let (Some(p), Some(q)) = (least, most)
                    && (q - p).length() > ASKEW * size
                {
                    edges.push(Edge { ends: [p, q], normals: [Some(a.0), Some(b.0)], inner: middle });
                }
            }
        }
        let planes = planes.into_iter().map(|(n, h)| (n, h - n.dot(middle))).collect();
        Self { body: Body::Convex(planes), edges, middle, radius: size * 0.5 }
    }

    /// A mesh under a transform.
    pub fn mesh(positions: &[glam::Vec3], triangles: &[[u32; 3]], transform: DAffine3) -> Self {
        let corners: Vec<DVec3> =
            positions.iter().map(|p| transform.transform_point3(p.as_dvec3())).collect();
        let used = triangles.iter().flatten().map(|&v| corners[v as usize]);
        let (min, max) = bounds(used);
        let middle = (min + max) * 0.5;
        let mut sides: Vec<([u32; 2], usize)> = Vec::new();
        for (i, [a, b, c]) in triangles.iter().enumerate() {
            for [a, b] in [[a, b], [b, c], [c, a]] {
                sides.push(([*a.min(b), *a.max(b)], i));
            }
        }
        sides.sort_unstable();
        let normal = |i: usize| {
            let [a, b, c] = triangles[i].map(|v| corners[v as usize]);
            (b - a).cross(c - a).try_normalize()
        };
        let mut edges = Vec::new();
        for run in sides.chunk_by(|a, b| a.0 == b.0) {
            let ([a, b], i) = run[0];
            let third = triangles[i].into_iter().find(|v| *v != a && *v != b);
            let Some(third) = third else { continue };
            let normals = [normal(i), run.get(1).and_then(|&(_, j)| normal(j))];
            let ends = [a, b].map(|v| corners[v as usize]);
            edges.push(Edge { ends, normals, inner: corners[third as usize] });
        }
        let body = triangles.iter().map(|t| t.map(|v| corners[v as usize] - middle)).collect();
        Self { body: Body::Triangles(body), edges, middle, radius: (max - min).length() * 0.5 }
    }

    /// Whether it has an outline.
    pub fn has_rim(&self) -> bool {
        matches!(self.body, Body::Ball) || !self.edges.is_empty()
    }

    /// The corners of the box around it.
    pub fn extent(&self) -> (DVec3, DVec3) {
        match self.body {
            Body::Ball => (self.middle - self.radius, self.middle + self.radius),
            _ => bounds(self.edges.iter().flat_map(|e| e.ends)),
        }
    }

    /// Whether a point may lie in it; of a mesh, in the box around it.
    pub fn may_hold(&self, point: DVec3) -> bool {
        if matches!(self.body, Body::Triangles(_)) {
            let (min, max) = self.extent();
            let room = ROOM * self.radius + ROOM_COORDINATES * point.abs().max_element();
            return (min - room).cmple(point).all() && point.cmple(max + room).all();
        }
        self.answer(point, point) != Answer::Free
    }

    /// What it does to the segment between two points.
    pub fn answer(&self, from: DVec3, to: DVec3) -> Answer {
        let (o, d) = (from - self.middle, to - from);
        let length = d.length();
        let room = ROOM * (o.length() + length + self.radius)
            + ROOM_COORDINATES * (from.abs().max_element() + self.middle.abs().max_element());
        let nearest = if length > 0.0 { (-o.dot(d) / (length * length)).clamp(0.0, 1.0) } else { 0.0 };
        // Without cancellation: the distance of the line.
        let apart = if nearest > 0.0 && nearest < 1.0 {
            o.cross(d).length() / length
        } else {
            (o + d * nearest).length()
        };
        if apart > self.radius + room {
            return Answer::Free;
        }
        match &self.body {
            Body::Ball if apart < self.radius - room => Answer::Cut,
            Body::Ball => Answer::Doubt,
            Body::Convex(planes) => {
                if !clips(planes, o, d, room) {
                    Answer::Free
                } else if clips(planes, o, d, -room) {
                    Answer::Cut
                } else {
                    Answer::Doubt
                }
            }
            Body::Triangles(all) => {
                let mut answer = Answer::Free;
                for triangle in all {
                    match crosses(triangle, o, d, length, room) {
                        Answer::Cut => return Answer::Cut,
                        Answer::Doubt => answer = Answer::Doubt,
                        Answer::Free => {}
                    }
                }
                answer
            }
        }
    }
}

/// A transform in double precision.
pub fn exact(transform: glam::Affine3A) -> DAffine3 {
    DAffine3::from_mat3_translation(
        glam::Mat3::from(transform.matrix3).as_dmat3(),
        glam::Vec3::from(transform.translation).as_dvec3(),
    )
}

fn bounds(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)))
}

/// The corners of an intersection of half-spaces.
fn corners(planes: &[(DVec3, f64)]) -> Vec<DVec3> {
    let mut corners = Vec::new();
    for (i, a) in planes.iter().enumerate() {
        for (j, b) in planes[..i].iter().enumerate() {
            for c in &planes[..j] {
                let volume = a.0.dot(b.0.cross(c.0));
                if volume.abs() < ASKEW {
                    continue;
                }
                let p = (b.0.cross(c.0) * a.1 + c.0.cross(a.0) * b.1 + a.0.cross(b.0) * c.1) / volume;
                let room = ON_SOLID * (1.0 + p.abs().max_element());
                if planes.iter().all(|(n, h)| n.dot(p) <= h + room) {
                    corners.push(p);
                }
            }
        }
    }
    corners
}

/// The planes of the hull of points.
fn hull(points: &[DVec3]) -> Vec<(DVec3, f64)> {
    let (min, max) = bounds(points.iter().copied());
    let (middle, size) = ((min + max) * 0.5, (max - min).length());
    let mut planes: Vec<(DVec3, f64)> = Vec::new();
    for k in 0..points.len() {
        for j in 0..k {
            for i in 0..j {
                let n = (points[j] - points[i]).cross(points[k] - points[i]);
                let Some(n) = n.try_normalize() else { continue };
                for n in [n, -n] {
                    let h = n.dot(points[i] - middle);
                    let outer = points.iter().all(|p| n.dot(*p - middle) <= h + ON_SOLID * size);
                    if outer && planes.iter().all(|(m, _)| m.dot(n) < 1.0 - ON_SOLID) {
                        planes.push((n, h + n.dot(middle)));
                    }
                }
            }
        }
    }
    planes
}

/// Whether a segment meets an intersection of half-spaces that are `grow` larger.
fn clips(planes: &[(DVec3, f64)], o: DVec3, d: DVec3, grow: f64) -> bool {
    let (mut near, mut far) = (0f64, 1f64);
    for &(n, h) in planes {
        let (at, along, limit) = (n.dot(o), n.dot(d), h + grow);
        if along > 0.0 {
            far = far.min((limit - at) / along);
        } else if along < 0.0 {
            near = near.max((limit - at) / along);
        } else if at > limit {
            return false;
        }
    }
    near <= far
}

/// What a triangle does to the segment from `o` along `d`.
fn crosses([a, b, c]: &[DVec3; 3], o: DVec3, d: DVec3, length: f64, room: f64) -> Answer {
    let normal = (*b - *a).cross(*c - *a);
    let area = normal.length();
    // A triangle without area hides nothing.
    if area == 0.0 {
        return Answer::Free;
    }
    let before = normal.dot(o - *a) / area;
    let behind = normal.dot(o + d - *a) / area;
    if before.min(behind) > room || before.max(behind) < -room {
        return Answer::Free;
    }
    // How far the line passes each edge, times the sine between the two, and on which side.
    let past = |p: DVec3, q: DVec3| {
        let edge = q - p;
        (p - o).dot(d.cross(edge)) / (length * edge.length())
    };
    let sides = [past(*a, *b), past(*b, *c), past(*c, *a)];
    let (least, most) = (sides[0].min(sides[1]).min(sides[2]), sides[0].max(sides[1]).max(sides[2]));
    if least < -room && most > room {
        Answer::Free
    } else if (least > room || most < -room) && before.min(behind) < -room && before.max(behind) > room {
        Answer::Cut
    } else {
        Answer::Doubt
    }
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Quat, Vec3};

    use super::super::super::dice::Dice;
    use super::*;

    fn all() -> Vec<Form> {
        let turn = Quat::from_rotation_y(0.7);
        let hull = (0..9).map(|i| {
            let a = i as f32;
            Vec3::new(a.sin(), (2.3 * a).cos(), (1.7 * a).sin())
        });
        let transform = Affine3A::from_scale_rotation_translation(Vec3::new(1.0, -0.5, 2.0), turn, Vec3::Y);
        let mut forms = vec![
            Form::Ball { center: Vec3::X, radius: 1.0 },
            Form::Block { min: Vec3::NEG_ONE, max: Vec3::new(1.0, 2.0, 0.5) },
            Form::Turned { center: Vec3::Y, half: Vec3::new(1.0, 0.5, 2.0), turn },
            Form::Cut {
                min: Vec3::NEG_ONE,
                max: Vec3::ONE,
                cuts: vec![(Vec3::new(0.6, 0.8, 0.0), 0.7)],
                by: DVec3::ZERO,
            },
            Form::Hull { points: hull.collect(), by: DVec3::ZERO },
        ];
        forms.extend((0..7).map(|base| Form::Placed { base, transform }));
        forms
    }

    /// Segments just past the outline of convex solids are free, those just inside are cut.
    #[test]
    fn outlines_part_what_is_cut_from_what_is_free() {
        let mut dice = Dice::new(3);
        for (number, form) in all().into_iter().enumerate() {
            let solid = Solid::of(&form);
            // Only of convex ones each outline is a border.
            let convex = number < 7;
            for start in [Start::Eye(DVec3::new(9.0, 5.0, 7.0)), Start::Before(DVec3::NEG_Z, 50.0)] {
                let mut found = 0;
                for round in 0..400 {
                    let Some((point, out)) = solid.rim(&start, &mut dice) else { continue };
                    let gap = [1e-9, 1e-5, 1e-2][round % 3];
                    let answer = |aside: f64| {
                        let aim = point + out * aside;
                        let ray = start.toward(aim);
                        let far = if matches!(start, Start::Eye(_)) { 1.5 } else { 1.2 };
                        solid.answer(aim - ray, aim + ray * (far - 1.0))
                    };
                    found += 1;
                    if convex {
                        assert_eq!(answer(gap), Answer::Free, "{form:?} {gap} {start:?} {point}");
                        // Next to a corner the point on the other side may be outside, too.
                        let corners = solid.edges.iter().flat_map(|edge| edge.ends);
                        let at_corner = corners.into_iter().any(|c| c.distance(point) < 50.0 * gap);
                        let inside = answer(-gap);
                        assert!(at_corner || inside != Answer::Free, "{form:?} {gap} {start:?} {point}");
                    }
                }
                assert!(found > 200 || number >= 9, "{form:?}: {found}");
            }
        }
    }
}
