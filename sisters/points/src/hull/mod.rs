//! The extreme points of a convex hull: quickhull with exact predicates.
//!
//! Barber, Dobkin & Huhdanpaa 1996, "The Quickhull Algorithm for Convex Hulls". Their program
//! merges facets to live with rounding. Here every decision is exact, so that the hull stays
//! convex, and each step ends with one more point on it.

mod grow;

use std::cmp::Ordering;

use bitvec::vec::BitVec;
use glam::DVec3;

use crate::numeric::{above, morton, normalized, power_of_two_for, turn};

/// The largest number of points. Faces are counted with 32 bits, and a hull has up to two for each
/// point.
pub(crate) const MAX_POINTS: usize = 1 << 30;

/// A bit for each point: whether it is an extreme point of the convex hull of all.
///
/// A point is extreme if it is not within the hull of the points at other places. So a point in a
/// facet or on an edge of the hull is not extreme unless it is a corner. Points at the same place
/// have the same bit. Flat, collinear and equal points are no errors: they have the corners of
/// their polygon, the two ends, and all points.
///
/// The answer is exact for the given coordinates, except those below 2^-107 of the largest one:
/// these are rounded to multiples of 2^-160 of it. It takes `O(n log n)` on usual inputs, also on
/// those with facets, but quadratic time can be made up, such as by two circles; and about 125 bytes
/// for each point.
///
/// Coordinates must be finite, and points at most [`MAX_POINTS`].
pub(crate) fn extreme_points(points: &[DVec3]) -> BitVec {
    let largest = points.iter().fold(0.0, |most: f64, p| most.max(p.abs().max_element()));
    let scale = power_of_two_for(largest);
    let order = by_place(points, scale);
    let points: Vec<DVec3> = order.iter().map(|&i| normalized(points[i as usize], scale)).collect();
    let extreme = match find(&points) {
        Start::Empty => BitVec::new(),
        Start::Place => BitVec::repeat(true, points.len()),
        Start::Line => ends(&points),
        Start::Plane { axis } => corners(&points, axis),
        Start::Solid(simplex) => grow::extreme(&points, simplex),
    };
    let mut own = BitVec::repeat(false, extreme.len());
    extreme.iter_ones().for_each(|at| own.set(order[at] as usize, true));
    own
}

/// Cells along each axis: codes of three coordinates have 30 bits, which leave 32 for an index.
const CELLS: f64 = (1 << 10) as f64;

/// The indices of points along a curve through cells (Morton 1966), for points within ±2 when
/// multiplied by `scale`. Points of a cell keep their order.
///
/// The growing hull looks at the points above a face, which lie near each other. In the order of a
/// scan, or in none, each of them is a line of the cache of its own.
fn by_place(points: &[DVec3], scale: f64) -> Vec<u32> {
    let code = |p: DVec3| {
        let cell = (p * scale + 2.0) * (CELLS / 4.0);
        morton(cell.to_array().map(|x| x as u32))
    };
    let mut codes: Vec<u64> = points.iter().zip(0_u64..).map(|(&p, i)| code(p) << 32 | i).collect();
    codes.sort_unstable();
    codes.into_iter().map(|code| code as u32).collect()
}

/// The dimension of some points.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Start {
    /// There are no points.
    Empty,
    /// All points are at one place.
    Place,
    /// All points are on a line.
    Line,
    /// All points are in a plane, and not on a line when seen along the coordinate `axis`.
    Plane { axis: usize },
    /// Four points that are not in a plane; the fourth is below the first three.
    Solid([u32; 4]),
}

