//! Solids in double precision, where rays meet them, and points on them. Shares no code with the
//! library.

use casca::Plane;
use glam::{DAffine3, DMat3, DVec3};

use super::dice::Dice;
use super::forms::{Form, base};
use crate::numeric::attack::{
    ALONG_TRIANGLE, END, GROW, GROW_DISTANCE, GROW_REACH, GROW_TRIANGLE, ON_HULL, SKINS,
};

/// A solid or a surface.
#[derive(Debug, Clone)]
enum Solid {
    Ball {
        radius: f64,
    },
    /// In its own axes, which are those of the world for a plain box.
    Block {
        half: DVec3,
        turn: Option<DMat3>,
    },
    /// Outward unit normals and offsets from the middle.
    Convex(Vec<(DVec3, f64)>),
    Triangles(Vec<[DVec3; 3]>),
}

/// A form in double precision. All is relative to its middle.
#[derive(Debug, Clone)]
pub struct Body {
    solid: Solid,
    /// Its middle.
    pub middle: DVec3,
    /// A ball of this radius holds it.
    pub radius: f64,
}

/// A straight line of sight from an eye to a target, seen from `start` on, as a share of the way.
#[derive(Debug, Clone, Copy)]
pub struct Sight {
    /// The eye.
    pub eye: DVec3,
    /// From the eye to the target.
    pub way: DVec3,
    /// What lies before this share of the way is cut away.
    pub start: f64,
}

impl Body {
    /// The true solid of a form.
    pub fn new(form: &Form) -> Self {
        match form {
            Form::Ball { center, radius } => {
                let radius = f64::from(*radius);
                Self { solid: Solid::Ball { radius }, middle: center.as_dvec3(), radius }
            }
            Form::Block { min, max } => {
                let (min, max) = (min.as_dvec3(), max.as_dvec3());
                let half = (max - min) * 0.5;
                Self {
                    solid: Solid::Block { half, turn: None },
                    middle: (min + max) * 0.5,
                    radius: half.length(),
                }
            }
            Form::Turned { center, half, turn } => {
                let half = half.as_dvec3();
                let turn = Some(DMat3::from_quat(turn.as_dquat().normalize()));
                Self { solid: Solid::Block { half, turn }, middle: center.as_dvec3(), radius: half.length() }
            }
            Form::Cut { min, max, cuts, by } => {
                let middle = (min.as_dvec3() + max.as_dvec3()) * 0.5;
                let radius = (max.as_dvec3() - min.as_dvec3()).length() * 0.5;
                let outward = |p: &Plane| {
                    let n = p.normal.as_dvec3();
                    let length = n.length();
                    (-n / length, (f64::from(p.offset) + n.dot(middle)) / length)
                };
                let planes = Form::planes(*min, *max, cuts).iter().map(outward).collect();
                Self { solid: Solid::Convex(planes), middle: middle + *by, radius }
            }
            Form::Hull { points, by } => Self::hull(points.iter().map(|p| p.as_dvec3()).collect(), *by),
            Form::Mesh { base: which, center, scale } => {
                let (positions, triangles) = base(*which);
                let positions = Form::positions(&positions, *center, *scale);
                let corners = |t: &[u32; 3]| t.map(|v| positions[v as usize].as_dvec3());
                Self::surface(triangles.iter().map(corners).collect())
            }
            Form::Placed { base: which, transform } => {
                let (positions, triangles) = base(*which);
                let affine = DAffine3::from_mat3_translation(
                    glam::Mat3::from(transform.matrix3).as_dmat3(),
                    glam::Vec3::from(transform.translation).as_dvec3(),
                );
                let place = |v: u32| affine.transform_point3(positions[v as usize].as_dvec3());
                Self::surface(triangles.iter().map(|t| t.map(place)).collect())
            }
        }
    }

