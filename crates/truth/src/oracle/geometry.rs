//! Exact geometry in f64: primitives and where rays enter them.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DAffine3, DVec3};

use crate::numeric::oracle::{
    BOX_PLACE, BOX_SIZE, CLOSE_TRIANGLE, GROW, GROW_DISTANCE, GROW_TRIANGLE, INVERSE_OF_NO_STEP, NO_STEP,
};
use casca_scenes::world::{Mesh, Object, Shape, Sides};

/// What a ray can hit, in world space.
#[derive(Debug, Clone, Copy)]
pub enum Primitive {
    /// A solid ball.
    Sphere {
        /// Its centre.
        center: DVec3,
        /// Its radius.
        radius: f64,
    },
    /// A solid box.
    Box {
        /// Its least corner.
        min: DVec3,
        /// Its greatest corner.
        max: DVec3,
    },
    /// The corners of a triangle.
    Triangle([DVec3; 3]),
}

impl Primitive {
    /// The solid or, for a mesh, the triangle with this number.
    pub(super) fn of(shape: &Shape, triangle: u32) -> Self {
        match shape {
            Shape::Sphere { center, radius } => {
                Self::Sphere { center: center.as_dvec3(), radius: f64::from(*radius) }
            }
            Shape::Box { min, max } => Self::Box { min: min.as_dvec3(), max: max.as_dvec3() },
            Shape::Mesh { mesh, transform } => {
                Self::Triangle(corners(mesh, &transform.as_daffine3(), triangle as usize))
            }
        }
    }

    /// Whether it is a solid that holds a point.
    pub(super) fn holds(&self, point: DVec3) -> bool {
        match *self {
            Self::Sphere { center, radius } => (point - center).length_squared() < radius * radius,
            Self::Box { min, max } => min.cmplt(point).all() && point.cmplt(max).all(),
            Self::Triangle(_) => false,
        }
    }

    /// Least and greatest corner of the box around it.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        match *self {
            Self::Sphere { center, radius } => (center - radius, center + radius),
            Self::Box { min, max } => (min, max),
            Self::Triangle([a, b, c]) => (a.min(b).min(c), a.max(b).max(c)),
        }
    }

    /// Whether it is finite, and a box the right way round.
    pub(super) fn is_sound(&self) -> bool {
        let (min, max) = self.bounds();
        min.is_finite() && max.is_finite() && min.cmple(max).all()
    }

    /// Where the ray `origin + t * step`, t >= 0, enters a solid from outside
    /// or crosses a triangle. A solid that holds the origin is not entered.
    ///
    /// With `grown`, spheres and boxes are grown by 1e-7 of their size plus
    /// 1e-9 of their distance, and triangles by 1e-7 in barycentric
    /// coordinates.
    #[inline]
    pub fn enter(&self, origin: DVec3, step: DVec3, grown: bool) -> Option<f64> {
        match *self {
            Self::Sphere { center, radius } => {
                let to_center = center - origin;
                let along = to_center.dot(step);
                if along <= 0.0 {
                    return None;
                }
                let square = to_center.length_squared();
                let mut r = radius;
                if grown {
                    r += GROW * radius + GROW_DISTANCE * to_center.abs().element_sum();
                }
                let mut outside = square - r * r;
                if outside < 0.0 {
                    // In the grown shell the true sphere decides.
                    outside = square - radius * radius;
                    if outside < 0.0 {
                        return None;
                    }
                }
                let rest = along * along - step.length_squared() * outside;
                (rest >= 0.0).then(|| outside / (along + rest.sqrt()))
            }
            Self::Box { min, max } => {
                let inverse = safe_inverse(step);
                if grown {
                    let (low, high) = (min - origin, max - origin);
                    let margin =
                        (high - low) * GROW + low.abs().max(high.abs()).max_element() * GROW_DISTANCE;
                    let (low, high) = (low - margin, high + margin);
                    if low.max_element() >= 0.0 || high.min_element() <= 0.0 {
                        return enter_slabs(low, high, inverse);
                    }
                    // In the grown shell the true box decides.
                }
                enter_slabs(min - origin, max - origin, inverse)
            }
            Self::Triangle([a, b, c]) => {
                let (ab, ac) = (b - a, c - a);
                let across = step.cross(ac);
                let det = ab.dot(across);
                if det == 0.0 {
                    return None;
                }
                let scale = 1.0 / det;
                let slack = if grown { -GROW_TRIANGLE } else { -CLOSE_TRIANGLE };
                let from = origin - a;
                let u = from.dot(across) * scale;
                if u < slack {
                    return None;
                }
                let turned = from.cross(ab);
                let v = step.dot(turned) * scale;
                // Not written as a plain comparison so that NaN misses.
                if !(v >= slack && u + v <= 1.0 - slack) {
                    return None;
                }
                let t = ac.dot(turned) * scale;
                (t >= 0.0).then_some(t)
            }
        }
    }
}

