//! How much of the sun passes through fur.

use glam::Vec3;

use super::Fur;
use crate::numeric::{LEAST_DIVISOR, LEAST_RISE, LIGHT_STEPS};

impl Fur {
    /// The mean share of sunlight that reaches a height in a coat of a length on flat skin with a
    /// unit normal: 1 above the coat. Both are shares of the greatest height, 0 to 1; `to_sun` is a
    /// unit vector.
    ///
    /// Beer's law: strands stand at random, and a ray that passes a layer meets as many as stand in
    /// the area that their diameters sweep. A ray rises by one while it goes sideways by the slope
    /// of the light less that of the strands. Costs 32 sums. Shaders compute the same.
    pub fn sun_through(&self, normal: Vec3, height: f32, length: f32, to_sun: Vec3) -> f32 {
        let rise = normal.dot(to_sun).max(LEAST_RISE);
        let slope = (to_sun - normal * normal.dot(to_sun)) / rise;
        let side = self.bend - normal * self.bend.dot(normal);
        let (height, length) = (height.clamp(0.0, 1.0), length.clamp(0.0, 1.0));
        let step = (length - height).max(0.0) / LIGHT_STEPS as f32;
        let length = length.max(LEAST_DIVISOR);
        let mut met = 0.0;
        for i in 0..LIGHT_STEPS {
            let there = height + (i as f32 + 0.5) * step;
            // Strands of four lengths stand for all.
            let wide: f32 = (0..4)
                .map(|k| there / (length * (1.0 - self.variation * (k as f32 + 0.5) / 4.0)))
                .map(|along| if along <= 1.0 { 2.0 * self.radius_along(along) } else { 0.0 })
                .sum();
            met += 0.25 * wide * (slope - side * (2.0 * there)).length() * step * self.height;
        }
        (-met * self.strands_per_area() as f32).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_fades_with_depth_density_and_slope() {
        let fur = |density| Fur { bend: Vec3::ZERO, ..Fur::for_radius(1.0, 0.1, density).unwrap() };
        let sun = Vec3::new(0.6, 0.8, 0.0);
        let at = |density, height, sun: Vec3| fur(density).sun_through(Vec3::Y, height, 1.0, sun);
        assert_eq!((at(0.3, 1.0, sun), at(0.3, 0.0, Vec3::Y)), (1.0, 1.0), "above it, and along strands");
        assert!(at(0.3, 0.8, sun) > at(0.3, 0.4, sun) && at(0.3, 0.4, sun) > at(0.3, 0.0, sun));
        assert!(at(0.1, 0.2, sun) > at(0.3, 0.2, sun));
        assert!(at(0.3, 0.2, sun) > at(0.3, 0.2, Vec3::new(0.8, 0.6, 0.0)));
        // Without taper and variation it is the exponential of n 2 r h tan.
        let even = Fur { taper: 0.0, variation: 0.0, ..fur(0.2) };
        let met = even.strands_per_area() as f32 * 2.0 * even.radius_along(0.0) * 0.5 * even.height * 0.75;
        assert!((even.sun_through(Vec3::Y, 0.5, 1.0, sun) - (-met).exp()).abs() < 1e-5);
        // Strands that lean towards the sun take less of it than those that lean away.
        let leaning = |x: f32| Fur { bend: Vec3::X * x, ..fur(0.3) }.sun_through(Vec3::Y, 0.2, 1.0, sun);
        assert!(leaning(0.5) > leaning(0.0) && leaning(0.0) > leaning(-0.5));
        // A coat of half the length is fur of half the height, and bald skin has all of the sun.
        let half = Fur { height: 0.05, ..fur(0.3) };
        let short = fur(0.3).sun_through(Vec3::Y, 0.2, 0.5, sun);
        assert!((short - half.sun_through(Vec3::Y, 0.4, 1.0, sun)).abs() < 1e-5);
        assert_eq!(fur(0.3).sun_through(Vec3::Y, 0.0, 0.0, sun), 1.0);
        assert_eq!(fur(0.3).sun_through(Vec3::Y, 0.6, 0.5, sun), 1.0);
        for odd in [f32::NAN, f32::INFINITY, -1.0] {
            let share = fur(0.3).sun_through(Vec3::Y, 0.1, odd, sun);
            assert!((0.0..=1.0).contains(&share), "{odd}: {share}");
        }
        assert!(at(0.3, 0.0, -Vec3::Y) <= 1.0 && at(0.3, f32::NAN, sun).is_nan());
    }
}
