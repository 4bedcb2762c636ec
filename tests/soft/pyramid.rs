//! The opacity pyramid against its formula, computed from single cells in double precision.

use casca::Aabb;
use casca::soft::{Layer, Pyramid, SoftGrid};
use glam::{IVec3, UVec3, Vec3};

use crate::{Dice, soft};

/// An opacity of level `l` is rounded `l` times, by 2^-16 each. The next level adds at most twice
/// that of its children for a pair.
const ROUNDING: f64 = 1.0 / (1 << 13) as f64;

fn cells(dims: IVec3) -> impl Iterator<Item = IVec3> + Clone {
    (0..dims.x * dims.y * dims.z)
        .map(move |i| IVec3::new(i % dims.x, i / dims.x % dims.y, i / (dims.x * dims.y)))
}

/// Fails where two pyramids differ.
pub fn assert_same(a: &SoftGrid, b: &SoftGrid) {
    let (a, b) = (a.pyramid(), b.pyramid());
    assert_eq!(a.top(), b.top());
    for level in 0..=a.top() {
        assert_eq!(a.dims(level), b.dims(level));
        for c in cells(a.dims(level)) {
            assert_eq!((a.any(level, c), a.all(level, c)), (b.any(level, c), b.all(level, c)), "{level} {c}");
            for (axis, up) in faces() {
                assert_eq!(a.opacity(level, c, axis, up), b.opacity(level, c, axis, up), "{level} {c}");
            }
        }
    }
}

fn faces() -> impl Iterator<Item = (usize, bool)> {
    (0..3).flat_map(|axis| [(axis, true), (axis, false)])
}

/// The opacity of a cell by the formula; `None` beyond the grid.
fn formula(p: &Pyramid, level: usize, cell: IVec3, axis: usize, up: bool) -> Option<f64> {
    if cell.cmpge(p.dims(level)).any() {
        return None;
    }
    if level == 0 {
        return Some(if p.any(0, cell) { 1.0 } else { 0.0 });
    }
    let mut columns = Vec::new();
    for (u, v) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let child = |depth: i32| {
            let mut at = cell * 2;
            at[axis] += depth;
            at[(axis + 1) % 3] += u;
            at[(axis + 2) % 3] += v;
            formula(p, level - 1, at, axis, up)
        };
        if let Some(low) = child(0) {
            let high = child(1).unwrap_or(0.0);
            let (front, back) = if up { (low, high) } else { (high, low) };
            columns.push(front + back * (1.0 - front));
        }
    }
    Some(columns.iter().sum::<f64>() / columns.len() as f64)
}

#[test]
fn channels_follow_the_formula_and_bounds_are_exact() {
    let mut dice = Dice(5);
    for (dims, density) in
        [(UVec3::new(32, 32, 32), 0.02), (UVec3::new(21, 9, 37), 0.3), (UVec3::new(40, 3, 1), 0.6)]
    {
        let mut grid = soft(dims);
        for c in cells(dims.as_ivec3()) {
            if dice.next() < density || c.x < 17 && c.y > 8 {
                grid.insert(Aabb::new(c.as_vec3() + 0.25, c.as_vec3() + 0.75), Layer::Fixed).unwrap();
            }
        }
        grid.rebuild();
        let p = grid.pyramid();
        assert_eq!(p.dims(p.top()), IVec3::ONE);
        for level in 0..=p.top() {
            for c in cells(p.dims(level)) {
                let mut below = cells(IVec3::splat(1 << level)).map(|o| (c << level as i32) + o);
                let inside = |b: &IVec3| b.cmplt(p.dims(0)).all();
                assert_eq!(p.any(level, c), below.clone().any(|b| p.any(0, b)));
                assert_eq!(p.all(level, c), below.all(|b| !inside(&b) || p.any(0, b)), "{level} {c}");
                for (axis, up) in faces() {
                    let (found, expected) =
                        (p.opacity(level, c, axis, up), formula(p, level, c, axis, up).unwrap());
                    assert!(
                        (f64::from(found) - expected).abs() < ROUNDING,
                        "{dims} {level} {c}: {found} {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn walls_stay_opaque_across_and_thin_out_along() {
    for axis in 0..3 {
        let mut grid = soft(UVec3::splat(64));
        let (mut min, mut max) = (Vec3::ZERO, Vec3::splat(64.0));
        (min[axis], max[axis]) = (21.25, 21.75);
        grid.insert(Aabb::new(min, max), Layer::Fixed).unwrap();
        grid.rebuild();
        let p = grid.pyramid();
        for level in 0..=6 {
            for c in cells(p.dims(level)).filter(|c| p.any(level, *c)) {
                for (other, up) in faces() {
                    // Along it, one half of the columns of each level has a pair of cells of the
                    // level below.
                    let along = (0..level).fold(1.0, |a: f32, _| (1.0 - (1.0 - a) * (1.0 - a)) / 2.0);
                    let (found, expected) =
                        (p.opacity(level, c, other, up), if other == axis { 1.0 } else { along });
                    let same = if other == axis { found == 1.0 } else { (found - along).abs() < 1e-4 };
                    assert!(same, "{level} {c}: {found} {expected}");
                }
            }
        }
    }
}

#[test]
fn memory_follows_surfaces() {
    let mut grid = soft(UVec3::splat(256));
    let ball = casca::Sphere::new(Vec3::splat(128.0), 60.0);
    grid.insert(ball, Layer::Fixed).unwrap();
    grid.rebuild();
    // The dense volumes of Villegas 2016 take 20.43 bytes a cell.
    let dense = (20.43 * 256f64.powi(3)) as usize;
    let held = grid.memory_bytes();
    assert!(held * 20 < dense, "{held} of {dense}");
    assert!(
        grid.pyramid().all(3, IVec3::splat(16))
            && grid.pyramid().opacity(3, IVec3::splat(16), 1, true) == 1.0
    );
}
