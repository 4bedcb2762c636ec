//! The tree of patches: groups of patches that are drawn as one from afar.
//!
//! Patches that share sides are joined to groups, and those again, as long as the directions of their triangles differ
//! little enough. Inside a group the sides of its parts cancel, so it has fewer sides than they have together, but its
//! slab is thicker: a query draws a group where that makes no difference, and its parts where it does. Groups that
//! lie together are bundled at last, whatever their directions: bundles have no outlines.
//!
//! After the clusters of triangles in hierarchical levels of detail (Cignoni et al. 2005); nothing is simplified here.

use std::collections::BinaryHeap;

use glam::{DVec3, Vec3};

use crate::mesh::surface::grow::{Patches, Seed};
use crate::mesh::surface::patch::Rules;
use crate::mesh::surface::weld::Welded;
use crate::numeric::mesh::{SINE, SLAB};

/// A group grows until it is this many times as large as its first part.
const GROWTH: f64 = 4.0;

/// The most parts of a group, and of a bundle.
const PARTS: usize = 64;
const BUNDLE: usize = 8;

/// Groups are joined so often, at most.
const LEVELS: usize = 24;

/// A patch of the tree as it is built.
pub(super) struct Node {
    pub(super) parts: Vec<u32>,
    pub(super) normal: DVec3,
    /// It lies where `slab.0 <= normal . x <= slab.1`; inverted if it can only be drawn in parts.
    pub(super) slab: (f64, f64),
    pub(super) sine: f32,
    pub(super) min: Vec3,
    pub(super) max: Vec3,
    /// Triangles, until a group takes them.
    triangles: Vec<u32>,
    area: f64,
}

impl Node {
    /// A patch of these triangles.
    fn new(mesh: &Welded, grown: &Patches, normal: DVec3, triangles: Vec<u32>, parts: Vec<u32>) -> Self {
        let mut node = Self {
            parts,
            normal,
            slab: (f64::INFINITY, f64::NEG_INFINITY),
            sine: 0.0,
            min: Vec3::INFINITY,
            max: Vec3::NEG_INFINITY,
            triangles,
            area: 0.0,
        };
        let mut cosine = 1.0f64;
        for &t in &node.triangles {
            let cross = grown.cross(t);
            let length = cross.length();
            node.area += length;
            if length > 0.0 {
                cosine = cosine.min(cross.dot(normal) / length);
            }
            for v in mesh.triangles[t as usize] {
                let p = mesh.positions[v as usize];
                let along = normal.dot(p.as_dvec3());
                node.slab = (node.slab.0.min(along), node.slab.1.max(along));
                (node.min, node.max) = (node.min.min(p), node.max.max(p));
            }
        }
        let room = SLAB * f64::from(node.min.abs().max(node.max.abs()).max_element());
        node.slab = (node.slab.0 - room, node.slab.1 + room);
        let sine = if cosine > 0.0 { (1.0 - cosine * cosine).max(0.0).sqrt() + SINE } else { 1.0 };
        node.sine = (sine.min(1.0) as f32).next_up().min(1.0);
        node
    }

    /// A bundle of parts, which has no plane.
    fn bundle(parts: Vec<u32>, nodes: &[Self]) -> Self {
        let own = || parts.iter().map(|&p| &nodes[p as usize]);
        let min = own().fold(Vec3::INFINITY, |m, p| m.min(p.min));
        let max = own().fold(Vec3::NEG_INFINITY, |m, p| m.max(p.max));
        let slab = (f64::INFINITY, f64::NEG_INFINITY);
        Self { parts, normal: DVec3::Z, slab, sine: 1.0, min, max, triangles: Vec::new(), area: 0.0 }
    }

    fn middle(&self) -> DVec3 {
        (self.min.as_dvec3() + self.max.as_dvec3()) * 0.5
    }

    pub(super) fn radius(&self) -> f64 {
        f64::from((self.max - self.min).length()) * 0.5
    }
}

/// A border between two patches: both of them, and how long it is.
pub(super) type Border = (u32, u32, f64);

/// Builds the tree above patches of triangles. Returns all nodes, the patches first, and the number of the root.
pub(super) fn build(
    mesh: &Welded,
    grown: &Patches,
    borders: &[Border],
    rules: &Rules,
) -> (Vec<Node>, Option<u32>) {
    let mut triangles: Vec<Vec<u32>> = vec![Vec::new(); grown.normals.len()];
    for (&(patch, _), t) in grown.of.iter().zip(0..) {
        triangles[patch as usize].push(t);
    }
    let leaves = triangles.into_iter().zip(&grown.normals);
    let mut nodes: Vec<Node> =
        leaves.map(|(own, &normal)| Node::new(mesh, grown, normal, own, Vec::new())).collect();
    let mut group: Vec<u32> = (0..nodes.len() as u32).collect();
    for _ in 0..LEVELS {
        if !join(mesh, grown, borders, rules, &mut nodes, &mut group) {
            break;
        }
    }
    let mut roots = group;
    roots.sort_unstable();
    roots.dedup();
    roots.retain(|&r| nodes[r as usize].radius() >= rules.least);
    let root = bundle(roots, &mut nodes);
    (nodes, root)
}

