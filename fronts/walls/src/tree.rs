//! A tree of boxes over walls.

use casca::glam::DVec3;

use crate::wall::{Span, Wall};

/// Shares of a segment are off by less than this: leaves that are entered in vain cost little.
const SHARE: f64 = 1e-9;

/// Walls in a leaf, at most.
const LEAF: usize = 4;

#[derive(Debug, Clone, Copy)]
struct Node {
    span: Span,
    /// The walls of a leaf, or the node after all nodes of the first half.
    start: usize,
    /// 0 for a node with halves, the first of which follows it.
    count: usize,
}

/// Halves of halves of walls, each with its box.
#[derive(Debug, Default)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
}

impl Tree {
    /// Sorts walls into a tree.
    pub(crate) fn new(walls: &mut [Wall]) -> Self {
        let mut tree = Self::default();
        if !walls.is_empty() {
            tree.add(walls, 0);
        }
        tree
    }

    fn add(&mut self, walls: &mut [Wall], start: usize) {
        let around = |spans: &mut dyn Iterator<Item = Span>| {
            let empty = Span { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };
            spans.fold(empty, |all, s| Span { min: all.min.min(s.min), max: all.max.max(s.max) })
        };
        let span = around(&mut walls.iter().map(Wall::span));
        let node = self.nodes.len();
        self.nodes.push(Node { span, start, count: walls.len() });
        if walls.len() <= LEAF {
            return;
        }
        let size = span.max - span.min;
        let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
        let middle = |wall: &Wall| wall.span().min[axis] + wall.span().max[axis];
        walls.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
        let half = walls.len() / 2;
        let (first, second) = walls.split_at_mut(half);
        self.add(first, start);
        let next = self.nodes.len();
        self.add(second, start + half);
        self.nodes[node] = Node { span, start: next, count: 0 };
    }

    /// Walks over the leaves whose boxes, and those of all halves that they are in, `enters` tells,
    /// until `stop` says so of a wall. Returns whether it did.
    fn walk(&self, enters: impl Fn(&Span) -> bool, mut stop: impl FnMut(usize) -> bool) -> bool {
        let mut open = vec![0];
        while let Some(i) = open.pop() {
            let Some(Node { span, start, count }) = self.nodes.get(i).copied() else { continue };
            if !enters(&span) {
                continue;
            }
            if count == 0 {
                open.extend([start, i + 1]);
            } else if (start..start + count).any(&mut stop) {
                return true;
            }
        }
        false
    }

    /// Visits walls near a box, and all that touch it.
    pub(crate) fn touching(&self, span: &Span, mut visit: impl FnMut(usize)) {
        let touches = |s: &Span| s.min.cmple(span.max).all() && s.max.cmpge(span.min).all();
        self.walk(touches, |i| {
            visit(i);
            false
        });
    }

    /// Visits walls near a segment, and all that it meets, until one is enough; whether one was.
    pub(crate) fn along(&self, from: DVec3, to: DVec3, enough: impl FnMut(usize) -> bool) -> bool {
        let (middle, half) = ((from + to) * 0.5, (to - from).abs() * 0.5);
        // Boxes and segments of no extent along an axis are compared as they are.
        let inverse = 1.0 / (to - from);
        let enters = |s: &Span| {
            let apart = (s.min - middle).max(middle - s.max);
            if apart.cmpgt(half).any() {
                return false;
            }
            let (a, b) = ((s.min - from) * inverse, (s.max - from) * inverse);
            let (first, last) = (a.min(b), a.max(b));
            let start = first.to_array().into_iter().filter(|t| !t.is_nan()).fold(0.0, f64::max);
            let end = last.to_array().into_iter().filter(|t| !t.is_nan()).fold(1.0, f64::min);
            start <= end + SHARE
        };
        self.walk(enters, enough)
    }
}