/// One over each component, with a huge number for zero, so that the product
/// with a distance of zero is zero.
#[inline]
pub(super) fn safe_inverse(step: DVec3) -> DVec3 {
    let invert = |v: f64| if v.abs() < NO_STEP { INVERSE_OF_NO_STEP } else { 1.0 / v };
    DVec3::new(invert(step.x), invert(step.y), invert(step.z))
}

/// Entry into a box given relative to the origin. The intervals are closed: a
/// ray through the seam of two abutting boxes hits at least one of them.
#[inline]
fn enter_slabs(low: DVec3, high: DVec3, inverse: DVec3) -> Option<f64> {
    let (a, b) = (low * inverse, high * inverse);
    let enter = a.min(b).max_element();
    let leave = a.max(b).min_element();
    (enter <= leave && enter >= 0.0).then_some(enter)
}

/// The corners of a triangle of a mesh, in world space, counter-clockwise seen from its front.
#[inline]
pub(super) fn corners(mesh: &Mesh, transform: &DAffine3, triangle: usize) -> [DVec3; 3] {
    let [a, b, c] =
        mesh.triangles[triangle].map(|i| transform.transform_point3(mesh.positions[i as usize].as_dvec3()));
    if !mesh.sides.is_empty() && transform.matrix3.determinant() < 0.0 { [a, c, b] } else { [a, b, c] }
}

/// From where a primitive of a shape that occludes stops rays.
pub(super) fn sides_of(shape: &Shape, primitive: u32) -> Sides {
    match shape {
        Shape::Mesh { mesh, .. } => mesh.sides_of(primitive as usize),
        _ => Sides::Both,
    }
}

/// Number of primitives of a shape.
pub(super) fn primitive_count(shape: &Shape) -> usize {
    match shape {
        Shape::Mesh { mesh, .. } => mesh.triangles.len(),
        _ => 1,
    }
}

/// What is kept about a mesh.
#[derive(Debug, Clone)]
pub(super) struct MeshFacts {
    /// Keeps the mesh alive, so that its address stays its own.
    _mesh: Arc<Mesh>,
    /// Bounds in object space.
    min: DVec3,
    max: DVec3,
    /// Area of the triangles up to and with each, in object space.
    pub(super) areas: Vec<f64>,
}

/// Facts about meshes, by their address.
#[derive(Debug, Clone, Default)]
pub(super) struct MeshCache {
    known: HashMap<usize, MeshFacts>,
}

impl MeshCache {
    /// Gathers the facts about the meshes of `objects` not met before.
    pub(super) fn learn<'a>(&mut self, objects: impl IntoIterator<Item = &'a Object>) {
        for object in objects {
            let Shape::Mesh { mesh, .. } = &object.shape else { continue };
            self.known.entry(address(mesh)).or_insert_with(|| {
                let mut min = DVec3::INFINITY;
                let mut max = DVec3::NEG_INFINITY;
                for position in &mesh.positions {
                    min = min.min(position.as_dvec3());
                    max = max.max(position.as_dvec3());
                }
                let mut sum = 0.0;
                let areas = (0..mesh.triangles.len())
                    .map(|i| {
                        let [a, b, c] = corners(mesh, &DAffine3::IDENTITY, i);
                        let area = (b - a).cross(c - a).length();
                        sum += if area.is_finite() { area } else { 0.0 };
                        sum
                    })
                    .collect();
                MeshFacts { _mesh: Arc::clone(mesh), min, max, areas }
            });
        }
    }

    /// The facts about a mesh learnt before.
    pub(super) fn facts(&self, mesh: &Arc<Mesh>) -> Option<&MeshFacts> {
        self.known.get(&address(mesh))
    }

    /// World-space bounds of a shape whose mesh was learnt before; empty for
    /// an empty mesh.
    pub(super) fn bounds(&self, shape: &Shape) -> (DVec3, DVec3) {
        let Shape::Mesh { mesh, transform } = shape else {
            return Primitive::of(shape, 0).bounds();
        };
        let Some(facts) = self.facts(mesh) else {
            return (DVec3::NEG_INFINITY, DVec3::INFINITY);
        };
        if mesh.triangles.is_empty() || mesh.positions.is_empty() {
            return (DVec3::INFINITY, DVec3::NEG_INFINITY);
        }
        let transform = transform.as_daffine3();
        let center = transform.transform_point3((facts.min + facts.max) * 0.5);
        let half = (facts.max - facts.min) * 0.5;
        let m = transform.matrix3;
        let reach = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z;
        let reach = reach * (1.0 + BOX_SIZE) + center.abs() * BOX_PLACE;
        (center - reach, center + reach)
    }
}

fn address(mesh: &Arc<Mesh>) -> usize {
    Arc::as_ptr(mesh) as usize
}