    fn surface(mut triangles: Vec<[DVec3; 3]>) -> Self {
        let all = || triangles.iter().flatten();
        let (min, max) =
            all().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| (a.min(*p), b.max(*p)));
        let middle = (min + max) * 0.5;
        triangles.iter_mut().flatten().for_each(|p| *p -= middle);
        Self { solid: Solid::Triangles(triangles), middle, radius: (max - min).length() * 0.5 }
    }

    fn hull(points: Vec<DVec3>, by: DVec3) -> Self {
        let middle = points.iter().sum::<DVec3>() / points.len() as f64;
        let points: Vec<DVec3> = points.iter().map(|&p| p - middle).collect();
        let radius = points.iter().map(|p| p.length()).fold(0.0, f64::max);
        let mut planes = Vec::new();
        for k in 0..points.len() {
            for j in 0..k {
                for i in 0..j {
                    let n = (points[j] - points[i]).cross(points[k] - points[i]);
                    let Some(n) = n.try_normalize() else { continue };
                    for n in [n, -n] {
                        let h = n.dot(points[i]);
                        if points.iter().all(|p| n.dot(*p) <= h + ON_HULL * radius) {
                            planes.push((n, h));
                        }
                    }
                }
            }
        }
        Self { solid: Solid::Convex(planes), middle: middle + by, radius }
    }

    /// Where a line `o + t * d` runs through the solid grown by `grow`; not for surfaces.
    fn span(&self, o: DVec3, d: DVec3, grow: f64) -> Option<(f64, f64)> {
        let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
        // Keeps the part where `at + t * along <= limit`.
        let mut keep = |at: f64, along: f64, limit: f64| {
            if along > 0.0 {
                far = far.min((limit - at) / along);
            } else if along < 0.0 {
                near = near.max((limit - at) / along);
            } else if at > limit {
                far = f64::NEG_INFINITY;
            }
        };
        match &self.solid {
            Solid::Ball { radius } => {
                let r = radius + grow;
                let (a, b) = (d.length_squared(), o.dot(d));
                // The square of the distance of the line from the middle, without cancellation.
                let apart = (o - d * (b / a)).length_squared();
                if r < 0.0 || apart > r * r {
                    return None;
                }
                let half = ((r * r - apart) / a).sqrt();
                (near, far) = (-b / a - half, -b / a + half);
            }
            Solid::Block { half, turn } => {
                let own = |v: DVec3| {
                    turn.map_or(v, |t| DVec3::new(t.x_axis.dot(v), t.y_axis.dot(v), t.z_axis.dot(v)))
                };
                let (o, d) = (own(o), own(d));
                for i in 0..3 {
                    keep(o[i], d[i], half[i] + grow);
                    keep(-o[i], -d[i], half[i] + grow);
                }
            }
            Solid::Convex(planes) => planes.iter().for_each(|&(n, h)| keep(n.dot(o), n.dot(d), h + grow)),
            Solid::Triangles(_) => return None,
        }
        (near <= far).then_some((near, far))
    }

    /// Whether the body, moved by `drift`, may hide the target of a sight: false where it surely
    /// does not.
    pub fn hides(&self, drift: DVec3, sight: &Sight) -> bool {
        let (o, d) = (sight.eye - self.middle - drift, sight.way);
        let length = d.length();
        let reach = sight.eye.abs().max_element();
        // Beside the body, a sight that goes on for long strays no farther than a short one.
        let passed = length.min(o.length() + self.radius);
        let grow = GROW * self.radius + GROW_DISTANCE * passed + GROW_REACH * reach;
        let nearest = (-o.dot(d) / d.length_squared()).clamp(sight.start, 1.0);
        let around = self.radius + grow;
        if (o + d * nearest).length_squared() > around * around {
            return false;
        }
        // Where coordinates are that coarse, all of the solid is skin: neither answer is sure.
        if SKINS * grow > self.radius {
            return true;
        }
        if let Solid::Triangles(triangles) = &self.solid {
            return triangles.iter().any(|t| crosses(t, o, d, sight.start, grow));
        }
        let Some((near, far)) = self.span(o, d, grow) else { return false };
        if far <= sight.start || near >= 1.0 + END {
            return false;
        }
        if near >= sight.start {
            return true;
        }
        // The sight starts in the grown solid: one sees out of a solid, and is in doubt in its
        // skin.
        let inside = self.span(o, d, -grow).is_some_and(|(a, b)| a < sight.start && sight.start < b);
        !inside && (far - sight.start) * length > SKINS * grow
    }

    /// Half the edges of the box along the axes around its middle; not for polytopes, which are no
    /// bounds.
    pub fn extent(&self) -> DVec3 {
        match &self.solid {
            Solid::Ball { radius } => DVec3::splat(*radius),
            Solid::Block { half, turn: None } => *half,
            Solid::Block { half, turn: Some(t) } => {
                t.x_axis.abs() * half.x + t.y_axis.abs() * half.y + t.z_axis.abs() * half.z
            }
            Solid::Convex(_) => DVec3::ZERO,
            Solid::Triangles(all) => all.iter().flatten().fold(DVec3::ZERO, |most, p| most.max(p.abs())),
        }
    }

    /// A point of the body, where an eye at `eye` (or infinitely far along `-towards`) first sees
    /// it.
    pub fn point(&self, towards: DVec3, distance: f64, dice: &mut Dice) -> DVec3 {
        let mut unit = || f64::from(dice.unit());
        match &self.solid {
            Solid::Ball { radius } => {
                let (a, b) = towards.any_orthonormal_pair();
                let angle = unit() * std::f64::consts::TAU;
                let across = a * angle.cos() + b * angle.sin();
                // Mostly where sights touch the ball.
                let rim = if distance > *radius { radius / distance } else { 0.0 };
                let height = if unit() < 0.7 { rim } else { 1.0 - unit() * (1.0 - rim) };
                self.middle + (towards * height + across * (1.0 - height * height).max(0.0).sqrt()) * *radius
            }
            Solid::Block { half, turn } => {
                let mut own = DVec3::ZERO;
                for i in 0..3 {
                    own[i] = half[i] * if unit() < 0.5 { -1.0 } else { 1.0 };
                }
                if unit() < 0.4 {
                    // On an edge or a face instead of a corner.
                    for i in 0..3 {
                        if unit() < 0.5 {
                            own[i] *= unit();
                        }
                    }
                }
                self.middle + turn.map_or(own, |t| t * own)
            }
            Solid::Convex(_) => self.middle,
            Solid::Triangles(triangles) => {
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

/// Whether the line `o + t * d` may cross a triangle between `start` and its end.
fn crosses([a, b, c]: &[DVec3; 3], o: DVec3, d: DVec3, start: f64, grow: f64) -> bool {
    let (e, f) = (*b - *a, *c - *a);
    let n = e.cross(f);
    let along = n.dot(d);
    if along.abs() <= ALONG_TRIANGLE * n.length() * d.length() {
        // Also triangles without area: in doubt if the line comes close.
        return n.length() > 0.0 && (n.dot(o - *a) / n.length()).abs() <= grow + ALONG_TRIANGLE * d.length();
    }
    let t = n.dot(*a - o) / along;
    if t <= start - END || t >= 1.0 + END {
        return false;
    }
    // Barycentric coordinates of the point, by areas.
    let p = o + d * t - *a;
    let square = n.length_squared();
    let (u, v) = (n.dot(p.cross(f)) / square, n.dot(e.cross(p)) / square);
    u >= -GROW_TRIANGLE && v >= -GROW_TRIANGLE && u + v <= 1.0 + GROW_TRIANGLE
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3};

    use super::*;

    #[test]
    fn what_is_very_far_away_is_hidden_as_what_is_near() {
        let (center, half) = (Vec3::new(18.0, -995.0, 1017.5), Vec3::new(16.0, 4.5, 2.0));
        let body = Body::new(&Form::Turned { center, half, turn: Quat::from_rotation_y(-0.1) });
        for far in [1e2, 1e5, 3e9, 1e18] {
            let hides = |side: f64| {
                let eye = DVec3::new(12.0, -998.0, 1018.0 + side * 3.0);
                let way = DVec3::X * far;
                body.hides(DVec3::ZERO, &Sight { eye, way, start: 0.0 })
            };
            assert_eq!([hides(0.8), hides(-1.2)], [true, false], "{far}");
        }
    }
}
