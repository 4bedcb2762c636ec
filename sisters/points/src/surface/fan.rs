//! How far a disc reaches in each direction of its plane.

use crate::numeric::SAME_DIRECTION;
use glam::Vec2;
use std::f32::consts::{FRAC_1_SQRT_2, TAU};

/// Directions that have a reach each.
pub(super) const SECTORS: usize = 16;

/// More steps around a point than it has neighbours are not needed.
const STEPS: usize = 32;

/// The tangent of 22.5 degrees, half of the angle between axis and diagonal.
const HALF_OF_OCTANT: f32 = std::f32::consts::SQRT_2 - 1.0;

/// The sector of a direction: counterclockwise from the first axis.
#[inline]
pub(super) fn sector(mut v: Vec2) -> usize {
    let mut sector = 0;
    if v.y < 0.0 {
        (sector, v) = (8, -v);
    }
    if v.x < 0.0 {
        (sector, v) = (sector + 4, Vec2::new(v.y, -v.x));
    }
    if v.y > v.x {
        (sector, v) = (sector + 2, Vec2::new(v.x + v.y, v.y - v.x));
    }
    sector + usize::from(v.y > HALF_OF_OCTANT * v.x)
}

/// The sine and cosine of 22.5 degrees.
const SIN: f32 = 0.382_683_43;
const COS: f32 = 0.923_879_5;

/// The direction in which each sector begins.
pub(super) const DIRECTIONS: [Vec2; SECTORS] = {
    let quarter = [(1.0, 0.0), (COS, SIN), (FRAC_1_SQRT_2, FRAC_1_SQRT_2), (SIN, COS)];
    let mut all = [Vec2::ZERO; SECTORS];
    let mut k = 0;
    while k < SECTORS {
        let (x, y) = quarter[k % 4];
        all[k] = match k / 4 {
            0 => Vec2::new(x, y),
            1 => Vec2::new(-y, x),
            2 => Vec2::new(-x, -y),
            _ => Vec2::new(y, -x),
        };
        k += 1;
    }
    all
};

/// Whether the polygon that reaches so far in each of the [`DIRECTIONS`] covers a place.
#[inline]
pub(super) fn covers(reach: impl Fn(usize) -> f32, place: Vec2) -> bool {
    let k = sector(place);
    let next = (k + 1) % SECTORS;
    let (a, b) = (DIRECTIONS[k] * reach(k), DIRECTIONS[next] * reach(next));
    // A sector of no reach covers nothing.
    (b - a).perp_dot(place - a) > 0.0
}

/// How far the triangles around the origin reach, by sector; 0 where there is none.
///
/// They are those of the Delaunay triangulation of the origin and `others`, as far as they can be reached
/// from the nearest of these over triangles with circumcircles of at most the radius `most`.
pub(super) fn reach(others: &[Vec2], most: f32) -> [f32; SECTORS] {
    let mut reach = [0.0; SECTORS];
    let nearest = others.iter().min_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
    let Some(&nearest) = nearest else { return reach };
    // Both ways around, as a border may be on the way.
    for way in [1.0, -1.0] {
        let (mut at, mut angle) = (nearest, 0.0);
        for _ in 0..STEPS {
            let Some(next) = next(at, others, way, most) else { break };
            for (reach, d) in reach.iter_mut().zip(DIRECTIONS) {
                if way * at.perp_dot(d) >= 0.0 && way * d.perp_dot(next) >= 0.0 {
                    let edge = next - at;
                    let far = at.perp_dot(edge) / d.perp_dot(edge);
                    if far.is_finite() {
                        *reach = reach.max(far);
                    }
                }
            }
            angle += (way * at.perp_dot(next)).atan2(at.dot(next));
            if angle >= TAU - SAME_DIRECTION {
                return reach;
            }
            at = next;
        }
    }
    reach
}

/// The third corner of the Delaunay triangle of the origin and `at`, on one side: the one that sees
/// both at the widest angle.
fn next(at: Vec2, others: &[Vec2], way: f32, most: f32) -> Option<Vec2> {
    let mut best = (f32::INFINITY, None);
    for &other in others {
        let area = way * at.perp_dot(other);
        if area > SAME_DIRECTION * at.length() * other.length() {
            let cotangent = other.dot(other - at) / area;
            if cotangent < best.0 {
                best = (cotangent, Some(other));
            }
        }
    }
    // The chord is the diameter times the sine of the angle.
    let diameter2 = at.length_squared() * (1.0 + best.0 * best.0);
    best.1.filter(|_| diameter2 <= 4.0 * most * most)
}
