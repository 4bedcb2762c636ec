//! Solids and surfaces in double precision: whether they hide a segment, and points on them. This
//! file shares no code with the library.
//!
//! Long because every kind of solid is judged in one place, apart from the oracle.

use glam::{DAffine3, DMat3, DVec3};

use super::dice::Dice;
use super::forms::{Form, base};
use crate::numeric::attack::{ASKEW, ON_SOLID, ROOM, ROOM_COORDINATES, SKINS};

/// What a solid does to a segment; the worst is the greatest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
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
pub struct Edge {
    pub ends: [DVec3; 2],
    /// Normals of the faces beside it.
    pub normals: [Option<DVec3>; 2],
    /// A point of the solid, or of a face beside the edge.
    pub inner: DVec3,
}

/// All from the middle.
#[derive(Debug, Clone)]
enum Body {
    Ball,
    /// Outward unit normals and offsets.
    Convex(Vec<(DVec3, f64)>),
    Triangles(Vec<[DVec3; 3]>),
}

/// A solid or a surface.
#[derive(Debug, Clone)]
pub struct Solid {
    body: Body,
    /// None of a ball.
    pub edges: Vec<Edge>,
    /// Of the ball around it, or of it itself.
    pub middle: DVec3,
    pub radius: f64,
    /// Least and greatest corner of the box around it.
    pub extent: (DVec3, DVec3),
}