/// Joins the groups that patches are in to larger ones. Returns whether there were any to join.
fn join(
    mesh: &Welded,
    grown: &Patches,
    borders: &[Border],
    rules: &Rules,
    nodes: &mut Vec<Node>,
    group: &mut [u32],
) -> bool {
    let beside = |&(a, b, length): &Border| {
        let (a, b) = (group[a as usize], group[b as usize]);
        [(a, b, length), (b, a, length)]
    };
    let mut links: Vec<Border> = borders.iter().flat_map(beside).filter(|l| l.0 != l.1).collect();
    links.sort_unstable_by(|x, y| (x.0, x.1).cmp(&(y.0, y.1)).then(x.2.total_cmp(&y.2)));
    let total = |same: &[Border]| (same[0].0, same[0].1, same.iter().map(|l| l.2).sum());
    let links: Vec<Border> = links.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)).map(total).collect();
    let mut seeds: Vec<u32> = links.iter().map(|l| l.0).collect();
    seeds.dedup();
    let area = |n: u32| nodes[n as usize].area;
    seeds.sort_unstable_by(|&a, &b| area(b).total_cmp(&area(a)).then(a.cmp(&b)));
    let mut into: Vec<u32> = (0..nodes.len() as u32).collect();
    let mut taken = vec![false; nodes.len()];
    let mut waiting: BinaryHeap<(u64, u32)> = BinaryHeap::new();
    let mut joined = false;
    for seed in seeds {
        if taken[seed as usize] {
            continue;
        }
        let first = &nodes[seed as usize];
        let plane = Seed {
            middle: first.middle(),
            normal: first.normal,
            cosine: rules.cosine,
            tolerance: rules.tolerance,
        };
        let (mut parts, mut size, enough) = (vec![seed], first.area, first.area * GROWTH);
        waiting.clear();
        taken[seed as usize] = true;
        let mut newest = seed;
        while parts.len() < PARTS && size < enough {
            let from = links.partition_point(|l| l.0 < newest);
            let beside = links[from..].iter().take_while(|l| l.0 == newest);
            // Lengths are not negative, so their bits are in order. Longest first.
            waiting.extend(beside.map(|&(_, other, length)| (length.to_bits(), other)));
            let fits = |&(_, other): &(u64, u32)| {
                let other = &nodes[other as usize];
                // Larger ones were seeds themselves.
                other.area <= first.area
                    && other.triangles.iter().all(|&t| plane.takes(mesh.corners(t as usize), grown.cross(t)))
            };
            let mut free = std::iter::from_fn(|| waiting.pop()).filter(|w| !taken[w.1 as usize]);
            let Some((_, next)) = free.find(fits) else { break };
            taken[next as usize] = true;
            size += nodes[next as usize].area;
            parts.push(next);
            newest = next;
        }
        if parts.len() < 2 {
            taken[seed as usize] = false;
            continue;
        }
        joined = true;
        let triangles: Vec<u32> =
            parts.iter().flat_map(|&p| std::mem::take(&mut nodes[p as usize].triangles)).collect();
        let sum: DVec3 = triangles.iter().map(|&t| grown.cross(t)).sum();
        let normal = sum.try_normalize().unwrap_or(nodes[seed as usize].normal);
        parts.iter().for_each(|&p| into[p as usize] = nodes.len() as u32);
        nodes.push(Node::new(mesh, grown, normal, triangles, parts));
    }
    group.iter_mut().for_each(|g| *g = into[*g as usize]);
    joined
}

/// Bundles nodes that lie together. Returns the one above all.
fn bundle(mut all: Vec<u32>, nodes: &mut Vec<Node>) -> Option<u32> {
    if all.len() <= 1 {
        return all.pop();
    }
    let parts: Vec<u32> = if all.len() <= BUNDLE {
        all
    } else {
        // Halves of halves of halves.
        let mut pieces = vec![all];
        for _ in 0..BUNDLE.ilog2() {
            pieces = pieces.into_iter().flat_map(|piece| halve(piece, nodes)).collect();
        }
        pieces.into_iter().filter_map(|piece| bundle(piece, nodes)).collect()
    };
    let bundle = Node::bundle(parts, nodes);
    nodes.push(bundle);
    Some(nodes.len() as u32 - 1)
}

/// Two halves of a list, along the longest axis of their middles.
fn halve(mut all: Vec<u32>, nodes: &[Node]) -> [Vec<u32>; 2] {
    let middle = |n: u32| nodes[n as usize].middle();
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &n in &all {
        (min, max) = (min.min(middle(n)), max.max(middle(n)));
    }
    let axis = (max - min).max_position();
    all.sort_by(|&a, &b| middle(a)[axis].total_cmp(&middle(b)[axis]).then(a.cmp(&b)));
    let second = all.split_off(all.len() / 2);
    [all, second]
}
