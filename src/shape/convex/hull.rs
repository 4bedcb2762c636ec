//! Hulls of points. Which corners share a face is decided exactly.
//!
//! Points join one after another, farthest first. Exact predicates (Shewchuk 1997) decide which
//! triangles a point sees, so the surface always closes. Points next to the hull are left out: that
//! makes it smaller only.

use std::collections::{HashMap, HashSet};

use glam::DVec3;
use robust::{Coord3D, orient3d};

use crate::geometry::plane::HalfSpace;
use crate::numeric::shape::DISTANCE;

/// The offset of a face whose lowest corner is at `least`, so low that no rounding lifts it above
/// that corner.
pub(crate) fn lowered(least: f64, largest: f64) -> f64 {
    least - DISTANCE * largest
}

/// A closed convex surface.
pub(crate) struct Closed {
    pub(crate) vertices: Vec<DVec3>,
    /// No corner of a face lies strictly inside of its half-space, so that points inside all of
    /// them are inside the hull.
    pub(crate) faces: Vec<HalfSpace>,
    /// Two vertices, and the two faces on both sides.
    pub(crate) edges: Vec<[u16; 4]>,
}

/// Triangles that make one flat face, and the corners around them.
struct Facet {
    triangles: Vec<usize>,
    ring: Vec<usize>,
}

/// Whether a point lies strictly outside of a triangle that is seen counterclockwise from outside.
fn sees(points: &[DVec3], [a, b, c]: [usize; 3], p: DVec3) -> bool {
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    orient3d(coord(points[a]), coord(points[b]), coord(points[c]), coord(p)) < 0.0
}

/// Whether a point lies strictly inside of a surface.
pub(crate) fn surrounds(points: &[DVec3], triangles: &[[usize; 3]], p: DVec3) -> bool {
    // Outside of the triangle turned over is inside of it.
    triangles.iter().all(|&[a, b, c]| sees(points, [a, c, b], p))
}

/// Distance from a point to a triangle; exact but for rounding.
fn distance(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let n = (b - a).cross(c - a);
    let beside = |u: DVec3, v: DVec3| n.cross(v - u).dot(p - u) < 0.0;
    if n != DVec3::ZERO && !beside(a, b) && !beside(b, c) && !beside(c, a) {
        return n.normalize().dot(p - a).abs();
    }
    let to_edge = |u: DVec3, v: DVec3| {
        let along = v - u;
        let t = (along.dot(p - u) / along.length_squared()).clamp(0.0, 1.0);
        // Two corners at one place have no direction.
        (p - (u + along * if t.is_nan() { 0.0 } else { t })).length()
    };
    to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a))
}

/// The triangles of the hull, seen counterclockwise from outside. Points no farther than `keep`
/// from the hull of the others are left out; `None` if all lie that close to one plane.
pub(crate) fn triangles(points: &[DVec3], keep: f64) -> Option<Vec<[usize; 3]>> {
    let corner = |i: usize| points[i];
    let mut hull = first(points, keep)?;
    // How far points lie outside; upper bounds, since the hull grows.
    let mut beyond: Vec<f64> = vec![f64::INFINITY; points.len()];
    hull.iter().flatten().for_each(|&i| beyond[i] = 0.0);
    loop {
        let farthest = (0..points.len()).max_by(|&i, &j| beyond[i].total_cmp(&beyond[j]))?;
        if beyond[farthest] <= keep {
            return Some(hull);
        }
        let p = points[farthest];
        let (seen, kept): (Vec<_>, Vec<_>) = hull.iter().partition(|&&t| sees(points, t, p));
        let nearest =
            seen.iter().map(|t: &[usize; 3]| distance(p, t.map(corner))).fold(f64::INFINITY, f64::min);
        let nearest = if seen.is_empty() { 0.0 } else { nearest };
        let others = (0..points.len()).filter(|&i| i != farthest).map(|i| beyond[i]);
        if nearest <= keep || nearest < others.fold(0.0, f64::max) {
            // Now known for this hull: after one round the farthest is found.
            beyond[farthest] = if nearest <= keep { 0.0 } else { nearest };
            continue;
        }
        let edges = |&[a, b, c]: &[usize; 3]| [(a, b), (b, c), (c, a)];
        let lit: HashSet<(usize, usize)> = seen.iter().flat_map(edges).collect();
        hull = kept;
        for (a, b) in seen.iter().flat_map(edges).filter(|&(a, b)| !lit.contains(&(b, a))) {
            hull.push([a, b, farthest]);
        }
        beyond[farthest] = 0.0;
    }
}

/// A tetrahedron of points far apart.
fn first(points: &[DVec3], keep: f64) -> Option<Vec<[usize; 3]>> {
    let farthest = |from: &dyn Fn(DVec3) -> f64| {
        (0..points.len()).max_by(|&i, &j| from(points[i]).total_cmp(&from(points[j])))
    };
    let a = farthest(&|p| (p - points[0]).length())?;
    let b = farthest(&|p| (p - points[a]).length())?;
    let along = (points[b] - points[a]).normalize_or_zero();
    let c = farthest(&|p| (p - points[a]).cross(along).length())?;
    let n = along.cross(points[c] - points[a]).normalize_or_zero();
    let d = farthest(&|p| n.dot(p - points[a]).abs())?;
    let thick =
        (points[c] - points[a]).cross(along).length() > keep && n.dot(points[d] - points[a]).abs() > keep;
    let (b, c) = if sees(points, [a, b, c], points[d]) { (c, b) } else { (b, c) };
    // Exactly in one plane, whatever rounding said.
    let solid = thick && sees(points, [a, c, b], points[d]);
    solid.then(|| vec![[a, b, c], [a, d, b], [b, d, c], [c, d, a]])
}

