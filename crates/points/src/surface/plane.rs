//! The plane through a point that most of its neighbours lie on.

use super::fan::axes;
use crate::numeric::{FLAT, THIN};
use glam::Vec3A;

/// Neighbours of which all pairs are tried.
const PAIRED: usize = 9;

/// Rounds of least squares after that.
const ROUNDS: usize = 2;

/// How much farther than `inlier` neighbours count in these.
const WIDER: f32 = 1.5;

/// Neighbours that noise is measured by, and the rank of the one whose distance counts: two are on
/// the plane by its choice, and on a thin plate half of the others are on its other side.
pub(super) const MEASURED: usize = 16;
const RANK: usize = 6;

/// The planes through the origin and two of the nearest neighbours.
fn planes(near: &[Vec3A]) -> impl Iterator<Item = Vec3A> {
    let few = &near[..near.len().min(PAIRED)];
    let pairs = few.iter().enumerate().flat_map(move |(i, a)| few[..i].iter().map(move |b| (*a, *b)));
    pairs.filter_map(|(a, b)| {
        let across = a.cross(b);
        let wide = across.length_squared() > THIN * a.length_squared() * b.length_squared();
        wide.then(|| across.normalize())
    })
}

/// The normal of the plane through the origin within `inlier` of which most neighbours lie; zero
/// if they are on a line.
pub(super) fn normal(near: &[Vec3A], inlier: f32) -> Vec3A {
    let weight = |height: f32| (1.0 - (height / inlier).powi(2)).max(0.0);
    let mut best = (0.0, Vec3A::ZERO);
    for normal in planes(near) {
        let score: f32 = near.iter().map(|v| weight(v.dot(normal))).sum();
        if score > best.0 {
            best = (score, normal);
        }
    }
    (0..ROUNDS)
        .fold(best.1, |normal, _| if normal == Vec3A::ZERO { normal } else { refined(normal, near, inlier) })
}

/// The plane of least squares of the neighbours near to a plane.
fn refined(normal: Vec3A, near: &[Vec3A], inlier: f32) -> Vec3A {
    let (u, v) = axes(normal);
    let [mut xx, mut xy, mut yy, mut xh, mut yh] = [0.0_f32; 5];
    for p in near {
        let height = p.dot(normal);
        let weight = (1.0 - (height / (WIDER * inlier)).powi(2)).max(0.0);
        let (x, y) = (p.dot(u), p.dot(v));
        xx += weight * x * x;
        xy += weight * x * y;
        yy += weight * y * y;
        xh += weight * x * height;
        yh += weight * y * height;
    }
    let det = xx * yy - xy * xy;
    if det > FLAT * xx * yy {
        let (a, b) = ((xh * yy - yh * xy) / det, (yh * xx - xh * xy) / det);
        (normal - u * a - v * b).normalize_or(normal)
    } else {
        normal
    }
}

/// The root of the mean square of the heights of those neighbours that are within `most` of a
/// plane.
pub(super) fn rough(near: &[Vec3A], normal: Vec3A, most: f32) -> f32 {
    let heights = near.iter().map(|p| p.dot(normal)).filter(|h| h.abs() < most);
    let (sum, count) = heights.fold((0.0, 0.0_f32), |(sum, count), h| (sum + h * h, count + 1.0));
    (sum / count.max(1.0)).sqrt()
}

/// How far a third of the neighbours are from the plane that is best in this, at most; about half
/// of the standard deviation of noise.
pub(super) fn noise(near: &[Vec3A]) -> f32 {
    let near = &near[..near.len().min(MEASURED)];
    let of_plane = |normal: Vec3A| {
        let mut heights: Vec<f32> = near.iter().map(|v| v.dot(normal).abs()).collect();
        let rank = RANK.min(heights.len() - 1);
        *heights.select_nth_unstable_by(rank, f32::total_cmp).1
    };
    planes(near).map(of_plane).fold(f32::INFINITY, f32::min)
}
