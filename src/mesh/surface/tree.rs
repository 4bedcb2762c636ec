//! The tree of patches: groups of patches that are drawn as one from afar.
//!
//! Patches that share sides are joined to groups, and those again, as long as the directions of
//! their triangles differ little enough. Inside a group the sides of its parts cancel, so it has
//! fewer sides than they have together, but its slab is thicker: a query draws a group where that
//! makes no difference, and its parts where it does. Groups that lie together are bundled at last,
//! whatever their directions: bundles have no outlines.
//!
//! After the clusters of triangles in hierarchical levels of detail (Cignoni et al. 2005); nothing
//! is simplified here.

use std::collections::BinaryHeap;

use glam::{DVec3, Vec3, Vec3A};
use smallvec::{SmallVec, smallvec};

use crate::error::Error;
use crate::mesh::preparation::Progress;
use crate::mesh::surface::facets::Facets;
use crate::mesh::surface::groups::{Groups, SharedBorder};
use crate::mesh::surface::grow::{Patches, Seed};
use crate::mesh::surface::halves::{Item, halve, rank};
use crate::mesh::surface::patch::Rules;
use crate::mesh::surface::weld::Welded;
use crate::numeric::lesser;
use crate::numeric::mesh::{SINE, SLAB};

/// A group grows until it is this many times as large as its first part.
const GROWTH: f64 = 4.0;

/// The most parts of a group, and of a bundle.
const PARTS: usize = 64;
const BUNDLE: usize = 8;

/// Lists of up to this many nodes are sorted where they are halved: their halves may be bundles,
/// whose parts are in order.
const SORTED: usize = 2 * BUNDLE + 1;

/// How often groups are joined, at most.
const LEVELS: usize = 24;

/// A patch of the tree as it is built.
pub(super) struct PatchNode {
    /// Its parts: where they start in the list of all, and how many there are.
    parts: (u32, u32),
    /// The patches of triangles in it, likewise; none if it is such a patch.
    patches: (u32, u32),
    pub(super) normal: DVec3,
    /// It lies where `slab.0 <= normal . x <= slab.1`; inverted if it can only be drawn in parts.
    pub(super) slab: (f64, f64),
    pub(super) sine: f32,
    pub(super) min: Vec3,
    pub(super) max: Vec3,
    area: f64,
}

impl PatchNode {
    /// A patch of triangles, or a group of several.
    fn of(facets: &Facets, normal: DVec3, patches: &[u32]) -> Self {
        let mut extent = Spread::new(normal);
        for &patch in patches {
            extent.add(facets.crosses(patch), facets.points(patch));
        }
        extent.node()
    }

    /// A bundle of parts, which has no plane.
    fn bundle(parts: &[u32], nodes: &[Self]) -> Self {
        let own = || parts.iter().map(|&p| &nodes[p as usize]);
        let min = own().fold(Vec3::INFINITY, |m, p| m.min(p.min));
        let max = own().fold(Vec3::NEG_INFINITY, |m, p| m.max(p.max));
        let slab = (f64::INFINITY, f64::NEG_INFINITY);
        let (normal, none) = (DVec3::Z, (0, 0));
        Self { parts: none, patches: none, normal, slab, sine: 1.0, min, max, area: 0.0 }
    }

    fn middle(&self) -> DVec3 {
        (self.min.as_dvec3() + self.max.as_dvec3()) * 0.5
    }

    pub(super) fn radius(&self) -> f64 {
        f64::from((self.max - self.min).length()) * 0.5
    }
}

/// How far triangles reach, and how much they are turned from a normal.
struct Spread {
    normal: DVec3,
    /// The least cosine between the normal and triangles.
    cosine: f64,
    area: f64,
    slab: (f64, f64),
    min: Vec3A,
    max: Vec3A,
}

impl Spread {
    fn new(normal: DVec3) -> Self {
        let (slab, min, max) = ((f64::INFINITY, f64::NEG_INFINITY), Vec3A::INFINITY, Vec3A::NEG_INFINITY);
        Self { normal, cosine: 1.0, area: 0.0, slab, min, max }
    }

