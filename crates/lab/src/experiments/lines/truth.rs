//! The occlusion of lines by rays, for comparison: lines as tubes with round ends in a bounding
//! volume hierarchy, and cosine-weighted rays of limited length. Shares no code with the
//! estimators.

use std::f64::consts::TAU;
use std::time::Duration;

use casca_lines::LineSet;
use casca_scenes::random::generator;
use glam::{DMat3, DVec3};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::Ray;
use rand::RngExt;

/// Boxes of the hierarchy are wider than the tubes by this share of the greatest coordinate, so
/// that rays in f32 lose no tube.
const WIDER: f64 = 4e-6;
/// Rays in the hierarchy are longer by this share: the ends of rays in f32 are off by a few units
/// of 6e-8.
const LONGER: f64 = 1e-5;

/// Rays start this many radii above the middle of the receiver's tube, so that rounding does not
/// put them into it.
const LIFT: f64 = 1.01;

/// Tubes around the segments of lines.
pub struct Tubes {
    ends: Vec<[DVec3; 2]>,
    radius: f64,
    bvh: Bvh2,
    scale: f64,
}

impl Tubes {
    /// Tubes of a radius.
    pub fn new(lines: &LineSet, radius: f64) -> Self {
        let ends: Vec<[DVec3; 2]> =
            lines.iter().flat_map(|l| l.windows(2)).map(|w| [w[0].as_dvec3(), w[1].as_dvec3()]).collect();
        let scale = ends.iter().flatten().fold(0.0, |s: f64, p| s.max(p.abs().max_element()));
        let margin = DVec3::splat(radius + WIDER * (scale + radius));
        let boxes: Vec<Aabb> = ends
            .iter()
            .map(|[a, b]| Aabb::new((a.min(*b) - margin).as_vec3a(), (a.max(*b) + margin).as_vec3a()))
            .collect();
        let bvh = match boxes.is_empty() {
            true => Bvh2::default(),
            false => build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Duration::default()),
        };
        let ends = bvh.primitive_indices.iter().map(|&i| ends[i as usize]).collect();
        Self { ends, radius, bvh, scale }
    }

    /// Whether a tube that does not hold the start lies on a ray of a length; `direction` is a unit
    /// vector.
    pub fn hit(&self, start: DVec3, direction: DVec3, length: f64) -> bool {
        if self.ends.is_empty() {
            return false;
        }
        let far = length * (1.0 + LONGER) + WIDER * self.scale;
        let ray = Ray::new(start.as_vec3a(), direction.as_vec3a(), 0.0, far as f32);
        let mut found = false;
        self.bvh.ray_traverse_miss(ray, |_, i| {
            found |= enters(self.ends[i], self.radius, start, direction).is_some_and(|t| t <= length);
            if found { f32::NEG_INFINITY } else { f32::INFINITY }
        });
        found
    }

    /// The share of cosine-weighted rays of a length, around `pole`, that tubes stop: `side * side`
    /// rays, one in each cell of the square that they come from.
    pub fn occlusion(&self, at: DVec3, pole: DVec3, length: f64, side: usize, seed: u64) -> f64 {
        let mut random = generator(seed, 0);
        let start = at + pole * self.radius * LIFT;
        let right = pole.any_orthonormal_vector();
        let turn = DMat3::from_cols(right, pole.cross(right), pole);
        let mut hits = 0;
        for i in 0..side * side {
            let u = ((i % side) as f64 + random.random::<f64>()) / side as f64;
            let v = ((i / side) as f64 + random.random::<f64>()) / side as f64;
            let (sine, cosine) = (v * TAU).sin_cos();
            let direction = turn * DVec3::new(u.sqrt() * cosine, u.sqrt() * sine, (1.0 - u).sqrt());
            hits += usize::from(self.hit(start, direction, length));
        }
        hits as f64 / (side * side) as f64
    }
}

