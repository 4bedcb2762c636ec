//! The extreme points of a convex hull: quickhull with exact predicates.
//!
//! Barber, Dobkin & Huhdanpaa 1996, "The Quickhull Algorithm for Convex Hulls". Their program
//! merges facets to live with rounding. Here every decision is exact, so that the hull stays
//! convex, and each step ends with one more point on it.

mod grow;

use crate::numeric::{above, morton, normalized, power_of_two_for, turn};
use bitvec::vec::BitVec;
use glam::DVec3;

/// The largest number of points. Faces are counted with 32 bits, and a hull has up to two for each point.
pub(crate) const MAX_POINTS: usize = 1 << 30;

/// A bit for each point: whether it is an extreme point of the convex hull of all.
///
/// A point is extreme if it is not within the hull of the points at other places. So a point in a
/// facet or on an edge of the hull is not extreme unless it is a corner. Points at the same place
/// have the same bit. Flat, collinear and equal points are no errors: they have the corners of
/// their polygon, the two ends, and all points.
///
/// The answer is exact for the given coordinates, except those below 2^-107 of the largest one: these are
/// rounded to multiples of 2^-160 of it. It takes `O(n log n)` on usual inputs, also on those with facets,
/// but quadratic time can be made up, such as by two circles; and about 125 bytes for each point.
///
/// Coordinates must be finite, and points at most [`MAX_POINTS`].
pub(crate) fn extreme_points(points: &[DVec3]) -> BitVec {
    let largest = points.iter().fold(0.0, |most: f64, p| most.max(p.abs().max_element()));
    let scale = power_of_two_for(largest);
    let order = by_place(points, scale);
    let mut points: Vec<DVec3> = order.iter().map(|&i| normalized(points[i as usize], scale)).collect();
    let Some(simplex) = simplex(&mut points) else { return BitVec::repeat(true, order.len()) };
    let extreme = grow::extreme(&points, simplex);
    let mut own = BitVec::repeat(false, order.len());
    extreme.iter_ones().filter_map(|at| order.get(at)).for_each(|&i| own.set(i as usize, true));
    own
}

/// The indices of points along a curve through cells (Morton 1966), for points within ±2 when
/// multiplied by `scale`. Points of a cell keep their order.
///
/// The growing hull looks at the points above a face, which lie near each other. In the order of a
/// scan, or in none, each of them is a line of the cache of its own.
fn by_place(points: &[DVec3], scale: f64) -> Vec<u32> {
    // 2^10 cells along each axis: codes have 30 bits, which leave 32 for an index.
    let code = |p: DVec3| morton(((p * scale + 2.0) * 256.0).to_array().map(|x| x as u32));
    let mut codes: Vec<u64> = points.iter().zip(0_u64..).map(|(&p, i)| code(p) << 32 | i).collect();
    codes.sort_unstable();
    codes.into_iter().map(|code| code as u32).collect()
}

/// Four points that are not in a plane; the fourth is below the first three. Takes far points, as
/// long as floating point finds them, otherwise any that fit; none if all points are at one place.
///
/// To points on a line or in a plane, points outside are added at the end: the extreme points of a
/// pyramid are its tip and the extreme points of its base.
fn simplex(points: &mut Vec<DVec3>) -> Option<[u32; 4]> {
    let first = *points.first()?;
    let a = farthest(points, |p| p.distance_squared(first));
    let pa = points[a];
    let b = checked(points, farthest(points, |p| p.distance_squared(pa)), |p| *p != pa)?;
    let pb = points[b];
    // Beside the first point along an axis, towards zero, so that coordinates stay within ±2. It
    // differs from it in this coordinate only, and so is outside for sure along some axis.
    let tips = DVec3::AXES.map(|axis| pa - axis * pa.signum());
    let checked_or_tip = |points: &mut Vec<DVec3>, index: usize, fits: &dyn Fn(&DVec3) -> bool| {
        checked(points, index, fits).unwrap_or_else(|| {
            points.extend(tips.into_iter().find(|tip| fits(tip)));
            points.len() - 1
        })
    };
    let c = farthest(points, |p| (pb - pa).cross(p - pa).length_squared());
    let c = checked_or_tip(points, c, &|&p| (0..3).any(|axis| turn(axis, pa, pb, p) != 0.0));
    let pc = points[c];
    let normal = (pb - pa).cross(pc - pa);
    let d = farthest(points, |p| normal.dot(p - pa).abs());
    let d = checked_or_tip(points, d, &|&p| above(pa, pb, pc, p) != 0.0);
    let below = above(pa, pb, pc, points[d]) < 0.0;
    let [a, b, c, d] = [a, b, c, d].map(|i| i as u32);
    Some(if below { [a, b, c, d] } else { [a, c, b, d] })
}

/// The point for which a measure is largest.
fn farthest(points: &[DVec3], measure: impl Fn(DVec3) -> f64) -> usize {
    let measured = points.iter().map(|&p| measure(p)).enumerate();
    measured.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(index, _)| index)
}

/// A point's index if it fits, else the first index that does.
fn checked(points: &[DVec3], index: usize, fits: impl Fn(&DVec3) -> bool) -> Option<usize> {
    if fits(&points[index]) { Some(index) } else { points.iter().position(fits) }
}

#[cfg(test)]
mod tests;
