//! The directions that rectangles on a plane lie along.

use glam::{DVec2, DVec3};

/// Directions that are tried in a quarter turn, beside those of the coordinate axes.
const DIRECTIONS: u32 = 18;
/// How much smaller the rectangle around a patch must be in another direction than along the axes
/// of the coordinates, along which most buildings lie.
const SMALLER: f64 = 0.97;

/// A right-handed frame: two directions on the plane, along which the least rectangle around the
/// points lies, and the normal.
pub(super) fn axes(normal: DVec3, points: &[DVec3]) -> [DVec3; 3] {
    let (u, v) = normal.any_orthonormal_pair();
    let flat = |p: &DVec3| DVec2::new(p.dot(u), p.dot(v));
    let middle = points.first().copied().unwrap_or_default();
    let points: Vec<DVec2> = points.iter().map(|p| flat(&(p - middle))).collect();
    let area = |angle: f64| {
        let turn = DVec2::from_angle(-angle);
        let turned = points.iter().map(|&p| turn.rotate(p));
        let (low, high) =
            turned.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        (high - low).element_product()
    };
    // The axes of the coordinates, seen along the normal.
    let along = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| flat(&axis)).into_iter();
    let along = along.filter(|a| a.length_squared() > 1e-6).map(DVec2::to_angle);
    let quarter = std::f64::consts::FRAC_PI_2;
    let others = (0..DIRECTIONS).map(|i| quarter * f64::from(i) / f64::from(DIRECTIONS));
    let tried = along.map(|angle| (SMALLER, angle)).chain(others.map(|angle| (1.0, angle)));
    let least = tried.map(|(factor, angle)| (factor * area(angle), angle)).min_by(|a, b| a.0.total_cmp(&b.0));
    let (sine, cosine) = least.map_or(0.0, |(_, angle)| angle).sin_cos();
    let first = u * cosine + v * sine;
    [first, normal.cross(first), normal]
}
