//! Hulls of points. Which corners share a face is decided exactly.
//!
//! Points join one after another, farthest first. Exact predicates (Shewchuk 1997) decide which
//! triangles a point sees, so the surface always closes. Points next to the hull are left out: that
//! makes it smaller only.

use glam::DVec3;
use robust::{Coord3D, orient3d};
use smallvec::SmallVec;

use crate::numeric::shape::{DISTANCE, ORIENTATION, ORIENTATION_LEAST};

/// The offset of a face whose lowest corner is at `least`, so low that no rounding lifts it above
/// that corner.
pub(crate) fn lowered(least: f64, largest: f64) -> f64 {
    least - DISTANCE * largest
}

/// No number of a triangle.
pub(super) const NONE: u32 = u32::MAX;

/// A number for each directed edge between a few points.
pub(super) struct EdgeNumbers {
    points: usize,
    numbers: Vec<u32>,
}

impl EdgeNumbers {
    pub(super) fn new(points: usize) -> Self {
        Self { points, numbers: vec![NONE; points * points] }
    }

    /// The number of the edge from one point to another, or [`NONE`].
    pub(super) fn get(&self, a: usize, b: usize) -> u32 {
        self.numbers[a * self.points + b]
    }

    pub(super) fn set(&mut self, a: usize, b: usize, number: u32) {
        self.numbers[a * self.points + b] = number;
    }
}

/// The edges of a triangle in its direction.
pub(super) fn edges([a, b, c]: [usize; 3]) -> [(usize, usize); 3] {
    [(a, b), (b, c), (c, a)]
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

/// A triangle of a hull, seen counterclockwise from outside.
struct Triangle {
    corners: [usize; 3],
    first: DVec3,
    /// The cross product of two sides, and the sums of the magnitudes that it is made of.
    normal: DVec3,
    magnitudes: DVec3,
    /// Whether no later point saw it.
    stays: bool,
}

impl Triangle {
    fn new(points: &[DVec3], corners: [usize; 3]) -> Self {
        let [first, b, c] = corners.map(|i| points[i]);
        let (u, v) = (b - first, c - first);
        let (x, y) = (u.abs(), v.abs());
        let magnitudes = DVec3::new(x.y * y.z + x.z * y.y, x.z * y.x + x.x * y.z, x.x * y.y + x.y * y.x);
        Self { corners, first, normal: u.cross(v), magnitudes, stays: true }
    }

    /// As [`sees`]. Most points are clear of the plane, so that rounding cannot matter.
    fn is_seen(&self, points: &[DVec3], p: DVec3) -> bool {
        let d = p - self.first;
        let above = self.normal.dot(d);
        let error = ORIENTATION * self.magnitudes.dot(d.abs()) + ORIENTATION_LEAST;
        if above.abs() > error { above > 0.0 } else { sees(points, self.corners, p) }
    }
}

/// What a point is known to see of a growing hull.
#[derive(Default)]
struct HullSight {
    /// It was compared with all triangles of lesser numbers.
    compared: usize,
    /// The triangles of those that it sees, with their distances.
    seen: SmallVec<[(u32, f64); 4]>,
}

/// A hull as it grows. A triangle keeps its number.
struct Growing<'a> {
    points: &'a [DVec3],
    triangles: Vec<Triangle>,
    /// The triangles that stay, in order.
    hull: Vec<u32>,
    /// The last triangle at each edge.
    sides: EdgeNumbers,
    sights: Vec<HullSight>,
}

impl<'a> Growing<'a> {
    fn new(points: &'a [DVec3], first: [[usize; 3]; 4]) -> Self {
        let sights = std::iter::repeat_with(HullSight::default).take(points.len()).collect();
        let (triangles, hull) = (Vec::new(), Vec::new());
        let mut all = Self { points, triangles, hull, sides: EdgeNumbers::new(points.len()), sights };
        first.into_iter().for_each(|corners| all.push(corners));
        all
    }

    fn push(&mut self, corners: [usize; 3]) {
        let number = self.triangles.len() as u32;
        edges(corners).into_iter().for_each(|(a, b)| self.sides.set(a, b, number));
        self.triangles.push(Triangle::new(self.points, corners));
        self.hull.push(number);
    }

    /// Finds the triangles that a point sees. Returns its distance from them, or 0 if there are
    /// none.
    fn look(&mut self, point: usize) -> f64 {
        let (p, HullSight { compared, seen }) = (self.points[point], &mut self.sights[point]);
        seen.retain(|s| self.triangles[s.0 as usize].stays);
        let new = self.hull.partition_point(|&t| (t as usize) < *compared);
        for &t in &self.hull[new..] {
            let triangle = &self.triangles[t as usize];
            if triangle.is_seen(self.points, p) {
                seen.push((t, distance(p, triangle.corners.map(|i| self.points[i]))));
            }
        }
        *compared = self.triangles.len();
        if seen.is_empty() { 0.0 } else { seen.iter().map(|s| s.1).fold(f64::INFINITY, f64::min) }
    }

    /// Joins a point that has looked: triangles from it to the edges around those that it sees take
    /// their place.
    fn join(&mut self, point: usize) {
        let seen = std::mem::take(&mut self.sights[point].seen);
        seen.iter().for_each(|s| self.triangles[s.0 as usize].stays = false);
        self.hull.retain(|&t| self.triangles[t as usize].stays);
        // Of the edges around them, the triangles beyond stay; those made now stay, too.
        let around = seen.iter().flat_map(|s| edges(self.triangles[s.0 as usize].corners));
        let stays = |&(a, b): &_| self.triangles[self.sides.get(b, a) as usize].stays;
        let around: SmallVec<[(usize, usize); 16]> = around.filter(stays).collect();
        around.into_iter().for_each(|(a, b)| self.push([a, b, point]));
    }
}

/// The triangles of the hull, seen counterclockwise from outside. Points no farther than `keep`
/// from the hull of the others are left out; `None` if all lie that close to one plane.
pub(crate) fn triangles(points: &[DVec3], keep: f64) -> Option<Vec<[usize; 3]>> {
    let first = first(points, keep)?;
    // How far points lie outside; upper bounds, since the hull grows.
    let mut beyond: Vec<f64> = vec![f64::INFINITY; points.len()];
    first.iter().flatten().for_each(|&i| beyond[i] = 0.0);
    let mut growing = Growing::new(points, first);
    loop {
        // The last of the farthest, and how far the next is.
        let (mut farthest, mut most, mut next) = (0, 0.0, 0.0);
        for (i, &own) in beyond.iter().enumerate() {
            if own >= most {
                (farthest, most, next) = (i, own, most);
            } else if own > next {
                next = own;
            }
        }
        if most <= keep {
            let corners = growing.hull.iter().map(|&t| growing.triangles[t as usize].corners);
            return Some(corners.collect());
        }
        let nearest = growing.look(farthest);
        if nearest <= keep || nearest < next {
            // Now known for this hull: after one round the farthest is found.
            beyond[farthest] = if nearest <= keep { 0.0 } else { nearest };
            continue;
        }
        growing.join(farthest);
        beyond[farthest] = 0.0;
    }
}

/// A tetrahedron of points far apart.
fn first(points: &[DVec3], keep: f64) -> Option<[[usize; 3]; 4]> {
    let farthest = |from: &dyn Fn(DVec3) -> f64| {
        let far = points.iter().map(|&p| from(p)).enumerate();
        far.max_by(|a, b| a.1.total_cmp(&b.1)).map(|most| most.0)
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
    solid.then_some([[a, b, c], [a, d, b], [b, d, c], [c, d, a]])
}