    /// Adds triangles with these cross products, each with its length, and these corners.
    fn add(&mut self, crosses: &[(DVec3, f64)], points: &[Vec3]) {
        for &(cross, length) in crosses {
            self.area += length;
            if length > 0.0 {
                self.cosine = lesser(cross.dot(self.normal) / length, self.cosine);
            }
        }
        let (mut lo, mut hi) = self.slab;
        for p in points {
            let along = self.normal.dot(p.as_dvec3());
            (lo, hi) = (if along < lo { along } else { lo }, if along > hi { along } else { hi });
            let p = Vec3A::from(*p);
            (self.min, self.max) = (self.min.min(p), self.max.max(p));
        }
        self.slab = (lo, hi);
    }

    fn node(self) -> PatchNode {
        let Self { normal, cosine, area, slab: (lo, hi), min, max } = self;
        let (min, max) = (Vec3::from(min), Vec3::from(max));
        let room = SLAB * f64::from(min.abs().max(max.abs()).max_element());
        let sine = sine(cosine);
        let (none, slab) = ((0, 0), (lo - room, hi + room));
        PatchNode { parts: none, patches: none, normal, slab, sine, min, max, area }
    }
}

/// Patches of triangles, groups of them, groups of groups and bundles of those.
pub(super) struct Tree {
    /// The patches of triangles first.
    pub(super) nodes: Vec<PatchNode>,
    root: Option<u32>,
    /// The parts of all nodes, and the patches of triangles in them.
    parts: Vec<u32>,
    patches: Vec<u32>,
}

impl Tree {
    /// Builds the tree above patches of triangles.
    ///
    /// # Errors
    /// Only [`Error::Cancelled`].
    pub(super) fn new(
        mesh: &Welded,
        grown: &Patches,
        borders: Vec<SharedBorder>,
        rules: &Rules,
        progress: &mut Progress,
    ) -> Result<Self, Error> {
        let count = grown.seeds.len();
        let facets = Facets::new(mesh, grown);
        let mut nodes = Vec::with_capacity(count + count / 4);
        nodes.extend((0..count as u32).map(|p| PatchNode::of(&facets, grown.normal(p), &[p])));
        let mut tree = Self { nodes, root: None, parts: Vec::new(), patches: Vec::new() };
        let mut groups = Groups::new(borders, count, |n| tree.node(n).area);
        for level in 0..LEVELS {
            // Each level has about half as many groups as the one before.
            progress.tell(1.0 - 0.5f32.powi(level as i32))?;
            if !tree.join(&facets, rules, &mut groups) {
                break;
            }
        }
        drop(facets);
        let mut roots: Vec<u32> = (0..tree.nodes.len() as u32).filter(|&n| !groups.is_part(n)).collect();
        roots.retain(|&r| tree.node(r).radius() >= rules.least);
        if roots.len() <= BUNDLE {
            roots.sort_by_key(|&r| rank(grown, r));
        }
        let mut roots: Vec<Item> = roots.into_iter().map(|node| tree.item(node)).collect();
        tree.root = tree.bundle(grown, &mut roots);
        Ok(tree)
    }

    fn item(&self, node: u32) -> Item {
        Item::new(node, self.node(node).middle())
    }

    fn node(&self, node: u32) -> &PatchNode {
        &self.nodes[node as usize]
    }

    /// The parts of a node.
    pub(super) fn parts(&self, node: u32) -> &[u32] {
        let (first, count) = self.node(node).parts;
        &self.parts[first as usize..][..count as usize]
    }

    /// The patches of triangles in a node that is no bundle.
    fn patches<'a>(&'a self, node: &'a u32) -> &'a [u32] {
        match self.node(*node).patches {
            (_, 0) => std::slice::from_ref(node),
            (first, count) => &self.patches[first as usize..][..count as usize],
        }
    }

    /// The nodes below the root, each one before its parts.
    pub(super) fn in_order(&self) -> Vec<u32> {
        let mut order = Vec::with_capacity(self.nodes.len());
        let mut waiting: Vec<u32> = self.root.into_iter().collect();
        while let Some(node) = waiting.pop() {
            order.push(node);
            waiting.extend(self.parts(node).iter().rev());
        }
        order
    }

