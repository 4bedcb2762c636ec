//! The parameters of fur, where its strands stand, and how much of the sun passes through.

use std::f32::consts::{PI, TAU};

use glam::{IVec3, Vec3, Vec3Swizzles};

use crate::error::{Error, range};
use crate::numeric::{
    CELLS_ON_RADIUS, CLUMPED, CURLED, EXTRUSION_ERROR, LEAST_DIVISOR, LEAST_LENGTH, LEAST_RISE, MAX_CELLS,
    MAX_COORDINATE, MAX_PER_CELL, MAX_RADIUS, PERIOD, SPREAD, TUFT, TURNS,
};

/// The fur of an object. All lengths are in its object space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fur {
    /// The length of the longest strands, before they bend.
    pub height: f32,
    /// How far the tips of the longest strands are moved along the surface, in multiples of the
    /// height: the part along the surface of this vector, times the square of the relative height.
    /// For gravity and combing; its length is at most 4.
    pub bend: Vec3,
    /// The edge of the hash cells. There are `per_cell / (2 * spacing²)` strands on a square unit.
    pub spacing: f32,
    /// Points in each cell: 1 to 4.
    pub per_cell: u32,
    /// The radius of a strand at its root, as a share of the spacing: above 0, at most 0.43.
    pub radius: f32,
    /// How much thinner the tip is: 0 for cylinders, 1 for needles.
    pub taper: f32,
    /// How much shorter the shortest strands are than the longest: 0 to 1.
    pub variation: f32,
    /// How far the tips of a tuft come together, 0 to 1: a tuft is nine cells wide.
    pub clump: f32,
    /// How far strands curl, 0 to 1; those of a tuft curl together.
    pub curl: f32,
    /// Another seed places other strands.
    pub seed: u32,
}

impl Fur {
    /// Fur for a mesh of a radius, as the thesis gives it: the height is a share of the radius (it
    /// uses 0.02 and 0.05), the density the share of the skin that roots cover, if they did not
    /// overlap (0.1 and 0.2). The other parameters have usual values and may be set afterwards: 60
    /// cells on a radius, one point each up to the density of 0.29 and more above.
    ///
    /// # Errors
    /// Refuses radii outside of 1e-9 to 1e9, heights outside of 0 to 1 and densities outside of
    /// 0.001 to 1.
    pub fn for_radius(radius: f32, height: f32, density: f32) -> Result<Self, Error> {
        range("the radius of the mesh", radius.into(), LEAST_LENGTH, MAX_COORDINATE.into())?;
        range("the height of the fur as a share of the radius", height.into(), 0.0, 1.0)?;
        range("the density of the fur", density.into(), 0.001, 1.0)?;
        // density = per_cell / 2 * pi * radius²
        let thick = |per_cell: u32| (2.0 * density / (PI * per_cell as f32)).sqrt();
        let per_cell = (1..MAX_PER_CELL).find(|&n| thick(n) <= MAX_RADIUS).unwrap_or(MAX_PER_CELL);
        Ok(Self {
            height: height * radius,
            bend: Vec3::ZERO,
            spacing: radius / CELLS_ON_RADIUS,
            per_cell,
            radius: thick(per_cell),
            taper: 0.8,
            variation: 0.3,
            clump: 0.0,
            curl: 0.0,
            seed: 1,
        })
    }

    /// Strands on a square unit of any surface.
    pub fn strands_per_area(&self) -> f64 {
        0.5 * f64::from(self.per_cell) / (f64::from(self.spacing) * f64::from(self.spacing))
    }

    /// Checks all parameters, for a mesh of a radius.
    ///
    /// # Errors
    /// Names the first parameter that is out of its range.
    pub fn check(&self, mesh_radius: f32) -> Result<(), Error> {
        range("the height of the fur", self.height.into(), 0.0, MAX_COORDINATE.into())?;
        range("the bend of the fur", self.bend.length().into(), 0.0, 4.0)?;
        range(
            "the spacing of strands",
            self.spacing.into(),
            f64::from(mesh_radius / MAX_CELLS).max(LEAST_LENGTH),
            MAX_COORDINATE.into(),
        )?;
        range("the points of a cell", self.per_cell.into(), 1.0, MAX_PER_CELL.into())?;
        range("the radius of a strand in cells", self.radius.into(), 1e-3, MAX_RADIUS.into())?;
        range("the taper", self.taper.into(), 0.0, 1.0)?;
        range("the variation of lengths", self.variation.into(), 0.0, 1.0)?;
        range("how far tufts come together", self.clump.into(), 0.0, 1.0)?;
        range("how far strands curl", self.curl.into(), 0.0, 1.0)
    }