/// The corners around a set of triangles, if they bound it in one ring.
fn ring(triangles: &[[usize; 3]], own: &[usize]) -> Option<Vec<usize>> {
    let edges = |&t: &usize| {
        let [a, b, c] = triangles[t];
        [(a, b), (b, c), (c, a)]
    };
    let all: HashSet<(usize, usize)> = own.iter().flat_map(edges).collect();
    let mut next = HashMap::new();
    for &(a, b) in all.iter().filter(|&&(a, b)| !all.contains(&(b, a))) {
        if next.insert(a, b).is_some() {
            return None;
        }
    }
    let start = *next.keys().min()?;
    let mut ring = vec![start];
    let mut at = *next.get(&start)?;
    while at != start {
        ring.push(at);
        at = *next.get(&at)?;
        if ring.len() > next.len() {
            return None;
        }
    }
    (ring.len() == next.len()).then_some(ring)
}

/// Joins triangles that lie in one plane to within `flat`.
fn facets(points: &[DVec3], triangles: &[[usize; 3]], flat: f64) -> Vec<Facet> {
    let mut sides = HashMap::new();
    for (t, &[a, b, c]) in triangles.iter().enumerate() {
        sides.extend([((a, b), t), ((b, c), t), ((c, a), t)]);
    }
    let normal = |t: usize| {
        let [a, b, c] = triangles[t].map(|i| points[i]);
        (b - a).cross(c - a)
    };
    let mut order: Vec<usize> = (0..triangles.len()).collect();
    order.sort_by(|&s, &t| normal(t).length().total_cmp(&normal(s).length()));
    let mut taken = vec![false; triangles.len()];
    let mut facets = Vec::new();
    for seed in order {
        if taken[seed] {
            continue;
        }
        let (n, anchor) = (normal(seed).normalize_or_zero(), points[triangles[seed][0]]);
        let joins = |t: usize| triangles[t].iter().all(|&i| n.dot(points[i] - anchor).abs() <= flat);
        let mut own = vec![seed];
        taken[seed] = true;
        let mut at = 0;
        while at < own.len() && n != DVec3::ZERO {
            let [a, b, c] = triangles[own[at]];
            for edge in [(b, a), (c, b), (a, c)] {
                let other = sides.get(&edge).copied().filter(|&t| !taken[t] && joins(t));
                if let Some(t) = other {
                    taken[t] = true;
                    own.push(t);
                }
            }
            at += 1;
        }
        // One triangle always has a ring.
        let found = ring(triangles, &own);
        if found.is_none() {
            own.drain(1..).for_each(|t| taken[t] = false);
        }
        let ring = found.unwrap_or_else(|| triangles[seed].to_vec());
        facets.push(Facet { triangles: own, ring });
    }
    facets
}

/// The hull of points, without those no farther than `keep` from the hull of the others, with
/// triangles joined that lie in one plane to within `flat`; `None` if the points are flat.
pub(crate) fn closed(points: &[DVec3], keep: f64, flat: f64) -> Option<Closed> {
    let triangles = triangles(points, keep)?;
    let single = |t: usize| Facet { triangles: vec![t], ring: triangles[t].to_vec() };
    assembled(points, &triangles, &facets(points, &triangles, flat)).or_else(|| {
        let apart: Vec<Facet> = (0..triangles.len()).map(single).collect();
        assembled(points, &triangles, &apart)
    })
}

/// Numbers corners and edges, and lowers each face to the lowest corner of its triangles. A point
/// outside of the hull lies beyond one of its triangles, as seen from the middle, so it lies beyond
/// that triangle's face.
fn assembled(points: &[DVec3], triangles: &[[usize; 3]], facets: &[Facet]) -> Option<Closed> {
    let mut number = vec![u16::MAX; points.len()];
    let mut vertices: Vec<DVec3> = Vec::new();
    let mut sides: HashMap<(usize, usize), u16> = HashMap::new();
    for (f, facet) in facets.iter().enumerate() {
        for (i, &a) in facet.ring.iter().enumerate() {
            if number[a] == u16::MAX {
                number[a] = vertices.len() as u16;
                vertices.push(points[a]);
            }
            sides.insert((a, facet.ring[(i + 1) % facet.ring.len()]), f as u16);
        }
    }
    let mut edges = Vec::with_capacity(sides.len() / 2);
    for (f, facet) in facets.iter().enumerate() {
        for (i, &a) in facet.ring.iter().enumerate() {
            let b = facet.ring[(i + 1) % facet.ring.len()];
            let g = *sides.get(&(b, a))?;
            match usize::from(g).cmp(&f) {
                std::cmp::Ordering::Equal => return None,
                std::cmp::Ordering::Greater => edges.push([number[a], number[b], f as u16, g]),
                std::cmp::Ordering::Less => {}
            }
        }
    }
    let largest = vertices.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let middle = vertices.iter().sum::<DVec3>() / vertices.len().max(1) as f64;
    let mut faces = Vec::with_capacity(facets.len());
    for facet in facets {
        let own = || facet.triangles.iter().map(|&t| triangles[t].map(|i| points[i]));
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
