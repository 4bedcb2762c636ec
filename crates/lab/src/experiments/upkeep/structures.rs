//! What else keeps moving boxes for queries: a linear array, bounding volume hierarchies and an
//! R*-tree.

use std::time::Duration;

use glam::Vec3;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree, SelectionFunction};

use super::frustum::Frustum;

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

fn aabbs(boxes: &[Box3]) -> Vec<Aabb> {
    boxes.iter().map(|&(min, max)| Aabb { min: min.into(), max: max.into() }).collect()
}

/// A bounding volume hierarchy of two children a node.
pub(super) struct Bvh {
    bvh: Bvh2,
    boxes: Vec<Box3>,
    refit: bool,
}

impl Bvh {
    /// Built once; its boxes are fitted anew in each update if `refit`, else it is built anew.
    pub(super) fn new(boxes: &[Box3], refit: bool) -> Self {
        let params = if refit { BvhBuildParams::medium_build() } else { BvhBuildParams::fastest_build() };
        Self { bvh: build(boxes, params), boxes: boxes.to_vec(), refit }
    }
}

fn build(boxes: &[Box3], params: BvhBuildParams) -> Bvh2 {
    if boxes.is_empty() {
        return Bvh2::default();
    }
    build_bvh2(&aabbs(boxes), params, &mut Duration::default())
}

impl Structure for Bvh {
    fn name(&self) -> &'static str {
        if self.refit { "BVH, refit" } else { "BVH, rebuilt" }
    }

    fn update(&mut self, boxes: &[Box3]) {
        self.boxes.clear();
        self.boxes.extend_from_slice(boxes);
        if !self.refit {
            self.bvh = build(boxes, BvhBuildParams::fastest_build());
            return;
        }
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

type Entry = GeomWithData<Rectangle<[f32; 3]>, u32>;

fn entry(number: usize, b: Box3) -> Entry {
    GeomWithData::new(Rectangle::from_corners(b.0.to_array(), b.1.to_array()), number as u32)
}

/// An R*-tree whose boxes are taken out and put back.
pub(super) struct RStar {
    tree: RTree<Entry>,
    boxes: Vec<Box3>,
}

impl RStar {
    pub(super) fn new(boxes: &[Box3]) -> Self {
        let entries = boxes.iter().enumerate().map(|(i, &b)| entry(i, b)).collect();
        Self { tree: RTree::bulk_load(entries), boxes: boxes.to_vec() }
    }
}

struct Meets<'a>(&'a Frustum);

impl SelectionFunction<Entry> for Meets<'_> {
    fn should_unpack_parent(&self, envelope: &AABB<[f32; 3]>) -> bool {
        self.0.meets(envelope.lower().into(), envelope.upper().into())
    }

    fn should_unpack_leaf(&self, leaf: &Entry) -> bool {
        self.0.meets(leaf.geom().lower().into(), leaf.geom().upper().into())
    }
}

impl Structure for RStar {
    fn name(&self) -> &'static str {
        "R*-tree"
    }

    fn update(&mut self, boxes: &[Box3]) {
        for (i, (old, &new)) in self.boxes.iter_mut().zip(boxes).enumerate() {
            self.tree.remove(&entry(i, *old));
            self.tree.insert(entry(i, new));
            *old = new;
        }
    }

    fn query(&self, frustum: &Frustum, out: &mut Vec<u32>) {
        out.extend(self.tree.locate_with_selection_function(Meets(frustum)).map(|e| e.data));
    }
}