/// The dimension of points. Takes far points, as long as floating point finds them, otherwise any
/// that fit.
fn find(points: &[DVec3]) -> Start {
    let Some(&first) = points.first() else { return Start::Empty };
    let a = farthest(points, |p| p.distance_squared(first));
    let b = farthest(points, |p| p.distance_squared(points[a]));
    let other = |p: &DVec3| *p != points[a];
    let Some(b) = checked(points, b, other) else { return Start::Place };
    let (pa, pb) = (points[a], points[b]);
    let c = farthest(points, |p| (pb - pa).cross(p - pa).length_squared());
    let Some(c) = checked(points, c, |&p| axis_of(pa, pb, p).is_some()) else { return Start::Line };
    let pc = points[c];
    let normal = (pb - pa).cross(pc - pa);
    let d = farthest(points, |p| normal.dot(p - pa).abs());
    let Some(d) = checked(points, d, |&p| above(pa, pb, pc, p) != 0.0) else {
        return Start::Plane { axis: axis_of(pa, pb, pc).unwrap_or(0) };
    };
    let below = above(pa, pb, pc, points[d]) < 0.0;
    let [a, b, c, d] = [a, b, c, d].map(|i| i as u32);
    Start::Solid(if below { [a, b, c, d] } else { [a, c, b, d] })
}

/// The point for which a measure is largest.
fn farthest(points: &[DVec3], measure: impl Fn(DVec3) -> f64) -> usize {
    let mut best = (0, f64::NEG_INFINITY);
    for (i, &p) in points.iter().enumerate() {
        let value = measure(p);
        if value > best.1 {
            best = (i, value);
        }
    }
    best.0
}

/// A point's index if it fits, else the first index that does.
fn checked(points: &[DVec3], index: usize, fits: impl Fn(&DVec3) -> bool) -> Option<usize> {
    if fits(&points[index]) { Some(index) } else { points.iter().position(fits) }
}

/// A coordinate axis along which three points do not look as on a line.
fn axis_of(a: DVec3, b: DVec3, c: DVec3) -> Option<usize> {
    (0..3).find(|&axis| turn(axis, a, b, c) != 0.0)
}

/// The two ends of points on a line.
fn ends(points: &[DVec3]) -> BitVec {
    let low = points.iter().copied().min_by(|a, b| order(*a, *b));
    let high = points.iter().copied().max_by(|a, b| order(*a, *b));
    points.iter().map(|&p| Some(p) == low || Some(p) == high).collect()
}

/// The corners of points in a plane, which are not collinear when seen along `axis` (Andrew 1979,
/// the monotone chain).
fn corners(points: &[DVec3], axis: usize) -> BitVec {
    let key = |p: DVec3| DVec3::new(p[(axis + 1) % 3], p[(axis + 2) % 3], 0.0);
    let mut sorted: Vec<u32> = (0..points.len() as u32).collect();
    let at = |i: u32| points[i as usize];
    sorted.sort_unstable_by(|&a, &b| order(key(at(a)), key(at(b))).then(a.cmp(&b)));
    let mut groups = sorted.clone();
    groups.dedup_by_key(|i| at(*i));
    let mut extreme = BitVec::repeat(false, points.len());
    let mut mark = |chain: &[u32]| chain.iter().for_each(|&i| extreme.set(i as usize, true));
    mark(&chain(groups.iter().copied(), axis, points));
    mark(&chain(groups.iter().rev().copied(), axis, points));
    for pair in sorted.windows(2) {
        if at(pair[0]) == at(pair[1]) && extreme[pair[0] as usize] {
            extreme.set(pair[1] as usize, true);
        }
    }
    extreme
}

/// Half of the hull: the points in this order without those at which the way does not turn left.
fn chain(order: impl Iterator<Item = u32>, axis: usize, points: &[DVec3]) -> Vec<u32> {
    let mut chain: Vec<u32> = Vec::new();
    for i in order {
        while let [.., a, b] = chain[..] {
            if turn(axis, points[a as usize], points[b as usize], points[i as usize]) > 0.0 {
                break;
            }
            chain.pop();
        }
        chain.push(i);
    }
    chain
}

/// By x, then y, then z. Coordinates are finite; -0 equals 0.
fn order(a: DVec3, b: DVec3) -> Ordering {
    a.to_array().partial_cmp(&b.to_array()).unwrap_or(Ordering::Equal)
}

#[cfg(test)]
pub(crate) mod tests;
