//! The plane through a point that most of its neighbours lie on.

use crate::numeric::{FLAT, THIN};
use glam::{Vec3A, Vec4};

/// A neighbour: its number, and its place relative to the point.
pub(super) type Near = (u32, Vec3A);

/// Positions within the cube from -1 to 1, one for each place, with their normals and neighbours.
pub(super) struct Input {
    pub places: Vec<Vec3A>,
    /// Those that are given; zero where none is.
    pub normals: Vec<Vec3A>,
    /// The nearest others first, and [`NOBODY`] behind them.
    pub nearest: Vec<[u32; NEIGHBOURS]>,
    pub spacing: Vec<f32>,
}

/// Neighbours of a point that are looked at: on a plate, half of them are on its other side.
pub(super) const NEIGHBOURS: usize = 28;

/// In the place of a neighbour that there is not.
pub(super) const NOBODY: u32 = u32::MAX;

impl Input {
    /// Whether the normal of a place is given, so that its sign tells front and back.
    pub(super) fn given(&self, i: usize) -> bool {
        self.normals[i] != Vec3A::ZERO
    }

    /// The neighbours of a place, nearest first.
    pub(super) fn near(&self, i: usize) -> Vec<Near> {
        let near = self.nearest[i].iter().take_while(|&&j| j != NOBODY);
        near.map(|&j| (j, self.places[j as usize] - self.places[i])).collect()
    }

    /// Their places alone.
    pub(super) fn around(&self, i: usize) -> Vec<Vec3A> {
        self.near(i).iter().map(|near| near.1).collect()
    }
}

/// Neighbours of which all pairs are tried.
const PAIRED: usize = 9;

/// How much a neighbour off the plane counts against it, if it is on the side that has fewer of these: a
/// plane that cuts through a bent surface has them on both of its sides, one that touches it on one.
const CUT: f32 = 0.3;

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

/// The normal of the plane through the origin within `inlier` of which most neighbours lie, and
/// that has few others on both of its sides; zero if they are on a line.
pub(super) fn normal(near: &[Vec3A], inlier: f32) -> Vec3A {
    // Four at once, in units of `inlier`; those that fill up the last four count 1 each.
    let four = |four: &[Vec3A], axis: usize| {
        Vec4::from_array(std::array::from_fn(|k| four.get(k).map_or(0.0, |v| v[axis] / inlier)))
    };
    let fours: Vec<[Vec4; 3]> = near.chunks(4).map(|all| [0, 1, 2].map(|axis| four(all, axis))).collect();
    let filled = (4 * fours.len() - near.len()) as f32;
    let mut best = (0.0, Vec3A::ZERO);
    for normal in planes(near) {
        let (mut weights, mut above, mut below) = (Vec4::ZERO, 0, 0);
        for [x, y, z] in &fours {
            let height = *x * normal.x + *y * normal.y + *z * normal.z;
            weights += (Vec4::ONE - height * height).max(Vec4::ZERO);
            above += height.cmpgt(Vec4::ONE).bitmask().count_ones();
            below += height.cmplt(Vec4::NEG_ONE).bitmask().count_ones();
        }
        let score = weights.element_sum() - filled - CUT * above.min(below) as f32;
        if score > best.0 {
            best = (score, normal);
        }
    }
    (0..ROUNDS)
        .fold(best.1, |normal, _| if normal == Vec3A::ZERO { normal } else { refined(normal, near, inlier) })
}

/// The plane of least squares of the neighbours near to a plane.
fn refined(normal: Vec3A, near: &[Vec3A], inlier: f32) -> Vec3A {
    let (u, v) = normal.any_orthonormal_pair();
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

/// The root of the mean square of the heights of those neighbours that are within `most` of a plane.
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::TAU;

    fn best(mut near: Vec<Vec3A>) -> Vec3A {
        near.sort_by(|a, b| a.length().total_cmp(&b.length()));
        normal(&near, 0.1).abs()
    }

    #[test]
    fn a_plane_that_touches_is_better_than_one_that_cuts() {
        let ring = (0..10).map(|k| {
            let (y, x) = (k as f32 * TAU / 10.0).sin_cos();
            Vec3A::new(x, y, 0.0)
        });
        let below =
            (0..11).map(|k| Vec3A::new(0.0, (k % 4) as f32 * 0.5 - 0.75, -0.5 - 0.4 * (k / 4) as f32));
        let found = best(ring.chain(below).collect());
        assert!(found.z > 0.9, "{found}");
    }

    #[test]
    fn a_plane_of_more_neighbours_may_cut() {
        let half = (0..8).map(|k| Vec3A::new(0.8 + 0.5 * (k / 4) as f32, (k % 4) as f32 * 0.6 - 0.9, 0.0));
        let across = (0..7).map(|k| {
            let side = if k % 2 == 0 { -1.0 } else { 1.0 };
            Vec3A::new(0.0, (k / 2) as f32 * 0.6 - 0.9, 0.9 * side)
        });
        let found = best(half.chain(across).collect());
        assert!(found.z > 0.9, "{found}");
    }
}
