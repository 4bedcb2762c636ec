//! The first tetrahedron of a hull, or the lower dimension that all points share.

use crate::numeric::{above, turn};
use glam::DVec3;

/// The dimension of some points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Start {
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
pub(super) fn find(points: &[DVec3]) -> Start {
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
