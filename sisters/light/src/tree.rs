//! Which triangle a ray meets first, exactly: a tree of boxes in single precision, all a little too
//! large, around the test of Möller and Trumbore (1997) in double precision. Nodes have four
//! parts, whose boxes are tested together, and are split by the surface area heuristic (Wald 2007).

use std::sync::Arc;

use glam::{DVec3, IVec3, Vec3A, Vec4};
use smallvec::SmallVec;

use crate::clip::{inside, range};
use crate::lattice::Lattice;
#[cfg(feature = "gpu")]
use crate::numeric::LEAVES;
use crate::numeric::{BINS, BOX, GROW, LEAF, LEVEL, NO_WAY};
use crate::surfaces::Surface;
use crate::texture::Skin;

/// A triangle as rays are tested against it.
#[derive(Debug, Clone)]
struct Facet {
    corner: DVec3,
    first: DVec3,
    second: DVec3,
    /// [`Surface::slack`].
    slack: [f64; 3],
    surface: u32,
    /// Its texture, if that has holes.
    holes: Option<Arc<Skin>>,
}

impl Facet {
    fn new(s: &Surface, surface: u32) -> Self {
        let [a, b, c] = s.corners;
        let holes = s.skin.clone().filter(|skin| skin.texture.has_holes());
        Self { corner: a, first: b - a, second: c - a, slack: s.slack(), surface, holes }
    }

    /// The distance along a unit direction at which a ray meets it, if it does ahead.
    fn meet(&self, from: DVec3, direction: DVec3) -> Option<f64> {
        let p = direction.cross(self.second);
        let determinant = self.first.dot(p);
        let way = from - self.corner;
        let u = way.dot(p) / determinant;
        if u < -self.slack[1] {
            return None;
        }
        let q = way.cross(self.first);
        let v = direction.dot(q) / determinant;
        let distance = self.second.dot(q) / determinant;
        // Comparisons with NaN, of parallel rays, fail.
        let is_in = v >= -self.slack[2] && 1.0 - u - v >= -self.slack[0];
        let is_solid = || self.holes.as_ref().is_none_or(|skin| skin.is_solid([u, v]));
        (is_in && distance >= 0.0 && is_solid()).then_some(distance)
    }
}

/// A box that is not too small.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    low: Vec3A,
    high: Vec3A,
}

impl Bounds {
    const NONE: Self = Self { low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY };

    fn with(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Half of its area.
    fn area(&self) -> f32 {
        let d = (self.high - self.low).max(Vec3A::ZERO);
        d.x * d.y + d.y * d.z + d.z * d.x
    }
}

/// A part of the tree: a node by its number, or so many facets from one on.
#[derive(Debug, Clone, Copy, Default)]
struct Part {
    first: u32,
    /// 0 for a node.
    count: u32,
}

/// Four parts and their boxes, by axis. A part that is missing has an empty box.
#[derive(Debug, Clone, Copy)]
struct Node {
    low: [Vec4; 3],
    high: [Vec4; 3],
    parts: [Part; 4],
}

impl Node {
    const EMPTY: Self = Self {
        low: [Vec4::INFINITY; 3],
        high: [Vec4::NEG_INFINITY; 3],
        parts: [Part { first: 0, count: 0 }; 4],
    };

    fn set(&mut self, at: usize, part: Part, bounds: &Bounds) {
        self.parts[at] = part;
        for axis in 0..3 {
            self.low[axis][at] = bounds.low[axis];
            self.high[axis][at] = bounds.high[axis];
        }
    }
}

/// The box of a triangle, while the tree is built.
#[derive(Clone, Copy)]
struct Item {
    bounds: Bounds,
    surface: u32,
}

impl Item {
    fn middle(&self) -> Vec3A {
        0.5 * (self.bounds.low + self.bounds.high)
    }
}

/// Triangles in boxes.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tree {
    size: DVec3,
    nodes: Vec<Node>,
    facets: Vec<Facet>,
}

