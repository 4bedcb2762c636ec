//! Bounding volume hierarchies over exact primitives; the path tracer of `casca-radiosity` uses them.

use std::collections::HashMap;
use std::time::Duration;

use casca_scenes::world::{Motion, Object, Sides};
use glam::DVec3;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::{Ray, RayHit};
use rayon::prelude::*;

pub use super::geometry::Primitive;
use super::geometry::{sides_of, stopping};
use crate::numeric::oracle::{BOX_F32, LEAST_SCALE, RAY_F32};

/// Refits of the moving part before it is built anew.
pub(super) const REFITS: u32 = 8;

/// A primitive and whose it is.
#[derive(Debug, Clone, Copy)]
pub struct Part {
    /// What rays hit.
    pub shape: Primitive,
    /// The number of its object.
    pub object: u32,
    /// Which of the object's primitives it is.
    pub triangle: u32,
    /// From where it stops rays, if it is a triangle.
    pub sides: Sides,
}

impl Part {
    /// Where it stops a ray: see [`Primitive::enter`].
    #[inline]
    pub fn enter(&self, origin: DVec3, step: DVec3, grown: bool) -> Option<f64> {
        let t = self.shape.enter(origin, step, grown)?;
        match (self.sides, &self.shape) {
            (Sides::Front, Primitive::Triangle([a, b, c])) => {
                ((*b - *a).cross(*c - *a).dot(step) < 0.0).then_some(t)
            }
            _ => Some(t),
        }
    }
}

/// A bounding volume hierarchy over the primitives of some objects.
pub struct Tree {
    /// In the order of the leaves.
    pub(super) parts: Vec<Part>,
    pub(super) bvh: Bvh2,
    /// The greatest coordinate.
    pub scale: f64,
    pub(super) refits: u32,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Place {
    Nowhere,
    Fixed,
    Moving,
}

impl Place {
    pub(super) fn of(object: &Object) -> Self {
        match (object.occludes, object.motion) {
            (false, _) => Self::Nowhere,
            (true, Motion::Static) => Self::Fixed,
            (true, Motion::Dynamic { .. }) => Self::Moving,
        }
    }
}

/// A hierarchy whose leaves hold all boxes that are equal: thousands of them would become a chain,
/// too deep to walk along.
fn hierarchy(boxes: &[Aabb], params: BvhBuildParams) -> Bvh2 {
    let (mut places, mut different) = (HashMap::new(), Vec::new());
    let mut equal: Vec<Vec<u32>> = Vec::new();
    for (i, one) in (0..).zip(boxes) {
        let bits = [one.min, one.max].map(|corner| corner.to_array().map(f32::to_bits));
        let place = *places.entry(bits).or_insert(different.len());
        if place == different.len() {
            different.push(*one);
            equal.push(Vec::new());
        }
        equal[place].push(i);
    }
    let mut bvh = build_bvh2(&different, params, &mut Duration::default());
    let mut all = Vec::with_capacity(boxes.len());
    for node in bvh.nodes.iter_mut().filter(|node| node.is_leaf()) {
        let from = node.first_index as usize;
        node.first_index = all.len() as u32;
        for &place in &bvh.primitive_indices[from..from + node.prim_count as usize] {
            all.extend(&equal[place as usize]);
        }
        node.prim_count = all.len() as u32 - node.first_index;
    }
    bvh.primitive_indices = all;
    bvh
}

impl Tree {
    pub(super) fn build(objects: &[Object], place: &[Place], wanted: Place, params: BvhBuildParams) -> Self {
        let mut parts = Vec::new();
        for (i, object) in objects.iter().enumerate() {
            if place[i] != wanted {
                continue;
            }
            for (triangle, sides) in stopping(&object.shape) {
                let shape = Primitive::of(&object.shape, triangle);
                if shape.is_sound() {
                    parts.push(Part { shape, object: i as u32, triangle, sides });
                }
            }
        }
        Self::of(parts, params)
    }

    /// A tree over sound parts.
    pub fn of(parts: Vec<Part>, params: BvhBuildParams) -> Self {
        let scale = scale_of(&parts);
        let boxes: Vec<Aabb> = parts.iter().map(|part| wide_box(&part.shape, scale)).collect();
        let bvh = if boxes.is_empty() { Bvh2::default() } else { hierarchy(&boxes, params) };
        let parts = bvh.primitive_indices.iter().map(|&i| parts[i as usize]).collect();
        Self { parts, bvh, scale, refits: 0 }
    }

