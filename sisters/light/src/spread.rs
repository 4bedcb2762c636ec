//! Directions and numbers that are spread evenly, the same in every run.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::ops::Range;

use glam::DVec3;

use crate::numeric::{BAND, GOLDEN};

/// Mixes a number so that near ones become far from each other (the finaliser of SplitMix64, Steele
/// et al. 2014).
pub(crate) fn mix(number: u64) -> u64 {
    let mut z = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A number from 0 to below 1 for a key and a dimension.
pub(crate) fn unit(key: u64, dimension: u64) -> f64 {
    (mix(key ^ mix(dimension)) >> 11) as f64 / (1u64 << 53) as f64
}

/// The directions above a surface as dense as the cosine (Malley's method on Vogel's spiral),
/// turned by a key: the `i`th of `count`.
pub(crate) struct Hemisphere {
    normal: DVec3,
    right: DVec3,
    up: DVec3,
    turn: f64,
    shift: f64,
    count: f64,
}

impl Hemisphere {
    pub(crate) fn new(normal: DVec3, count: u32, key: u64) -> Self {
        let (right, up) = normal.any_orthonormal_pair();
        Self { normal, right, up, turn: unit(key, 0), shift: unit(key, 1), count: f64::from(count) }
    }

    pub(crate) fn direction(&self, i: u32) -> DVec3 {
        let square = (f64::from(i) + self.shift) / self.count;
        let (sine, cosine) = (square.sqrt(), (1.0 - square).max(0.0).sqrt());
        let (s, c) = (TAU * (f64::from(i) * GOLDEN + self.turn).fract()).sin_cos();
        (self.right * (c * sine) + self.up * (s * sine) + self.normal * cosine).normalize()
    }

    /// The directions that may meet a ball, of a middle as seen from the start: all others pass it.
    /// Directions turn away from the normal one after the other.
    pub(crate) fn towards(&self, middle: DVec3, radius: f64) -> Range<u32> {
        let distance = middle.length();
        if distance <= radius {
            return 0..self.count as u32;
        }
        let wide = (radius / distance).asin() + BAND;
        let away = (middle.dot(self.normal) / distance).clamp(-1.0, 1.0).acos();
        if away - wide > FRAC_PI_2 {
            return 0..0;
        }
        let number = |angle: f64| angle.sin().powi(2) * self.count - self.shift;
        let (low, high) = (number((away - wide).max(0.0)), number((away + wide).min(FRAC_PI_2)));
        (low.floor().max(0.0) as u32)..((high + 2.0).clamp(0.0, self.count) as u32)
    }
}

/// A point of a disc of radius 1 around the origin, the `i`th of `count`.
pub(crate) fn on_disc(i: u32, count: u32, key: u64) -> (f64, f64) {
    let radius = ((f64::from(i) + unit(key, 2)) / f64::from(count)).sqrt();
    let (s, c) = (TAU * (f64::from(i) * GOLDEN + unit(key, 3)).fract()).sin_cos();
    (radius * c, radius * s)
}

/// The directions that a rough surface mirrors towards a view, as dense as its visible normals
/// (Heitz 2018), turned by a key.
pub(crate) struct Lobe {
    normal: DVec3,
    right: DVec3,
    up: DVec3,
    /// The view along `right`, `up` and `normal`.
    view: DVec3,
    rough: f64,
    turn: f64,
    count: f64,
}

impl Lobe {
    /// `view` is above the surface.
    pub(crate) fn new(normal: DVec3, view: DVec3, rough: f64, count: u32, key: u64) -> Self {
        let (right, up) = normal.any_orthonormal_pair();
        let view = DVec3::new(view.dot(right), view.dot(up), view.dot(normal));
        Self { normal, right, up, view, rough, turn: unit(key, 0), count: f64::from(count) }
    }

    /// A direction above the surface and its weight: how much of what comes from it leaves towards
    /// the view, by the density of directions.
    pub(crate) fn direction(&self, i: u32) -> Option<(DVec3, f64)> {
        let stretched = |v: DVec3| DVec3::new(self.rough * v.x, self.rough * v.y, v.z);
        let view = stretched(self.view).normalize();
        let (right, up) = view.any_orthonormal_pair();
        let radius = ((f64::from(i) + 0.5) / self.count).sqrt();
        let (s, c) = (TAU * (f64::from(i) * GOLDEN + self.turn).fract()).sin_cos();
        // A disc across the view, whose far half the horizon cuts: the half along the horizon and
        // the normal is squeezed.
        let across = DVec3::Z.cross(view).try_normalize().unwrap_or(right);
        let along = if across == right { up } else { view.cross(across) };
        let (x, y) = (radius * c, radius * s);
        let share = 0.5 * (1.0 + view.z);
        let y = (1.0 - share) * (1.0 - x * x).max(0.0).sqrt() + share * y;
        let height = (1.0 - x * x - y * y).max(0.0).sqrt();
        let half = stretched(across * x + along * y + view * height).normalize();
        let light = half * (2.0 * self.view.dot(half)) - self.view;
        if light.z <= 0.0 {
            return None;
        }
        // The shadowing of both ways over that of the view alone (Smith, correlated by height).
        let shadow = |v: DVec3| {
            let square = self.rough * self.rough * (1.0 - v.z * v.z) / (v.z * v.z);
            0.5 * ((1.0 + square).sqrt() - 1.0)
        };
        let (of_view, of_light) = (shadow(self.view), shadow(light));
        let weight = (1.0 + of_view) / (1.0 + of_view + of_light);
        let direction = self.right * light.x + self.up * light.y + self.normal * light.z;
        Some((direction.normalize(), weight))
    }
}

/// Barycentric coordinates that fill a triangle evenly, from two numbers of 0 to 1.
pub(crate) fn in_triangle(a: f64, b: f64) -> [f64; 3] {
    let root = a.sqrt();
    [1.0 - root, root * (1.0 - b), root * b]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_direction_that_meets_a_ball_is_left_out() {
        let (mut met, mut asked) = (0, 0);
        for k in 0..2000 {
            let random = |d: u64| unit(k, d) - 0.5;
            let normal = DVec3::new(random(0), random(1), random(2)).normalize().as_vec3().as_dvec3();
            let ways = Hemisphere::new(normal, 64, k);
            let middle = 10.0 * DVec3::new(random(3), random(4), random(5));
            let radius = [0.1, 1.0, 4.0][k as usize % 3] * unit(k, 6);
            let range = ways.towards(middle, radius);
            for i in 0..64 {
                let along = middle.dot(ways.direction(i)).max(0.0);
                let meets = (ways.direction(i) * along).distance(middle) <= radius;
                assert!(!meets || range.contains(&i), "{k} {i} {range:?}");
                met += usize::from(meets);
            }
            asked += range.len();
        }
        assert!(met > 1000 && asked < 2000 * 64 / 2, "{met} {asked}");
    }
}
