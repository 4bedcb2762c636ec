//! Finds the triangles of a mesh near a place: a tree of boxes, halved by the median along the
//! longest side.

use glam::{DVec3, Vec3};
use smallvec::SmallVec;

/// Triangles of a leaf, at most.
const LEAF: usize = 8;

#[derive(Debug, Clone)]
struct Node {
    min: Vec3,
    max: Vec3,
    /// The first of its triangles in the order, or of its two children.
    first: u32,
    /// Number of its triangles; 0 if it has children.
    count: u32,
}

/// The triangles of a mesh in boxes.
#[derive(Debug, Clone)]
pub(crate) struct Index {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

impl Index {
    /// Costs n log n for n triangles.
    pub(crate) fn new(count: usize, corners: &dyn Fn(u32) -> [Vec3; 3]) -> Self {
        let mut order: Vec<u32> = (0..count as u32).collect();
        let middle = |t: u32| corners(t).iter().map(|p| p.as_dvec3()).sum::<DVec3>();
        let mut nodes: Vec<Node> = Vec::with_capacity(2 * count / (LEAF / 2) + 1);
        nodes.push(Node { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY, first: 0, count: count as u32 });
        let mut at = 0;
        // Nodes follow their parents, so the list is its own queue.
        while at < nodes.len() {
            let (first, count) = (nodes[at].first as usize, nodes[at].count as usize);
            let own = &mut order[first..first + count];
            let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            for p in own.iter().flat_map(|&t| corners(t)) {
                (min, max) = (min.min(p), max.max(p));
            }
            (nodes[at].min, nodes[at].max) = (min, max);
            if count > LEAF {
                let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
                for m in own.iter().map(|&t| middle(t)) {
                    (low, high) = (low.min(m), high.max(m));
                }
                let axis = (high - low).max_position();
                let half = count / 2;
                own.select_nth_unstable_by(half, |&a, &b| {
                    middle(a)[axis].total_cmp(&middle(b)[axis]).then(a.cmp(&b))
                });
                (nodes[at].first, nodes[at].count) = (nodes.len() as u32, 0);
                for (start, count) in [(first, half), (first + half, count - half)] {
                    nodes.push(Node { min, max, first: start as u32, count: count as u32 });
                }
            }
            at += 1;
        }
        nodes.shrink_to_fit();
        Self { nodes, order }
    }

    /// Whether any triangle passes `test`, of those in boxes that pass `near`.
    pub(crate) fn any(&self, near: impl Fn(DVec3, DVec3) -> bool, mut test: impl FnMut(u32) -> bool) -> bool {
        // Halving bounds the depth by the logarithm of the number of triangles.
        let mut stack: SmallVec<[u32; 36]> = SmallVec::from_slice(&[0]);
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at as usize];
            if !near(node.min.as_dvec3(), node.max.as_dvec3()) {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.first + 1, node.first]);
            } else {
                let (first, last) = (node.first as usize, (node.first + node.count) as usize);
                if self.order[first..last].iter().any(|&t| test(t)) {
                    return true;
                }
            }
        }
        false
    }

    /// Whether a triangle that meets the box from `min` to `max`, widened by `room`, passes `test`.
    pub(crate) fn any_in_box(
        &self,
        (min, max): (DVec3, DVec3),
        room: f64,
        test: impl FnMut(u32) -> bool,
    ) -> bool {
        let (min, max) = (min - room, max + room);
        self.any(|low, high| low.cmple(max).all() && high.cmpge(min).all(), test)
    }

    /// Bytes on the heap.
    pub(crate) fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>() + self.order.capacity() * 4
    }
}