    /// The greatest distance of a point of the fur from the point of the base mesh below it,
    /// rounded up. `magnitude` is the greatest absolute coordinate of the mesh, for the rounding of
    /// shaders.
    pub fn reach(&self, magnitude: f32) -> f32 {
        let exact = self.height * (1.0 + self.bend.length_squared()).sqrt();
        exact + EXTRUSION_ERROR * (magnitude + 2.0 * exact)
    }

    /// Where the point of the base mesh at `position` with the unit normal `normal` is in the layer
    /// at `height`, 0 to 1. All layers of a mesh are this function of its vertices.
    #[inline]
    pub fn extruded(&self, position: Vec3, normal: Vec3, height: f32) -> Vec3 {
        position + (normal * height + self.side(normal) * (height * height)) * self.height
    }

    /// The unit direction of the strands at a height: the derivative of [`Fur::extruded`].
    #[inline]
    pub fn tangent(&self, normal: Vec3, height: f32) -> Vec3 {
        (normal + self.side(normal) * (2.0 * height)).normalize_or(normal)
    }

    /// The part of the bend that lies along the surface, so that layers never cut into the base.
    #[inline]
    fn side(&self, normal: Vec3) -> Vec3 {
        self.bend - normal * self.bend.dot(normal)
    }

    /// The length of the strand with this random byte, as a share of the length of the coat.
    #[inline]
    pub fn share(&self, id: u32) -> f32 {
        1.0 - self.variation * unit(id.wrapping_mul(SPREAD))
    }

    /// The radius of a strand at a place along it, 0 to 1, in units of object space.
    #[inline]
    pub fn radius_along(&self, along: f32) -> f32 {
        self.spacing * self.radius * (1.0 - self.taper * along)
    }

    /// How strands of a tuft go aside at a height, besides their bend: how far, in heights of the
    /// fur, and the bend that has the same slope there. `base` is the place on the skin below them,
    /// not their root: fragments know no other. Shaders compute the same.
    pub fn sway(&self, base: Vec3, height: f32) -> [Vec3; 2] {
        let tuft = TUFT * self.spacing;
        let at = base * (TAU / tuft);
        let sine = |v: Vec3| v.map(f32::sin);
        let wave = sine(at + 2.0 * sine(0.61 * at.yzx()));
        let angle = Vec3::new(0.0, TAU / 3.0, 2.0 * TAU / 3.0) + TURNS * height + 2.0 * wave.x;
        let unit = tuft / self.height.max(LEAST_DIVISOR);
        let (clump, curl) = (wave * (self.clump * CLUMPED * unit), self.curl * CURLED * unit);
        let (sines, cosines) = (sine(angle), angle.map(f32::cos));
        [
            (clump + curl * cosines) * (height * height),
            clump + curl * (cosines - 0.5 * TURNS * height * sines),
        ]
    }

    /// The point `k` of a cell, relative to the cell's least corner and in cells, and its random
    /// byte. Cells repeat after [`PERIOD`], and points stand on a lattice of 128 in a cell, so that
    /// a small table holds them all.
    #[inline]
    pub fn point(&self, cell: IVec3, k: u32) -> (Vec3, u32) {
        let [x, y, z] = cell.to_array().map(|c| c as u32 % PERIOD);
        let [x, y, z, id] = hash([x, y, z, self.seed.wrapping_mul(MAX_PER_CELL).wrapping_add(k)]);
        let place = |word: u32| ((word >> 25) as f32 + 0.5) / 128.0;
        (Vec3::new(place(x), place(y), place(z)), id >> 24)
    }

    /// The mean share of sunlight that reaches a height in a coat of a length on flat skin with a
    /// unit normal: 1 above the coat. Both are shares of the greatest height, 0 to 1; `to_sun` is a
    /// unit vector.
    ///
    /// Beer's law: strands stand at random, and a ray that passes a layer meets as many as stand in
    /// the area that their diameters sweep. A ray rises by one while it goes sideways by the slope
    /// of the light less that of the strands halfway up. Shaders compute the same.
    pub fn sun_through(&self, normal: Vec3, height: f32, length: f32, to_sun: Vec3) -> f32 {
        let rise = normal.dot(to_sun).max(LEAST_RISE);
        let slope = (to_sun - normal * normal.dot(to_sun)) / rise;
        // NaN has no length.
        let (height, length) = (height.clamp(0.0, 1.0), length.max(0.0).clamp(0.0, 1.0));
        // Strands of four lengths stand for all: how wide each is from here on, times how far it
        // goes.
        let shadows = (0..4)
            .map(|k| length.max(LEAST_DIVISOR) * (1.0 - self.variation * (k as f32 + 0.5) / 4.0))
            .map(|long| (long - height).max(0.0) * (2.0 - self.taper * (1.0 + height / long)));
        let sideways = (slope - self.side(normal) * (height + length)).length() * self.height;
        let met = 0.25 * shadows.sum::<f32>() * sideways * self.spacing * self.radius;
        (-met * self.strands_per_area() as f32).exp()
    }
}