/// The part of a ray inside a box, as distances; the first one is not negative.
pub(crate) fn within(from: DVec3, direction: DVec3, low: DVec3, high: DVec3) -> Option<(f64, f64)> {
    let (mut start, mut end) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        if direction[axis] == 0.0 {
            if from[axis] < low[axis] || from[axis] > high[axis] {
                return None;
            }
            continue;
        }
        let a = (low[axis] - from[axis]) / direction[axis];
        let b = (high[axis] - from[axis]) / direction[axis];
        (start, end) = (start.max(a.min(b)), end.min(a.max(b)));
    }
    (start <= end).then_some((start, end))
}

impl Tree {
    /// Some of the triangles in a lattice, as far as they are inside. O(n log n) for n triangles.
    pub(crate) fn new(lattice: &Lattice, surfaces: &[Surface], is_in: impl Fn(&Surface) -> bool) -> Self {
        let mut tree = Self { size: lattice.dims.as_dvec3(), ..Self::default() };
        let mut items: Vec<Item> = (0..)
            .zip(surfaces)
            .filter(|(_, s)| is_in(s))
            .filter_map(|(surface, s)| {
                let part = inside(&s.polygon(), IVec3::ZERO, lattice.dims, GROW);
                let [x, y, z] = [0, 1, 2].map(|axis| range(&part, axis));
                let low = DVec3::new(x.0, y.0, z.0) - BOX;
                let high = DVec3::new(x.1, y.1, z.1) + BOX;
                let bounds = Bounds { low: low.as_vec3a(), high: high.as_vec3a() };
                (!part.is_empty()).then_some(Item { bounds, surface })
            })
            .collect();
        tree.facets.reserve_exact(items.len());
        tree.add(&mut items, surfaces, 0);
        tree
    }

    /// Adds a node of items, the root as the first one.
    fn add(&mut self, items: &mut [Item], surfaces: &[Surface], level: u32) {
        let number = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        let mut groups: SmallVec<[(&mut [Item], Bounds, u32); 4]> = SmallVec::new();
        let bounds = around(items);
        groups.push((items, bounds, level));
        while groups.len() < 4 {
            // The largest one is met most often.
            let size = |i: &usize| groups[*i].1.area();
            let can = (0..groups.len()).filter(|i| groups[*i].0.len() > LEAF);
            let Some(largest) = can.max_by(|a, b| size(a).total_cmp(&size(b))) else { break };
            let (items, _, level) = groups.swap_remove(largest);
            let at = split(items, level).clamp(1, items.len() - 1);
            let (low, high) = items.split_at_mut(at);
            for part in [low, high] {
                let bounds = around(part);
                groups.push((part, bounds, level + 1));
            }
        }
        for (at, (items, bounds, level)) in groups.into_iter().enumerate() {
            if items.len() <= LEAF {
                let part = Part { first: self.facets.len() as u32, count: items.len() as u32 };
                let facet = |i: &Item| Facet::new(&surfaces[i.surface as usize], i.surface);
                self.facets.extend(items.iter().map(facet));
                // A node without items has one part, which is empty.
                self.nodes[number].set(at, part, &bounds);
            } else {
                let part = Part { first: self.nodes.len() as u32, count: 0 };
                self.nodes[number].set(at, part, &bounds);
                self.add(items, surfaces, level);
            }
        }
    }

    /// The triangle that a ray meets first within a reach along a unit direction, with its
    /// distance; of equal distances the first triangle. Outside of the lattice there is none.
    pub(crate) fn first(&self, from: DVec3, direction: DVec3, reach: f64) -> Option<(f64, u32)> {
        let mut best = (reach, u32::MAX);
        self.visit(from, direction, reach, |distance, surface, _| {
            if (distance, surface) < best {
                best = (distance, surface);
            }
            Some(best.0)
        });
        (best.1 != u32::MAX).then_some(best)
    }

