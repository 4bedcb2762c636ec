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
pub(super) struct Structure {
    boxes: Vec<Box3>,
    /// A bounding volume hierarchy of two children a node, built once, whose boxes are fitted anew
    /// in each update. Without one, all boxes are tested.
    tree: Option<Bvh2>,
}

impl Structure {
    /// An array of boxes.
    pub(super) fn linear(boxes: &[Box3]) -> Self {
        Self { boxes: boxes.to_vec(), tree: None }
    }

    /// The same with a hierarchy.
    pub(super) fn tree(boxes: &[Box3]) -> Self {
        let aabbs: Vec<Aabb> =
            boxes.iter().map(|&(min, max)| Aabb { min: min.into(), max: max.into() }).collect();
        let tree = match aabbs.is_empty() {
            true => Bvh2::default(),
            false => build_bvh2(&aabbs, BvhBuildParams::medium_build(), &mut Duration::default()),
        };
        Self { tree: Some(tree), ..Self::linear(boxes) }
    }

    /// What it is called.
    pub(super) fn name(&self) -> &'static str {
        if self.tree.is_some() { "BVH, refit" } else { "linear array" }
    }

    /// Takes the boxes as they are now: as many as before, all moved.
    pub(super) fn update(&mut self, boxes: &[Box3]) {
        self.boxes.clear();
        self.boxes.extend_from_slice(boxes);
        let Some(tree) = &mut self.tree else { return };
        let Bvh2 { nodes, primitive_indices, .. } = tree;
        for node in nodes.iter_mut().filter(|n| n.is_leaf()) {
            let from = node.first_index as usize;
            let held = primitive_indices.get(from..from + node.prim_count as usize).unwrap_or_default();
            let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            for (low, high) in held.iter().filter_map(|&i| boxes.get(i as usize)) {
                (min, max) = (min.min(*low), max.max(*high));
            }
            node.set_aabb(Aabb { min: min.into(), max: max.into() });
        }
        tree.refit_all();
    }

    /// Adds the numbers of the boxes that may meet the frustum, in any order.
    pub(super) fn query(&self, frustum: &Frustum, out: &mut Vec<u32>) {
        let Some(tree) = &self.tree else {
            let met = self.boxes.iter().enumerate().filter(|(_, b)| frustum.meets(b.0, b.1));
            return out.extend(met.map(|(i, _)| i as u32));
        };
        let mut stack = vec![0u32];
        while let Some(node) = stack.pop().and_then(|i| tree.nodes.get(i as usize)) {
            let b = node.aabb();
            if !frustum.meets(b.min.into(), b.max.into()) {
                continue;
            }
            if !node.is_leaf() {
                stack.extend([node.first_index, node.first_index + 1]);
                continue;
            }
            let from = node.first_index as usize;
            let held = tree.primitive_indices.get(from..from + node.prim_count as usize).unwrap_or_default();
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
