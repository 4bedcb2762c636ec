//! Hulls whose triangles are joined to flat faces.

use std::ops::Range;

use glam::DVec3;

use crate::geometry::plane::HalfSpace;
use crate::shape::convex::hull::{EdgeNumbers, NONE, edges, lowered, triangles};

/// A closed convex surface.
pub(crate) struct Closed {
    pub(crate) vertices: Vec<DVec3>,
    /// No corner of a face lies strictly inside of its half-space, so that points inside all of
    /// them are inside the hull.
    pub(crate) faces: Vec<HalfSpace>,
    /// Two vertices, and the two faces on both sides.
    pub(crate) edges: Vec<[u16; 4]>,
}

/// Triangles that make one flat face, and the corners around them, as ranges of the lists of all.
struct Facet {
    triangles: Range<usize>,
    ring: Range<usize>,
}

#[derive(Default)]
struct HullFacets {
    all: Vec<Facet>,
    triangles: Vec<usize>,
    rings: Vec<usize>,
}

impl HullFacets {
    /// Adds the facet of the triangles and corners from these places on.
    fn close(&mut self, triangles: usize, ring: usize) {
        self.all.push(Facet { triangles: triangles..self.triangles.len(), ring: ring..self.rings.len() });
    }

    /// Each triangle by itself.
    fn single(triangles: &[[usize; 3]]) -> Self {
        let mut facets = Self::default();
        for (t, corners) in triangles.iter().enumerate() {
            facets.triangles.push(t);
            facets.rings.extend(corners);
            facets.close(t, 3 * t);
        }
        facets
    }

    /// The corners of a facet, each with the next one.
    fn ring(&self, facet: &Facet) -> impl Iterator<Item = (usize, usize)> {
        let ring = &self.rings[facet.ring.clone()];
        let next = ring.get(1..).unwrap_or(&[]).iter().chain(ring.first());
        ring.iter().copied().zip(next.copied())
    }
}

/// The corner after each corner of a ring. Its memory is used again.
struct RingOrder {
    next: Vec<usize>,
}

impl RingOrder {
    /// Appends the corners around a set of triangles, if they bound it in one ring; else changes
    /// nothing.
    fn append(
        &mut self,
        triangles: &[[usize; 3]],
        sides: &EdgeNumbers,
        own: &[usize],
        is_own: impl Fn(u32) -> bool,
        ring: &mut Vec<usize>,
    ) -> bool {
        const LAST: usize = usize::MAX;
        let all = own.iter().flat_map(|&t| edges(triangles[t]));
        let outer = || all.clone().filter(|&(a, b)| !is_own(sides.get(b, a)));
        outer().for_each(|(a, _)| self.next[a] = LAST);
        let (mut count, mut start) = (0, LAST);
        for (a, b) in outer() {
            if self.next[a] != LAST {
                return false;
            }
            self.next[a] = b;
            (count, start) = (count + 1, start.min(a));
        }
        if count == 0 {
            return false;
        }
        let before = ring.len();
        ring.push(start);
        // Each corner of the ring has as many edges that end there as start there.
        let mut at = self.next[start];
        while at != start && ring.len() - before <= count {
            ring.push(at);
            at = self.next[at];
        }
        let whole = ring.len() - before == count;
        if !whole {
            ring.truncate(before);
        }
        whole
    }
}