    /// The place of a triangle that a ray meets within a reach along a unit direction; that of
    /// `hint` is tried first.
    pub(crate) fn blocker(&self, from: DVec3, direction: DVec3, reach: f64, hint: u32) -> Option<u32> {
        let met = |f: &Facet| self.meet(f, from, direction).is_some_and(|d| d <= reach);
        if self.facets.get(hint as usize).is_some_and(met) {
            return Some(hint);
        }
        let mut found = None;
        self.visit(from, direction, reach, |_, _, place| {
            found = Some(place);
            None
        });
        found
    }

    /// The distance at which a ray meets a facet inside of the lattice.
    fn meet(&self, facet: &Facet, from: DVec3, direction: DVec3) -> Option<f64> {
        let is_inside = |d: &f64| {
            let at = from + direction * *d;
            at.cmpge(DVec3::splat(-GROW)).all() && at.cmple(self.size + GROW).all()
        };
        facet.meet(from, direction).filter(is_inside)
    }

    /// Where a ray enters the lattice, if it does.
    fn enter(&self, from: DVec3, direction: DVec3) -> Option<f64> {
        let is_inside = from.cmpge(DVec3::ZERO).all() && from.cmple(self.size).all();
        if is_inside { Some(0.0) } else { within(from, direction, DVec3::ZERO, self.size).map(|w| w.0) }
    }

    /// Calls `met` with the distances, the numbers and the places of triangles that a ray meets; it
    /// returns the new reach, or `None` to end.
    fn visit(
        &self,
        from: DVec3,
        direction: DVec3,
        reach: f64,
        mut met: impl FnMut(f64, u32, u32) -> Option<f64>,
    ) {
        let Some(start) = self.enter(from, direction).filter(|s| *s <= reach) else { return };
        let mut reach = reach;
        // Boxes are met from inside of the lattice, where single precision is fine enough.
        let near = (from + direction * start).as_vec3a();
        let way = direction.as_vec3a();
        let way = Vec3A::select(way.abs().cmplt(Vec3A::splat(NO_WAY)), Vec3A::splat(NO_WAY), way);
        let inverse = way.recip();
        let (near, slope) =
            ([0, 1, 2].map(|a| Vec4::splat(near[a])), [0, 1, 2].map(|a| Vec4::splat(inverse[a])));
        let is_back = [0, 1, 2].map(|axis| inverse[axis] < 0.0);
        let in_boxes = |reach: f64| (reach - start + BOX) as f32;
        let mut limit = in_boxes(reach);
        let mut rest: SmallVec<[(f32, Part); 64]> = SmallVec::new();
        rest.push((0.0, Part { first: 0, count: 0 }));
        while let Some((enter, part)) = rest.pop() {
            if enter > limit {
                continue;
            }
            if part.count > 0 {
                let first = part.first as usize;
                for (place, facet) in (part.first..).zip(&self.facets[first..first + part.count as usize]) {
                    let distance = self.meet(facet, from, direction).filter(|d| *d <= reach);
                    let Some(distance) = distance else { continue };
                    match met(distance, facet.surface, place) {
                        Some(less) => reach = less,
                        None => return,
                    }
                    limit = in_boxes(reach);
                }
                continue;
            }
            let node = &self.nodes[part.first as usize];
            let (mut enter, mut leave) = (Vec4::ZERO, Vec4::splat(limit));
            for axis in 0..3 {
                let [low, high] = match is_back[axis] {
                    false => [node.low[axis], node.high[axis]],
                    true => [node.high[axis], node.low[axis]],
                };
                enter = enter.max((low - near[axis]) * slope[axis]);
                leave = leave.min((high - near[axis]) * slope[axis]);
            }
            let mut hits = enter.cmple(leave).bitmask();
            let (enter, bottom) = (enter.to_array(), rest.len());
            while hits != 0 {
                let at = hits.trailing_zeros() as usize;
                hits &= hits - 1;
                rest.push((enter[at], node.parts[at]));
                // The nearest one is to be last.
                let mut i = rest.len() - 1;
                while i > bottom && rest[i - 1].0 < rest[i].0 {
                    rest.swap(i - 1, i);
                    i -= 1;
                }
            }
        }
    }

    /// How many triangles it has.
    pub(crate) fn count(&self) -> usize {
        self.facets.len()
    }

