//! Patches gathered from grown triangles and straight edges: the tree of groups, outlines and their sides.

use std::collections::HashMap;

use crate::mesh::surface::chain::Straight;
use crate::mesh::surface::grow::Patches;
use crate::mesh::surface::patch::{NONE, Patch, Rules, Side, Surface, slack};
use crate::mesh::surface::tree::{Border, Node, build};
use crate::mesh::surface::weld::Welded;

/// Puts each directed edge after one that ends where it starts, as far as that goes.
fn in_rings(outline: &mut Vec<u32>, straight: &[Straight]) {
    let ends = |d: u32| {
        let [a, b] = straight[(d >> 1) as usize].ends;
        if d & 1 == 0 { (a, b) } else { (b, a) }
    };
    // By their starts, backwards, so that the last of each start is free.
    let mut rest: HashMap<u32, Vec<u32>> = HashMap::with_capacity(outline.len());
    for &d in outline.iter().rev() {
        rest.entry(ends(d).0).or_default().push(d);
    }
    let starts: Vec<u32> = outline.iter().map(|&d| ends(d).0).collect();
    outline.clear();
    for start in starts {
        let mut at = start;
        while let Some(next) = rest.get_mut(&at).and_then(Vec::pop) {
            outline.push(next);
            at = ends(next).1;
        }
    }
}

/// The patches that run along an edge.
enum Beside {
    One,
    /// Two of them, and whether they run in opposite directions.
    Two([u32; 2], bool),
    /// None, more than two, or one several times.
    More,
}

impl Beside {
    fn new(edge: &Straight, number: &[u32]) -> Self {
        let mut kept = edge.runs.iter().map(|r| (number[r.0 as usize], r.1)).filter(|r| r.0 != NONE);
        match (kept.next(), kept.next(), kept.next()) {
            (Some((_, x)), None, None) if x.abs() == 1 => Self::One,
            (Some((p, x)), Some((q, y)), None) if x.abs() == 1 && y.abs() == 1 => Self::Two([p, q], x == -y),
            _ => Self::More,
        }
    }
}

/// Patches with their slabs, boxes and outlines, in a tree.
pub(crate) fn gather(mesh: &Welded, grown: &Patches, straight: &[Straight], rules: &Rules) -> Surface {
    let count = grown.normals.len();
    let mut outlines: Vec<Vec<u32>> = vec![Vec::new(); count];
    for (i, edge) in straight.iter().enumerate() {
        for &(patch, steps) in &edge.runs {
            let directed = 2 * i as u32 + u32::from(steps < 0);
            outlines[patch as usize].extend((0..steps.abs()).map(|_| directed));
        }
    }
    outlines.iter_mut().for_each(|outline| in_rings(outline, straight));
    let all: Vec<u32> = (0..count as u32).collect();
    let borders: Vec<Border> =
        straight.iter().filter_map(|edge| border(mesh, edge, &Beside::new(edge, &all))).collect();
    let (nodes, root) = build(mesh, grown, &borders, rules);
    let order = in_order(&nodes, root);
    let mut number = vec![NONE; count];
    for (&node, new) in order.iter().zip(0..) {
        if nodes[node as usize].parts.is_empty() {
            number[node as usize] = new;
        }
    }
    // The patches at each edge, of those that are kept.
    let beside: Vec<Beside> = straight.iter().map(|edge| Beside::new(edge, &number)).collect();
    let mut surface = Surface { front: rules.front, ..Surface::default() };
    for &node in &order {
        let first = surface.sides.len() as u32;
        if nodes[node as usize].parts.is_empty() {
            let patch = number[node as usize];
            for &directed in &outlines[node as usize] {
                let (edge, beside) = (&straight[(directed >> 1) as usize], &beside[(directed >> 1) as usize]);
                surface.push_side(mesh, edge, directed & 1 == 1, beside, patch);
            }
        }
        let Node { normal, slab: (lo, hi), sine, min, max, .. } = nodes[node as usize];
        let last = surface.sides.len() as u32;
        let slack = slack(&surface.sides[first as usize..]);
        surface.patches.push(Patch { first, last, next: 0, sine, normal, lo, hi, min, max, slack });
    }
    close_ranges(&mut surface.patches, &nodes, &order);
    surface.find_rims();
    surface
}

/// The border between the two patches that an edge separates, if they run along it in opposite directions.
fn border(mesh: &Welded, edge: &Straight, beside: &Beside) -> Option<Border> {
    let &Beside::Two([p, q], true) = beside else { return None };
    let [a, b] = edge.ends.map(|v| mesh.positions[v as usize].as_dvec3());
    Some((p, q, a.distance(b)))
}

/// The nodes below a root, each one before its parts.
fn in_order(nodes: &[Node], root: Option<u32>) -> Vec<u32> {
    let mut order = Vec::new();
    let mut waiting: Vec<u32> = root.into_iter().collect();
    while let Some(node) = waiting.pop() {
        order.push(node);
        waiting.extend(nodes[node as usize].parts.iter().rev());
    }
    order
}

/// Tells each patch where its last part ends.
fn close_ranges(patches: &mut [Patch], nodes: &[Node], order: &[u32]) {
    let mut place = vec![0u32; nodes.len()];
    for (at, &node) in order.iter().enumerate().rev() {
        place[node as usize] = at as u32;
        patches[at].next = match nodes[node as usize].parts.last() {
            Some(&last) => patches[place[last as usize] as usize].next,
            None => at as u32 + 1,
        };
    }
}

impl Surface {
    /// Appends a side of a patch: an edge, passed in its direction or against it.
    fn push_side(&mut self, mesh: &Welded, edge: &Straight, against: bool, beside: &Beside, patch: u32) {
        let [from, to] = edge.ends.map(|v| mesh.positions[v as usize]);
        let (from, to) = if against { (to, from) } else { (from, to) };
        let (twin, opposite) = match *beside {
            Beside::Two([p, q], opposite) => (if p == patch { q } else { p }, opposite),
            Beside::One => {
                self.open.push((self.sides.len() as u32, edge.chain));
                (NONE, false)
            }
            Beside::More => (NONE, false),
        };
        let slack = if edge.slack > 0.0 { (edge.slack as f32).next_up() } else { 0.0 };
        self.sides.push(Side { from, to, slack, twin, opposite });
    }
}