/// The way along a ray to a tube with round ends; `None` if it misses, or starts inside.
fn enters([a, b]: [DVec3; 2], radius: f64, start: DVec3, direction: DVec3) -> Option<f64> {
    let (axis, from) = (b - a, start - a);
    let long = axis.length_squared();
    let along = |p: DVec3| if long > 0.0 { (p.dot(axis) / long).clamp(0.0, 1.0) } else { 0.0 };
    if from.distance_squared(axis * along(from)) <= radius * radius {
        return None;
    }
    let sphere = |centre: DVec3| {
        let to = start - centre;
        let half = to.dot(direction);
        let root = half * half - to.length_squared() + radius * radius;
        (root >= 0.0).then(|| -half - root.sqrt()).filter(|&t| t >= 0.0)
    };
    let side = || {
        // The ray and the axis without their parts along the axis.
        let flat = |v: DVec3| v - axis * (v.dot(axis) / long);
        let (d, f) = (flat(direction), flat(from));
        let (aa, half) = (d.length_squared(), d.dot(f));
        let root = half * half - aa * (f.length_squared() - radius * radius);
        let t = (-half - root.max(0.0).sqrt()) / aa;
        let place = (from + direction * t).dot(axis) / long;
        (root >= 0.0 && t >= 0.0 && (0.0..=1.0).contains(&place)).then_some(t)
    };
    [side(), sphere(a), sphere(b)].into_iter().flatten().min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// The way to a tube by small steps.
    fn marched([a, b]: [DVec3; 2], radius: f64, start: DVec3, direction: DVec3) -> Option<f64> {
        let distance = |p: DVec3| {
            let axis = b - a;
            let along = ((p - a).dot(axis) / axis.length_squared().max(1e-12)).clamp(0.0, 1.0);
            p.distance(a + axis * along) - radius
        };
        if distance(start) <= 0.0 {
            return None;
        }
        let mut t = 0.0;
        for _ in 0..2000 {
            let d = distance(start + direction * t);
            if d < 1e-7 {
                return Some(t);
            }
            t += d;
        }
        None
    }

    #[test]
    fn rays_enter_tubes_where_small_steps_do() {
        let mut random = generator(7, 0);
        let mut hits = 0;
        for _ in 0..2000 {
            let mut point = || DVec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0)));
            let (ends, start) = ([point(), point()], point() * 2.0);
            let direction = (point() - start).normalize();
            let (found, truth) = (enters(ends, 0.2, start, direction), marched(ends, 0.2, start, direction));
            match (found, truth) {
                (Some(a), Some(b)) => assert!((a - b).abs() < 1e-3, "{a} {b}"),
                (None, None) => {}
                // Steps creep along a tube that is only grazed.
                other => assert!(other.0.is_some() && truth.is_none(), "{other:?}"),
            }
            hits += usize::from(found.is_some());
        }
        assert!((150..1500).contains(&hits), "{hits}");
    }

    #[test]
    fn half_of_the_sky_behind_a_wall_of_tubes_is_hidden() {
        // A dense wall at x = 0.5 that is endless for rays of length 1: it takes the directions
        // with x > 0.5 of the way.
        let wall = (-400..400).map(|i| {
            let z = i as f32 * 0.005;
            [Vec3::new(0.51, -2.0, z), Vec3::new(0.51, 2.0, z)]
        });
        let tubes = Tubes::new(&LineSet::new(wall).unwrap(), 0.01);
        let hidden = tubes.occlusion(DVec3::ZERO, DVec3::X, 1.0, 64, 1);
        // Directions at angles below 60 degrees from the pole: sin(60)^2.
        assert!((hidden - 0.75).abs() < 0.02, "{hidden}");
        assert_eq!(tubes.occlusion(DVec3::ZERO, DVec3::NEG_X, 1.0, 8, 1), 0.0);
        assert_eq!(Tubes::new(&LineSet::default(), 0.1).occlusion(DVec3::ZERO, DVec3::X, 1.0, 4, 1), 0.0);
    }
}