    /// Gives its triangles other numbers, by their old ones.
    pub(crate) fn renumber(&mut self, numbers: &[u32]) {
        self.facets.iter_mut().for_each(|f| f.surface = numbers[f.surface as usize]);
    }

    /// For walks without a stack: adds all parts in the order in which a walk meets them, and the
    /// triangles of leaves. Eight numbers of a part are the bits of its least and its greatest
    /// corner, the part that follows those inside of it, and 0 or, of a leaf, the place of its
    /// first triangle times [`LEAVES`] and their number.
    #[cfg(feature = "gpu")]
    pub(crate) fn add_flat(&self, parts: &mut Vec<[u32; 8]>, triangles: &mut Vec<u32>) {
        if !self.nodes.is_empty() {
            self.flatten(0, triangles.len() as u32, parts);
        }
        triangles.extend(self.facets.iter().map(|f| f.surface));
    }

    #[cfg(feature = "gpu")]
    fn flatten(&self, node: usize, before: u32, parts: &mut Vec<[u32; 8]>) {
        let node = &self.nodes[node];
        for (i, part) in node.parts.iter().enumerate() {
            let corner = |of: &[Vec4; 3]| [0, 1, 2].map(|axis| of[axis][i]);
            let (low, high) = (corner(&node.low), corner(&node.high));
            if low[0] > high[0] {
                // Missing.
                continue;
            }
            let at = parts.len();
            let [a, b, c] = low.map(f32::to_bits);
            let [x, y, z] = high.map(f32::to_bits);
            parts.push([
                a,
                b,
                c,
                x,
                y,
                z,
                0,
                (before + part.first) * LEAVES * part.count.min(1) + part.count,
            ]);
            if part.count == 0 {
                self.flatten(part.first as usize, before, parts);
            }
            parts[at][6] = parts.len() as u32;
        }
    }

    /// Bytes of all parts.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.facets[..])
    }
}

/// The box around items.
fn around(items: &[Item]) -> Bounds {
    items.iter().fold(Bounds::NONE, |b, i| b.with(i.bounds))
}

/// Sorts items into two parts, and returns where the second one starts.
fn split(items: &mut [Item], level: u32) -> usize {
    let half = items.len() / 2;
    let middles = items.iter().fold(Bounds::NONE, |b, i| {
        let middle = i.middle();
        b.with(Bounds { low: middle, high: middle })
    });
    let size = middles.high - middles.low;
    let axis = size.max_position();
    // Halves end the tree, however the boxes lie.
    if level >= LEVEL || size[axis] <= 0.0 {
        let order = |a: &Item, b: &Item| {
            a.middle()[axis].total_cmp(&b.middle()[axis]).then(a.surface.cmp(&b.surface))
        };
        items.select_nth_unstable_by(half, order);
        return half;
    }
    let scale = BINS as f32 / size[axis];
    let bin = |i: &Item| (((i.middle()[axis] - middles.low[axis]) * scale) as usize).min(BINS - 1);
    let mut bins = [(Bounds::NONE, 0_usize); BINS];
    for i in items.iter() {
        let b = &mut bins[bin(i)];
        *b = (b.0.with(i.bounds), b.1 + 1);
    }
    let mut above = [0.0_f32; BINS];
    let mut part = (Bounds::NONE, 0);
    for k in (1..BINS).rev() {
        part = (part.0.with(bins[k].0), part.1 + bins[k].1);
        above[k] = part.0.area() * part.1 as f32;
    }
    let (mut best, mut least) = (1, f32::INFINITY);
    let mut part = (Bounds::NONE, 0);
    for k in 1..BINS {
        part = (part.0.with(bins[k - 1].0), part.1 + bins[k - 1].1);
        let cost = part.0.area() * part.1 as f32 + above[k];
        if cost < least {
            (best, least) = (k, cost);
        }
    }
    let mut at = 0;
    for i in 0..items.len() {
        if bin(&items[i]) < best {
            items.swap(at, i);
            at += 1;
        }
    }
    at
}

#[cfg(test)]
mod tests;