/// Joins triangles that lie in one plane to within `flat`.
fn facets(points: &[DVec3], triangles: &[[usize; 3]], flat: f64) -> HullFacets {
    let mut sides = EdgeNumbers::new(points.len());
    for (t, corners) in triangles.iter().enumerate() {
        edges(*corners).into_iter().for_each(|(a, b)| sides.set(a, b, t as u32));
    }
    let normal = |corners: &[usize; 3]| {
        let [a, b, c] = corners.map(|i| points[i]);
        (b - a).cross(c - a)
    };
    let normals: Vec<DVec3> = triangles.iter().map(normal).collect();
    let mut order: Vec<(f64, usize)> = normals.iter().map(|n| n.length()).zip(0..).collect();
    order.sort_unstable_by(|s, t| t.0.total_cmp(&s.0).then(s.1.cmp(&t.1)));
    // The facet that has taken each triangle.
    let mut taken = vec![NONE; triangles.len()];
    let mut rings = RingOrder { next: vec![0; points.len()] };
    let mut facets = HullFacets::default();
    for (_, seed) in order {
        if taken[seed] != NONE {
            continue;
        }
        let (n, anchor) = (normals[seed].normalize_or_zero(), points[triangles[seed][0]]);
        let joins = |t: usize| triangles[t].iter().all(|&i| n.dot(points[i] - anchor).abs() <= flat);
        let number = facets.all.len() as u32;
        let (first, ring) = (facets.triangles.len(), facets.rings.len());
        facets.triangles.push(seed);
        taken[seed] = number;
        let mut at = first;
        while at < facets.triangles.len() && n != DVec3::ZERO {
            for (a, b) in edges(triangles[facets.triangles[at]]) {
                let other = sides.get(b, a);
                if other != NONE && taken[other as usize] == NONE && joins(other as usize) {
                    taken[other as usize] = number;
                    facets.triangles.push(other as usize);
                }
            }
            at += 1;
        }
        let is_own = |t: u32| t != NONE && taken[t as usize] == number;
        let HullFacets { triangles: own, rings: all, .. } = &mut facets;
        // One triangle always has a ring.
        if !rings.append(triangles, &sides, &own[first..], is_own, all) {
            own.drain(first + 1..).for_each(|t| taken[t] = NONE);
            all.extend(triangles[seed]);
        }
        facets.close(first, ring);
    }
    facets
}

/// The hull of points, without those no farther than `keep` from the hull of the others, with
/// triangles joined that lie in one plane to within `flat`; `None` if the points are flat.
pub(crate) fn closed(points: &[DVec3], keep: f64, flat: f64) -> Option<Closed> {
    let triangles = triangles(points, keep)?;
    assembled(points, &triangles, &facets(points, &triangles, flat))
        .or_else(|| assembled(points, &triangles, &HullFacets::single(&triangles)))
}

/// Numbers corners and edges, and lowers each face to the lowest corner of its triangles. A point
/// outside of the hull lies beyond one of its triangles, as seen from the middle, so it lies beyond
/// that triangle's face.
fn assembled(points: &[DVec3], triangles: &[[usize; 3]], facets: &HullFacets) -> Option<Closed> {
    let mut number = vec![u16::MAX; points.len()];
    let mut vertices: Vec<DVec3> = Vec::new();
    let mut sides = EdgeNumbers::new(points.len());
    for (f, facet) in facets.all.iter().enumerate() {
        for (a, b) in facets.ring(facet) {
            if number[a] == u16::MAX {
                number[a] = vertices.len() as u16;
                vertices.push(points[a]);
            }
            sides.set(a, b, f as u32);
        }
    }
    let mut edges = Vec::with_capacity(facets.rings.len() / 2);
    for (f, facet) in facets.all.iter().enumerate() {
        for (a, b) in facets.ring(facet) {
            let g = Some(sides.get(b, a)).filter(|&g| g != NONE)?;
            match (g as usize).cmp(&f) {
                std::cmp::Ordering::Equal => return None,
                std::cmp::Ordering::Greater => edges.push([number[a], number[b], f as u16, g as u16]),
                std::cmp::Ordering::Less => {}
            }
        }
    }
    let largest = vertices.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let middle = vertices.iter().sum::<DVec3>() / vertices.len().max(1) as f64;
    let mut faces = Vec::with_capacity(facets.all.len());
    for facet in &facets.all {
        let own =
            || facets.triangles[facet.triangles.clone()].iter().map(|&t| triangles[t].map(|i| points[i]));
        let n = own().map(|[a, b, c]| (b - a).cross(c - a)).sum::<DVec3>().normalize_or_zero();
        let least = own().flatten().map(|p| n.dot(p)).fold(f64::INFINITY, f64::min);
        let h = lowered(least, largest);
        let inwards = h - n.dot(middle);
        if inwards.is_nan() || inwards <= 0.0 {
            return None;
        }
        faces.push(HalfSpace { normal: -n, offset: h });
    }
    let whole = faces.len() >= 4 && vertices.len() + faces.len() == edges.len() + 2;
    whole.then_some(Closed { vertices, faces, edges })
}
