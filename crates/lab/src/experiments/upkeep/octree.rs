//! A loose octree: objects lie in the cell that holds their middle, on the level whose cells are as
//! large as they are, and cells are taken to be twice as wide as they are (Ulrich 2000).

use glam::{UVec3, Vec3};

use super::frustum::Frustum;
use super::structures::{Box3, Structure};

/// The deepest level.
const DEEPEST: u32 = 6;
/// Objects that a leaf should hold, about.
const LEAF: usize = 4;

#[derive(Default, Clone)]
struct Node {
    objects: Vec<u32>,
    /// Objects in it and below.
    total: u32,
}

/// Where an object is: the number of its node, and its place there.
#[derive(Clone, Copy)]
struct Home {
    level: u32,
    cell: UVec3,
    place: u32,
}

/// A loose octree over a cube, with the nodes of each level in an array.
pub(super) struct LooseOctree {
    min: Vec3,
    size: f32,
    /// By level, 2^level cells along each axis.
    levels: Vec<Vec<Node>>,
    homes: Vec<Home>,
    boxes: Vec<Box3>,
}

fn index(level: u32, cell: UVec3) -> usize {
    (((cell.z << level) + cell.y) << level | cell.x) as usize
}

impl LooseOctree {
    /// The octree of these boxes over the cube at `min` of edge `size`.
    pub(super) fn new(boxes: &[Box3], min: Vec3, size: f32) -> Self {
        let depth = (boxes.len() / LEAF).max(1).ilog2().div_ceil(3).min(DEEPEST);
        let levels = (0..=depth).map(|l| vec![Node::default(); 1 << (3 * l)]).collect();
        let root = Home { level: 0, cell: UVec3::ZERO, place: 0 };
        let homes = vec![root; boxes.len()];
        let mut tree = Self { min, size, levels, homes, boxes: boxes.to_vec() };
        for (i, &b) in boxes.iter().enumerate() {
            let (level, cell) = tree.home_of(b);
            tree.enter(i as u32, level, cell);
        }
        tree
    }

    fn side(&self, level: u32) -> f32 {
        self.size / (1u32 << level) as f32
    }

    /// The node for a box: objects that reach out of the cube go to the root.
    fn home_of(&self, (min, max): Box3) -> (u32, UVec3) {
        let extent = (max - min).max_element();
        let (end, slack) = (self.min + self.size, self.size * 1e-5);
        if !(min.cmpge(self.min).all() && max.cmple(end).all()) {
            return (0, UVec3::ZERO);
        }
        let mut level = self.levels.len() as u32 - 1;
        // Leaves room for rounding.
        while level > 0 && self.side(level) < extent + slack {
            level -= 1;
        }
        let cell = ((min + max) * 0.5 - self.min) / self.side(level);
        (level, cell.as_uvec3().min(UVec3::splat((1 << level) - 1)))
    }

    fn count(&mut self, level: u32, cell: UVec3, change: i32) {
        for up in 0..=level {
            let node = &mut self.levels[(level - up) as usize][index(level - up, cell >> up)];
            node.total = node.total.wrapping_add_signed(change);
        }
    }

    fn enter(&mut self, object: u32, level: u32, cell: UVec3) {
        let node = &mut self.levels[level as usize][index(level, cell)];
        self.homes[object as usize] = Home { level, cell, place: node.objects.len() as u32 };
        node.objects.push(object);
        self.count(level, cell, 1);
    }

    fn leave(&mut self, object: u32) {
        let Home { level, cell, place } = self.homes[object as usize];
        let node = &mut self.levels[level as usize][index(level, cell)];
        node.objects.swap_remove(place as usize);
        if let Some(&moved) = node.objects.get(place as usize) {
            self.homes[moved as usize].place = place;
        }
        self.count(level, cell, -1);
    }

    fn collect(&self, level: u32, cell: UVec3, frustum: &Frustum, out: &mut Vec<u32>) {
        let node = &self.levels[level as usize][index(level, cell)];
        if node.total == 0 {
            return;
        }
        let side = self.side(level);
        let low = self.min + cell.as_vec3() * side;
        let reach = side * 0.5 + self.size * 1e-5;
        if level > 0 && !frustum.meets(low - reach, low + side + reach) {
            return;
        }
        let meets = |&&i: &&u32| frustum.meets(self.boxes[i as usize].0, self.boxes[i as usize].1);
        out.extend(node.objects.iter().filter(meets));
        if (level as usize) + 1 < self.levels.len() {
            for i in 0..8 {
                let child = cell * 2 + UVec3::new(i & 1, i >> 1 & 1, i >> 2);
                self.collect(level + 1, child, frustum, out);
            }
        }
    }
}

impl Structure for LooseOctree {
    fn name(&self) -> &'static str {
        "loose octree"
    }

    fn update(&mut self, boxes: &[Box3]) {
        for (i, &new) in boxes.iter().enumerate().take(self.boxes.len()) {
            self.boxes[i] = new;
            let (level, cell) = self.home_of(new);
            let home = self.homes[i];
            if (level, cell) != (home.level, home.cell) {
                self.leave(i as u32);
                self.enter(i as u32, level, cell);
            }
        }
    }

    fn query(&self, frustum: &Frustum, out: &mut Vec<u32>) {
        self.collect(0, UVec3::ZERO, frustum, out);
    }
}