/// Four well-mixed words of four: `pcg4d` of Jarzynski & Olano, "Hash Functions for GPU Rendering"
/// (JCGT 9(3), 2020). Only products, sums and shifts of 32-bit words that wrap around, so that
/// shaders compute the same bits.
#[inline]
pub fn hash(words: [u32; 4]) -> [u32; 4] {
    let mut v = words.map(|w| w.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    mix(&mut v);
    v = v.map(|w| w ^ w >> 16);
    mix(&mut v);
    v
}

#[inline]
fn mix(v: &mut [u32; 4]) {
    v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[3]));
    v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
    v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
    v[3] = v[3].wrapping_add(v[1].wrapping_mul(v[2]));
}

/// A word as a number from 0 to below 1, by its upper 24 bits: exact in single precision.
#[inline]
pub fn unit(word: u32) -> f32 {
    (word >> 8) as f32 * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::ball;
    use casca_scenes::random::Dice;

    #[test]
    fn layers_of_a_ball_are_balls_and_strands_stand_in_them() {
        let fur = Fur::for_radius(1.0, 0.3, 0.25).unwrap();
        assert!((0.5 * PI * fur.radius * fur.radius - 0.25).abs() < 1e-6 && fur.per_cell == 1);
        assert_eq!(Fur::for_radius(1.0, 0.3, 1.0).unwrap().per_cell, 4);
        for v in ball(3).vertices() {
            // The normals of a ball of triangles are off by its corners' rounding.
            let up = v.position;
            for layer in 0..=16 {
                let height = layer as f32 / 16.0;
                let at = fur.extruded(v.position, up, height);
                assert!((at.length() - (1.0 + 0.3 * height)).abs() < 1e-5);
                assert!(fur.tangent(up, height).distance(up) < 1e-5);
            }
        }
    }

    #[test]
    fn bent_strands_follow_their_tangents_and_stay_outside() {
        let mut random = Dice::new(6, 0);
        for _ in 0..1000 {
            let fur = Fur { bend: random.ball() * 2.0, ..Fur::for_radius(1.0, 0.3, 0.25).unwrap() };
            let (p, n, h) = (random.ball(), random.ball().normalize(), random.range(0.0, 1.0));
            let step = fur.extruded(p, n, h + 1e-2) - fur.extruded(p, n, h - 1e-2);
            assert!(step.normalize().distance(fur.tangent(n, h)) < 1e-3);
            // Each layer is as high above the surface as a straight one, and no farther than the
            // reach.
            let way = fur.extruded(p, n, h) - p;
            assert!((way.dot(n) - 0.3 * h).abs() < 1e-5 && way.length() <= fur.reach(1.0));
        }
    }

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

    #[test]
    fn words_are_pinned_even_and_independent() {
        // Shaders must give the same bits.
        assert_eq!(hash([1, 2, 3, 4]), [908_250_390, 4_044_648_920, 3_775_961_919, 45_698_095]);
        assert_eq!((unit(0), unit(u32::MAX)), (0.0, 1.0 - 1.0 / 16_777_216.0));
        let (mut counts, mut products, n) = ([[0_u32; 16]; 4], [0.0_f64; 4], 32_u32);
        for i in 0..n.pow(3) {
            let words = hash([i % n, i / n % n, i / n / n, 7]);
            let units = words.map(|w| f64::from(unit(w)) - 0.5);
            for k in 0..4 {
                counts[k][(words[k] >> 28) as usize] += 1;
                products[k] += units[k] * units[(k + 1) % 4];
            }
        }
        let (total, even) = (f64::from(n.pow(3)), f64::from(n.pow(3)) / 16.0);
        // 15 degrees of freedom: above 50 once in 100,000 times. A sum of n products has the
        // deviation sqrt(n) / 12.
        let chi2 = counts.map(|c| c.map(|c| (f64::from(c) - even).powi(2) / even).iter().sum::<f64>());
        assert!(
            chi2.iter().all(|&c| c < 50.0) && products.iter().all(|p| p.abs() < 5.0 * total.sqrt() / 12.0)
        );
    }
}
