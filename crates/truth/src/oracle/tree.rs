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
use super::geometry::primitive_count;
use crate::numeric::oracle::{BOX_F32, LEAST_SCALE, RAY_F32};

/// Refits of the moving part before it is built anew.
const REFITS: u32 = 8;

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
    parts: Vec<Part>,
    bvh: Bvh2,
    /// The greatest coordinate.
    pub scale: f64,
    refits: u32,
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
    /// A tree over sound parts.
    pub fn of(parts: Vec<Part>, params: BvhBuildParams) -> Self {
        let scale = scale_of(&parts);
        let boxes: Vec<Aabb> = parts.iter().map(|part| wide_box(&part.shape, scale)).collect();
        let bvh = if boxes.is_empty() { Bvh2::default() } else { hierarchy(&boxes, params) };
        let parts = bvh.primitive_indices.iter().map(|&i| parts[i as usize]).collect();
        Self { parts, bvh, scale, refits: 0 }
    }

    /// The ray in f32, with a unit direction, and its length. It may start
    /// later than `origin`, where the tree begins.
    fn ray(&self, origin: DVec3, step: DVec3, end: f64) -> Option<Ray> {
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
    pub fn any(
        &self,
        origin: DVec3,
        step: DVec3,
        end: f64,
        mut hides: impl FnMut(&Part) -> bool,
    ) -> Option<u32> {
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

    /// The first hit along the ray before `best`, the first so far; which part, if there is one.
    pub fn first(&self, origin: DVec3, step: DVec3, best: &mut Option<(u32, f64)>) -> Option<u32> {
        let ray = self.ray(origin, step, best.map_or(f64::INFINITY, |(_, t)| t))?;
        let length = step.length();
        let shift = (origin - ray.origin.as_dvec3()).length();
        let slack = RAY_F32 * (self.scale + LEAST_SCALE);
        let mut found = None;
        self.bvh.ray_traverse(ray, &mut RayHit::none(), |_, i| {
            let part = &self.parts[i];
            if let Some(t) = part.enter(origin, step, false) {
                let nearer = best.is_none_or(|(object, old)| t < old || (t == old && part.object < object));
                if nearer {
                    *best = Some((part.object, t));
                    found = Some(i as u32);
                }
            }
            // Nothing behind this needs to be looked at.
            best.map_or(f32::INFINITY, |(_, t)| {
                ((t * length - shift).max(0.0) * (1.0 + RAY_F32) + slack) as f32
            })
        });
        found
    }
}

/// Which primitives of an object a hierarchy holds, by their numbers, and from where they stop rays.
type Which = fn(&Object, u32) -> Option<Sides>;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Nowhere,
    Fixed,
    Moving,
}

/// Hierarchies over primitives of objects: of those that never move, and of those that do.
pub(super) struct Trees {
    fixed: Tree,
    moving: Tree,
    /// By object: in which tree it is.
    place: Vec<Place>,
    which: Which,
}

fn parts(object: &Object, which: Which) -> impl Iterator<Item = (u32, Sides)> {
    let all = 0..primitive_count(&object.shape) as u32;
    all.filter_map(move |i| Some((i, which(object, i)?)))
}

impl Trees {
    pub(super) fn new(objects: &[Object], which: Which) -> Self {
        let place: Vec<Place> = objects.iter().map(|object| Place::of(object, which)).collect();
        let [fixed, moving] = [(); 2].map(|()| Tree::of(Vec::new(), BvhBuildParams::fastest_build()));
        let mut trees = Self { fixed, moving, place, which };
        (trees.fixed, trees.moving) =
            rayon::join(|| trees.build(objects, Place::Fixed), || trees.build(objects, Place::Moving));
        trees
    }

    fn build(&self, objects: &[Object], wanted: Place) -> Tree {
        let mut found = Vec::new();
        for (i, object) in objects.iter().enumerate().filter(|(i, _)| self.place[*i] == wanted) {
            for (triangle, sides) in parts(object, self.which) {
                let shape = Primitive::of(&object.shape, triangle);
                if shape.is_sound() {
                    found.push(Part { shape, object: i as u32, triangle, sides });
                }
            }
        }
        let is_fixed = wanted == Place::Fixed;
        let fast = BvhBuildParams::fastest_build();
        Tree::of(found, if is_fixed { BvhBuildParams::medium_build() } else { fast })
    }