impl Solid {
    /// The true solid of a form.
    pub fn new(form: &Form) -> Self {
        match form {
            Form::Ball { center, radius } => {
                let (middle, radius) = (center.as_dvec3(), f64::from(*radius));
                let extent = (middle - radius, middle + radius);
                Self { body: Body::Ball, edges: Vec::new(), middle, radius, extent }
            }
            Form::Block { min, max } => {
                let (min, max) = (min.as_dvec3(), max.as_dvec3());
                Self::block((min + max) * 0.5, (max - min) * 0.5, DMat3::IDENTITY)
            }
            Form::Turned { center, half, turn } => {
                let turn = DMat3::from_quat(turn.as_dquat().normalize());
                Self::block(center.as_dvec3(), half.as_dvec3(), turn)
            }
            Form::Cut { min, max, cuts, by } => {
                let middle = (min.as_dvec3() + max.as_dvec3()) * 0.5;
                let outward = |p: &casca::Plane| {
                    let n = p.normal.as_dvec3();
                    let length = n.length();
                    (-n / length, (f64::from(p.offset) + n.dot(middle)) / length)
                };
                let planes = Form::planes(*min, *max, cuts).iter().map(outward).collect();
                Self::convex(middle + *by, planes)
            }
            Form::Hull { points, by } => {
                let middle = points.iter().map(|p| p.as_dvec3()).sum::<DVec3>() / points.len() as f64;
                let points: Vec<DVec3> = points.iter().map(|p| p.as_dvec3() - middle).collect();
                Self::convex(middle + *by, hull(&points))
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

    fn block(middle: DVec3, half: DVec3, turn: DMat3) -> Self {
        let planes = (0..3).flat_map(|i| [(turn.col(i), half[i]), (-turn.col(i), half[i])]);
        Self::convex(middle, planes.collect())
    }

    /// An intersection of half-spaces `normal . (p - origin) <= offset`.
    fn convex(origin: DVec3, mut planes: Vec<(DVec3, f64)>) -> Self {
        let mut corners = corners(&planes);
        let (min, max) = bounds(corners.iter().copied());
        let shift = if corners.is_empty() { DVec3::ZERO } else { (min + max) * 0.5 };
        planes.iter_mut().for_each(|(n, h)| *h -= n.dot(shift));
        corners.iter_mut().for_each(|p| *p -= shift);
        let middle = origin + shift;
        let radius = corners.iter().map(|p| p.length()).fold(0.0, f64::max);
        let on = |p: DVec3, (n, h): (DVec3, f64)| (n.dot(p) - h).abs() <= ON_SOLID * (radius + h.abs());
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
                    && (q - p).length() > ASKEW * radius
                {
                    let ends = [middle + p, middle + q];
                    edges.push(Edge { ends, normals: [Some(a.0), Some(b.0)], inner: middle });
                }
            }
        }
        let (min, max) = bounds(corners.into_iter().map(|p| middle + p));
        Self { body: Body::Convex(planes), edges, middle, radius, extent: (min, max) }
    }

    /// A mesh under a transform.
    pub fn mesh(positions: &[glam::Vec3], triangles: &[[u32; 3]], transform: DAffine3) -> Self {
        let corners: Vec<DVec3> =
            positions.iter().map(|p| transform.transform_point3(p.as_dvec3())).collect();
        let (min, max) = bounds(triangles.iter().flatten().map(|&v| corners[v as usize]));
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
        let radius = (max - min).length() * 0.5;
        Self { body: Body::Triangles(body), edges, middle, radius, extent: (min, max) }
    }

    pub fn is_ball(&self) -> bool {
        matches!(self.body, Body::Ball)
    }

    /// Whether a point may lie in it; of a mesh, in the box around it.
    pub fn may_hold(&self, point: DVec3) -> bool {
        if matches!(self.body, Body::Triangles(_)) {
            let (min, max) = self.extent;
            let room = ROOM * self.radius + ROOM_COORDINATES * point.abs().max_element();
            return (min - room).cmple(point).all() && point.cmple(max + room).all();
        }
        self.answer(point, point) != Answer::Free
    }

    /// How close to it a segment from `o` along `d`, both from the middle, is in doubt: beside the
    /// solid, one that goes on for long strays no farther than a short one.
    fn room(&self, o: DVec3, d: DVec3) -> f64 {
        let passed = d.length().min(o.length() + self.radius);
        let coordinates = (o + self.middle).abs().max_element() + self.middle.abs().max_element();
        ROOM * (o.length() + passed + self.radius) + ROOM_COORDINATES * coordinates
    }

    /// What it does to the segment between two points.
    pub fn answer(&self, from: DVec3, to: DVec3) -> Answer {
        let (o, d) = (from - self.middle, to - from);
        let (length, room) = (d.length(), self.room(o, d));
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
            Body::Convex(_) => {
                let meets = |grow| self.span(o, d, grow).is_some_and(|(near, far)| near <= 1.0 && far >= 0.0);
                if !meets(room) {
                    Answer::Free
                } else if meets(-room) {
                    Answer::Cut
                } else {
                    Answer::Doubt
                }
            }
            Body::Triangles(all) => {
                let mut answer = Answer::Free;
                for triangle in all {
                    match crosses(triangle, o, d, room) {
                        Answer::Cut => return Answer::Cut,
                        Answer::Doubt => answer = Answer::Doubt,
                        Answer::Free => {}
                    }
                }
                answer
            }
        }
    }

    /// Where a line `o + t * d` runs through the solid grown by `grow`; not for surfaces.
    fn span(&self, o: DVec3, d: DVec3, grow: f64) -> Option<(f64, f64)> {
        let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
        match &self.body {
            Body::Ball => {
                let (r, a, b) = (self.radius + grow, d.length_squared(), o.dot(d));
                let apart = (o - d * (b / a)).length_squared();
                if r < 0.0 || apart > r * r {
                    return None;
                }
                let half = ((r * r - apart) / a).sqrt();
                (near, far) = (-b / a - half, -b / a + half);
            }
            Body::Convex(planes) => {
                for &(n, h) in planes {
                    let (at, along, limit) = (n.dot(o), n.dot(d), h + grow);
                    if along > 0.0 {
                        far = far.min((limit - at) / along);
                    } else if along < 0.0 {
                        near = near.max((limit - at) / along);
                    } else if at > limit {
                        return None;
                    }
                }
            }
            Body::Triangles(_) => return None,
        }
        (near <= far).then_some((near, far))
    }