    /// Takes up new shapes of objects; the order of the tree stays as it is.
    /// Returns false, with the tree unfit for use, if a shape is unsound.
    pub(super) fn refit(&mut self, objects: &[Object], moved: &[bool]) -> bool {
        self.refits += 1;
        let unsound = self.parts.par_iter_mut().filter(|part| moved[part.object as usize]).map(|part| {
            let shape = &objects[part.object as usize].shape;
            (part.shape, part.sides) = (Primitive::of(shape, part.triangle), sides_of(shape, part.triangle));
            !part.shape.is_sound()
        });
        if unsound.reduce(|| false, |a, b| a | b) {
            return false;
        }
        self.scale = scale_of(&self.parts);
        for node in &mut self.bvh.nodes {
            if node.is_leaf() {
                let from = node.first_index as usize;
                let mut all = Aabb::empty();
                for part in &self.parts[from..from + node.prim_count as usize] {
                    all = all.union(&wide_box(&part.shape, self.scale));
                }
                node.set_aabb(all);
            }
        }
        self.bvh.refit_all();
        true
    }

    /// The ray in f32, with a unit direction, and its length. It may start
    /// later than `origin`, where the tree begins.
    pub(super) fn ray(&self, origin: DVec3, step: DVec3, end: f64) -> Option<Ray> {
        let length = step.length();
        let sound = length > 0.0 && length.is_finite() && origin.is_finite();
        if !sound || self.parts.is_empty() {
            return None;
        }
        let direction = step / length;
        let mut start = origin;
        let mut way = length * end;
        // Far away the coordinates of f32 are too coarse.
        let reach = 2.0 * self.scale + LEAST_SCALE;
        if start.abs().max_element() > reach {
            let inverse = super::geometry::safe_inverse(direction);
            let (a, b) = ((-reach - start) * inverse, (reach - start) * inverse);
            let enter = a.min(b).max_element();
            let leave = a.max(b).min_element();
            if enter > leave || leave < 0.0 {
                return None;
            }
            start += direction * enter;
            way -= enter;
        }
        let way = way * (1.0 + RAY_F32) + RAY_F32 * reach;
        let start = start.as_vec3a();
        start.is_finite().then(|| Ray::new(start, direction.as_vec3a(), 0.0, way as f32))
    }

    /// The first part found that `hides` says hides.
    pub fn any(&self, origin: DVec3, step: DVec3, end: f64, hides: impl Fn(&Part) -> bool) -> Option<u32> {
        let ray = self.ray(origin, step, end)?;
        let mut found = None;
        self.bvh.ray_traverse_miss(ray, |_, i| {
            if hides(&self.parts[i]) {
                found = Some(i as u32);
                f32::NEG_INFINITY
            } else {
                f32::INFINITY
            }
        });
        found
    }

    /// The first hit along the ray; `best` is the first so far.
    pub fn first(&self, origin: DVec3, step: DVec3, best: &mut Option<(u32, f64)>) {
        let Some(ray) = self.ray(origin, step, f64::INFINITY) else { return };
        let length = step.length();
        let shift = (origin - ray.origin.as_dvec3()).length();
        let slack = RAY_F32 * (self.scale + LEAST_SCALE);
        self.bvh.ray_traverse(ray, &mut RayHit::none(), |_, i| {
            let part = &self.parts[i];
            if let Some(t) = part.enter(origin, step, false) {
                let nearer = best.is_none_or(|(object, old)| t < old || (t == old && part.object < object));
                if nearer {
                    *best = Some((part.object, t));
                }
            }
            // Nothing behind this needs to be looked at.
            best.map_or(f32::INFINITY, |(_, t)| {
                ((t * length - shift).max(0.0) * (1.0 + RAY_F32) + slack) as f32
            })
        });
    }
}

pub(super) fn scale_of(parts: &[Part]) -> f64 {
    parts.iter().fold(0.0, |scale: f64, part| {
        let (min, max) = part.shape.bounds();
        scale.max(min.abs().max_element()).max(max.abs().max_element())
    })
}

/// The box of a primitive, widened against rounding of f32 rays.
pub(super) fn wide_box(shape: &Primitive, scale: f64) -> Aabb {
    let (min, max) = shape.bounds();
    let margin = DVec3::splat(BOX_F32 * (scale + LEAST_SCALE));
    Aabb::new((min - margin).as_vec3a(), (max + margin).as_vec3a())
}
