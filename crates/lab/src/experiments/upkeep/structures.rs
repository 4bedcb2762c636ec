//! What else keeps moving boxes for queries: a linear array and a bounding volume hierarchy.

use std::time::Duration;

use glam::{Vec3, Vec4, Vec4Swizzles};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;

use casca_scenes::world::Camera;

/// What the test lets through beyond the frustum, in metres: more than it rounds.
const MARGIN: f32 = 1e-3;

/// The one test of boxes that all structures use: the half-spaces that bound a view, with normals
/// of length 1 that point inwards.
pub(super) struct Frustum([Vec4; 6]);

impl Frustum {
    pub(super) fn of(camera: &Camera) -> Self {
        let m = camera.view_projection();
        let (x, y, z, w) = (m.row(0), m.row(1), m.row(2), m.row(3));
        let planes = [w + x, w - x, w + y, w - y, z, w - z];
        Self(planes.map(|p| p / p.xyz().length().max(f32::MIN_POSITIVE) + Vec4::W * MARGIN))
    }

    /// Whether a box may meet the frustum. True for a box wherever it is true for one inside it.
    pub(super) fn meets(&self, min: Vec3, max: Vec3) -> bool {
        self.0.iter().all(|p| {
            let n = p.xyz();
            let far = Vec3::select(n.cmpge(Vec3::ZERO), max, min);
            far.x * n.x + far.y * n.y + far.z * n.z + p.w >= 0.0
        })
    }
}

/// Least and greatest corner.
pub(super) type Box3 = (Vec3, Vec3);

/// A structure of moving boxes, numbered from 0.
pub(super) trait Structure {
    /// What it is called.
    fn name(&self) -> &'static str;
    /// Takes the boxes as they are now: as many as before, all moved.
    fn update(&mut self, boxes: &[Box3]);
    /// Adds the numbers of the boxes that may meet the frustum, in any order.
    fn query(&self, frustum: &Frustum, out: &mut Vec<u32>);
}

/// An array of boxes, all tested.
pub(super) struct Linear(Vec<Box3>);

impl Linear {
    pub(super) fn new(boxes: &[Box3]) -> Self {
        Self(boxes.to_vec())
    }
}

impl Structure for Linear {
    fn name(&self) -> &'static str {
        "linear array"
    }

    fn update(&mut self, boxes: &[Box3]) {
        self.0.clear();
        self.0.extend_from_slice(boxes);
    }

    fn query(&self, frustum: &Frustum, out: &mut Vec<u32>) {
        let met = self.0.iter().enumerate().filter(|(_, b)| frustum.meets(b.0, b.1));
        out.extend(met.map(|(i, _)| i as u32));
    }
}

/// A bounding volume hierarchy of two children a node, built once, whose boxes are fitted anew in
/// each update.
pub(super) struct Bvh {
    bvh: Bvh2,
    boxes: Vec<Box3>,
}

impl Bvh {
    pub(super) fn new(boxes: &[Box3]) -> Self {
        let aabbs: Vec<Aabb> =
            boxes.iter().map(|&(min, max)| Aabb { min: min.into(), max: max.into() }).collect();
        let bvh = match aabbs.is_empty() {
            true => Bvh2::default(),
            false => build_bvh2(&aabbs, BvhBuildParams::medium_build(), &mut Duration::default()),
        };
        Self { bvh, boxes: boxes.to_vec() }
    }
}

impl Structure for Bvh {
    fn name(&self) -> &'static str {
        "BVH, refit"
    }

    fn update(&mut self, boxes: &[Box3]) {
        self.boxes.clear();
        self.boxes.extend_from_slice(boxes);
        let Bvh2 { nodes, primitive_indices, .. } = &mut self.bvh;
        for node in nodes.iter_mut().filter(|n| n.is_leaf()) {
            let from = node.first_index as usize;
            let held = primitive_indices.get(from..from + node.prim_count as usize).unwrap_or_default();
            let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            for (low, high) in held.iter().filter_map(|&i| boxes.get(i as usize)) {
                (min, max) = (min.min(*low), max.max(*high));
            }
            node.set_aabb(Aabb { min: min.into(), max: max.into() });
        }
        self.bvh.refit_all();
    }

    fn query(&self, frustum: &Frustum, out: &mut Vec<u32>) {
        let mut stack = vec![0u32];
        while let Some(node) = stack.pop().and_then(|i| self.bvh.nodes.get(i as usize)) {
            let b = node.aabb();
            if !frustum.meets(b.min.into(), b.max.into()) {
                continue;
            }
            if !node.is_leaf() {
                stack.extend([node.first_index, node.first_index + 1]);
                continue;
            }
            let from = node.first_index as usize;
            let held =
                self.bvh.primitive_indices.get(from..from + node.prim_count as usize).unwrap_or_default();
            let meets = |i: &u32| self.boxes.get(*i as usize).is_some_and(|b| frustum.meets(b.0, b.1));
            // A leaf of one box is that box.
            out.extend(held.iter().copied().filter(|i| held.len() == 1 || meets(i)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_meet_the_frustum_or_not() {
        let f = Frustum::of(&Camera::look_at(Vec3::ZERO, Vec3::X, 90.0, 1.0, 1.0, 100.0));
        let meets = |x: f32, y: f32, z: f32| {
            let c = Vec3::new(x, y, z);
            f.meets(c - 0.5, c + 0.5)
        };
        assert!(meets(10.0, 0.0, 0.0) && meets(10.0, 9.9, 0.0) && meets(50.0, 0.0, -50.2));
        assert!(!meets(-10.0, 0.0, 0.0) && !meets(10.0, 12.0, 0.0) && !meets(101.0, 0.0, 0.0));
        assert!(!meets(0.2, 0.0, 0.0) && meets(0.6, 0.0, 0.0) && !meets(50.0, 0.0, 52.0));
    }
}