    fn push(&mut self, node: PatchNode, patches: &[u32], parts: &[u32]) {
        let node = PatchNode {
            parts: (self.parts.len() as u32, parts.len() as u32),
            patches: (self.patches.len() as u32, patches.len() as u32),
            ..node
        };
        self.patches.extend_from_slice(patches);
        self.parts.extend_from_slice(parts);
        self.nodes.push(node);
    }

    /// Joins groups to larger ones. Returns whether there were any to join.
    fn join(&mut self, facets: &Facets, rules: &Rules, groups: &mut Groups) -> bool {
        let links = groups.links();
        let mut waiting: BinaryHeap<(u64, u32)> = BinaryHeap::new();
        let first_new = self.nodes.len() as u32;
        let (mut parts, mut patches) = (Vec::new(), Vec::new());
        let mut seeds = std::mem::take(&mut groups.seeds);
        seeds.retain(|&(_, seed)| {
            if groups.is_part(seed) {
                return false;
            }
            let first = self.node(seed);
            let plane = Seed {
                middle: first.middle(),
                normal: first.normal,
                cosine: rules.cosine,
                tolerance: rules.tolerance,
            };
            parts.clear();
            parts.push(seed);
            let (mut size, enough) = (first.area, first.area * GROWTH);
            waiting.clear();
            let (mut newest, mut passed) = (seed, false);
            while parts.len() < PARTS && size < enough {
                waiting.extend(links.of(newest).iter().map(|&(other, length)| (length, other)));
                let fits = |&(_, other): &(u64, u32)| {
                    if other == seed || groups.is_part(other) {
                        passed = true;
                        return false;
                    }
                    // Larger ones were seeds themselves.
                    self.node(other).area <= first.area
                        && self.patches(&other).iter().all(|&p| facets.fit(p, &plane))
                };
                let found = std::iter::from_fn(|| waiting.pop()).find(fits);
                let Some((_, next)) = found else { break };
                groups.put(next, self.nodes.len() as u32);
                size += self.node(next).area;
                parts.push(next);
                newest = next;
            }
            if parts.len() < 2 {
                // Neighbours that do not fit never will, nor will groups that contain them.
                return passed;
            }
            groups.put(seed, self.nodes.len() as u32);
            patches.clear();
            patches.extend(parts.iter().flat_map(|p| self.patches(p)).copied());
            let sum: DVec3 = patches.iter().flat_map(|&p| facets.crosses(p)).map(|c| c.0).sum();
            let normal = sum.try_normalize().unwrap_or(first.normal);
            let node = PatchNode::of(facets, normal, &patches);
            self.push(node, &patches, &parts);
            false
        });
        groups.seeds = seeds;
        groups.extend(first_new, self.nodes.len(), |n| self.node(n).area);
        self.nodes.len() as u32 > first_new
    }

    /// Bundles nodes that lie together. Returns the one above all.
    fn bundle(&mut self, grown: &Patches, all: &mut [Item]) -> Option<u32> {
        if all.len() <= 1 {
            return all.first().map(|item| item.node);
        }
        let mut parts: SmallVec<[u32; BUNDLE]> = SmallVec::new();
        if all.len() <= BUNDLE {
            parts.extend(all.iter().map(|item| item.node));
        } else {
            // Halves of halves of halves.
            let mut pieces: SmallVec<[&mut [Item]; BUNDLE]> = smallvec![all];
            for _ in 0..BUNDLE.ilog2() {
                pieces = pieces.into_iter().flat_map(|piece| halve(piece, SORTED, grown)).collect();
            }
            parts.extend(pieces.into_iter().filter_map(|piece| self.bundle(grown, piece)));
        }
        let bundle = PatchNode::bundle(&parts, &self.nodes);
        self.push(bundle, &[], &parts);
        Some(self.nodes.len() as u32 - 1)
    }
}

/// The sine of an angle of which a cosine is known, rounded up.
fn sine(cosine: f64) -> f32 {
    let sine = if cosine > 0.0 { (1.0 - cosine * cosine).max(0.0).sqrt() + SINE } else { 1.0 };
    (sine.min(1.0) as f32).next_up().min(1.0)
}