    /// Whether the solid may hide one end of a segment from the other: false where it surely does
    /// not. One sees out of a solid, and out of its skin.
    pub fn hides(&self, from: DVec3, to: DVec3) -> bool {
        if self.answer(from, to) == Answer::Free {
            return false;
        }
        let (o, d) = (from - self.middle, to - from);
        let room = self.room(o, d);
        match self.span(o, d, room) {
            Some((near, far)) if near < 0.0 => {
                let holds = self.span(o, d, -room).is_some_and(|(a, b)| a < 0.0 && 0.0 < b);
                // Where coordinates are that coarse, all of the solid is skin.
                let is_skin = SKINS * room > self.radius;
                is_skin || !holds && far * d.length() > SKINS * room
            }
            _ => true,
        }
    }

    /// A point of it, where an eye so far away along `towards`, of length 1, may see it first.
    pub fn point(&self, towards: DVec3, distance: f64, dice: &mut Dice) -> DVec3 {
        let mut unit = || f64::from(dice.unit());
        match &self.body {
            Body::Ball => {
                let (a, b) = towards.any_orthonormal_pair();
                let angle = unit() * std::f64::consts::TAU;
                let across = a * angle.cos() + b * angle.sin();
                // Mostly where sights touch the ball.
                let rim = if distance > self.radius { self.radius / distance } else { 0.0 };
                let height = if unit() < 0.7 { rim } else { 1.0 - unit() * (1.0 - rim) };
                let aside = (1.0 - height * height).max(0.0).sqrt();
                self.middle + (towards * height + across * aside) * self.radius
            }
            Body::Convex(_) if self.edges.is_empty() => self.middle,
            Body::Convex(_) => {
                // A corner, a point of an edge, or one between two edges.
                let kind = unit();
                let mut on_edge = || {
                    let [a, b] =
                        self.edges[(unit() * self.edges.len() as f64) as usize % self.edges.len()].ends;
                    if kind < 0.6 { a } else { a.lerp(b, unit()) }
                };
                let p = on_edge();
                if kind < 0.85 { p } else { p.midpoint(on_edge()) }
            }
            Body::Triangles(triangles) => {
                let [a, b, c] = triangles[(unit() * triangles.len() as f64) as usize % triangles.len()];
                if unit() < 0.5 {
                    return self.middle + a;
                }
                let (u, v) = (unit(), unit());
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                self.middle + a + (b - a) * u + (c - a) * v
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

/// The corners of an intersection of half-spaces around the origin.
fn corners(planes: &[(DVec3, f64)]) -> Vec<DVec3> {
    let size = planes.iter().map(|(_, h)| h.abs()).fold(0.0, f64::max);
    let mut corners = Vec::new();
    for (i, a) in planes.iter().enumerate() {
        for (j, b) in planes[..i].iter().enumerate() {
            for c in &planes[..j] {
                let volume = a.0.dot(b.0.cross(c.0));
                if volume.abs() < ASKEW {
                    continue;
                }
                let p = (b.0.cross(c.0) * a.1 + c.0.cross(a.0) * b.1 + a.0.cross(b.0) * c.1) / volume;
                let room = 10.0 * ON_SOLID * (size + p.abs().max_element());
                if planes.iter().all(|(n, h)| n.dot(p) <= h + room) {
                    corners.push(p);
                }
            }
        }
    }
    corners
}

/// The planes of the hull of points around the origin.
fn hull(points: &[DVec3]) -> Vec<(DVec3, f64)> {
    let size = points.iter().map(|p| p.length()).fold(0.0, f64::max);
    let mut planes: Vec<(DVec3, f64)> = Vec::new();
    for k in 0..points.len() {
        for j in 0..k {
            for i in 0..j {
                let n = (points[j] - points[i]).cross(points[k] - points[i]);
                let Some(n) = n.try_normalize() else { continue };
                for n in [n, -n] {
                    let h = n.dot(points[i]);
                    let outer = points.iter().all(|p| n.dot(*p) <= h + ON_SOLID * size);
                    if outer && planes.iter().all(|(m, _)| m.dot(n) < 1.0 - ON_SOLID) {
                        planes.push((n, h));
                    }
                }
            }
        }
    }
    planes
}

/// What a triangle does to the segment from `o` along `d`.
fn crosses([a, b, c]: &[DVec3; 3], o: DVec3, d: DVec3, room: f64) -> Answer {
    let normal = (*b - *a).cross(*c - *a);
    let area = normal.length();
    // A triangle without area hides nothing.
    if area == 0.0 {
        return Answer::Free;
    }
    let before = normal.dot(o - *a) / area;
    let behind = normal.dot(o + d - *a) / area;
    let length = d.length();
    // The end is rounded where it is.
    let far = room.max(ROOM * length);
    if before > room && behind > far || before < -room && behind < -far {
        return Answer::Free;
    }
    // How far the line passes each edge, times the sine between the two, and on which side.
    let past = |p: DVec3, q: DVec3| {
        let edge = q - p;
        (p - o).dot(d.cross(edge)) / (length * edge.length())
    };
    let sides = [past(*a, *b), past(*b, *c), past(*c, *a)];
    let (least, most) = (sides[0].min(sides[1]).min(sides[2]), sides[0].max(sides[1]).max(sides[2]));
    let through = before > room && behind < -far || before < -room && behind > far;
    if least < -room && most > room {
        Answer::Free
    } else if (least > room || most < -room) && through {
        Answer::Cut
    } else {
        Answer::Doubt
    }
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Quat, Vec3};

    use super::super::grazing::Start;
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
            let solid = Solid::new(&form);
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

    #[test]
    fn what_is_very_far_away_is_hidden_as_what_is_near() {
        let (center, half) = (Vec3::new(18.0, -995.0, 1017.5), Vec3::new(16.0, 4.5, 2.0));
        let turn = Quat::from_rotation_y(-0.1);
        let transform = Affine3A::from_scale_rotation_translation(half, turn, center);
        for form in [Form::Turned { center, half, turn }, Form::Placed { base: 0, transform }] {
            let solid = Solid::new(&form);
            for far in [1e2, 1e5, 3e9, 1e18] {
                let hides = |side: f64| {
                    let eye = DVec3::new(12.0, -998.0, 1018.0 + side * 3.0);
                    solid.hides(eye, eye + DVec3::X * far)
                };
                assert_eq!([hides(0.8), hides(-1.2)], [true, false], "{form:?} {far}");
            }
        }
    }

    #[test]
    fn one_sees_out_of_a_solid_and_off_its_faces() {
        let center = Vec3::new(3.0, 0.0, 0.0);
        let block = Form::Block { min: Vec3::ZERO, max: Vec3::splat(2.0) };
        let flat = Form::Block { min: Vec3::ZERO, max: Vec3::new(2.0, 2.0, 0.0) };
        for (form, eye, to, hidden) in [
            (&block, DVec3::splat(1.0), DVec3::splat(9.0), false),
            (&block, DVec3::new(2.0, 1.0, 1.0), DVec3::new(9.0, 1.0, 1.0), false),
            (&block, DVec3::new(2.0, 1.0, 1.0), DVec3::new(-9.0, 1.0, 1.0), true),
            (&flat, DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, 1.0, 9.0), false),
            (&flat, DVec3::new(1.0, 1.0, 1e-9), DVec3::new(1.0, 1.0, -9.0), true),
            (&Form::Ball { center, radius: 1.0 }, DVec3::X * 3.5, DVec3::X * 9.0, false),
            (&Form::Ball { center, radius: 1.0 }, DVec3::X * 4.0, DVec3::X * 9.0, false),
            (&Form::Ball { center, radius: 1.0 }, DVec3::X * 4.0, DVec3::X * -9.0, true),
        ] {
            assert_eq!(Solid::new(form).hides(eye, to), hidden, "{form:?} {eye} {to}");
        }
    }
}