    /// Takes up the new shapes of the objects `moved`. When a static object
    /// moved, or objects came, went or changed their kind, all is built anew, and it says so.
    pub(super) fn update(&mut self, objects: &[Object], moved: &[usize]) -> bool {
        let known = |i: usize| {
            self.place
                .get(i)
                .is_some_and(|&place| place != Place::Fixed && place == Place::of(&objects[i], self.which))
        };
        if objects.len() != self.place.len() || !moved.iter().all(|&i| known(i)) {
            *self = Self::new(objects, self.which);
            return true;
        }
        if moved.iter().all(|&i| self.place[i] == Place::Nowhere) {
            return false;
        }
        let (mut flags, mut counts) = (vec![false; objects.len()], vec![0; objects.len()]);
        moved.iter().for_each(|&i| flags[i] = true);
        self.moving.parts.iter().for_each(|part| counts[part.object as usize] += 1);
        // A new mesh may have other triangles.
        let same = moved.iter().all(|&i| counts[i] == parts(&objects[i], self.which).count());
        if !same || self.moving.refits >= REFITS || !self.refit(objects, &flags) {
            self.moving = self.build(objects, Place::Moving);
        }
        false
    }

    /// Takes up new shapes of moving objects; the order of the tree stays as it is.
    /// Returns false, with the tree unfit for use, if a shape is unsound.
    fn refit(&mut self, objects: &[Object], moved: &[bool]) -> bool {
        let (tree, which) = (&mut self.moving, self.which);
        tree.refits += 1;
        let unsound = tree.parts.par_iter_mut().filter(|part| moved[part.object as usize]).map(|part| {
            let object = &objects[part.object as usize];
            part.shape = Primitive::of(&object.shape, part.triangle);
            // A new mesh may have other triangles that stop rays.
            which(object, part.triangle).map(|sides| part.sides = sides).is_none() || !part.shape.is_sound()
        });
        if unsound.reduce(|| false, |a, b| a | b) {
            return false;
        }
        tree.scale = scale_of(&tree.parts);
        for node in &mut tree.bvh.nodes {
            if node.is_leaf() {
                let from = node.first_index as usize;
                let mut all = Aabb::empty();
                for part in &tree.parts[from..from + node.prim_count as usize] {
                    all = all.union(&wide_box(&part.shape, tree.scale));
                }
                node.set_aabb(all);
            }
        }
        tree.bvh.refit_all();
        true
    }

    /// The first hit along a ray, and the part; `last` is one that was hit by a ray close by.
    pub(super) fn first(
        &self,
        origin: DVec3,
        step: DVec3,
        last: &mut Option<(bool, u32)>,
    ) -> Option<(u32, f64)> {
        let mut best = last.and_then(|place| {
            let part = self.part(place);
            Some((part.object, part.enter(origin, step, false)?))
        });
        for (is_fixed, tree) in [(true, &self.fixed), (false, &self.moving)] {
            if let Some(i) = tree.first(origin, step, &mut best) {
                *last = Some((is_fixed, i));
            }
        }
        best
    }

    /// A part, by whether it is fixed and where in its tree.
    pub(super) fn part(&self, (is_fixed, i): (bool, u32)) -> &Part {
        &(if is_fixed { &self.fixed } else { &self.moving }).parts[i as usize]
    }

    /// A part that `hides` says hides.
    pub(super) fn any(
        &self,
        origin: DVec3,
        step: DVec3,
        end: f64,
        mut hides: impl FnMut(&Part) -> bool,
    ) -> Option<(bool, u32)> {
        let fixed = self.fixed.any(origin, step, end, &mut hides).map(|i| (true, i));
        fixed.or_else(|| self.moving.any(origin, step, end, hides).map(|i| (false, i)))
    }
}

impl Place {
    fn of(object: &Object, which: Which) -> Self {
        match object.motion {
            _ if parts(object, which).next().is_none() => Self::Nowhere,
            Motion::Static => Self::Fixed,
            Motion::Dynamic { .. } => Self::Moving,
        }
    }
}

fn scale_of(parts: &[Part]) -> f64 {
    parts.iter().fold(0.0, |scale: f64, part| {
        let (min, max) = part.shape.bounds();
        scale.max(min.abs().max_element()).max(max.abs().max_element())
    })
}

/// The box of a primitive, widened against rounding of f32 rays.
fn wide_box(shape: &Primitive, scale: f64) -> Aabb {
    let (min, max) = shape.bounds();
    let margin = DVec3::splat(BOX_F32 * (scale + LEAST_SCALE));
    Aabb::new((min - margin).as_vec3a(), (max + margin).as_vec3a())
}
