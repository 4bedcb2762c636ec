//! The light of a strand: Kajiya & Kay 1989, "Rendering fur with three dimensional textures", with
//! the errors of the thesis mended.
//!
//! All directions are unit vectors in one space, world space for example (the listing of the thesis
//! mixes world and view space), and lead away from the strand. Roots of negative numbers, which
//! rounding makes, are clamped. The cylinder's diffuse light is the same on the dark side of a
//! body; a factor by the surface's normal removes it there, as Goldman (1997) does for short fur.

use glam::Vec3;

/// The two parts of the light that a thin cylinder throws back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lobes {
    /// The sine of the angle between strand and light: 0 to 1.
    pub diffuse: f32,
    /// The power of the cosine of the angle between the eye and the cone of mirrored directions: 0
    /// to 1.
    pub specular: f32,
}

/// The lobes of a strand along `tangent`, for the directions to the light and to the eye.
///
/// ```
/// use casca_fur::shading::kajiya_kay;
/// use glam::Vec3;
///
/// // Light and eye on opposite sides of the strand, at the same angle: the eye is on the mirror cone.
/// let (light, eye) = (Vec3::new(0.6, 0.8, 0.0), Vec3::new(0.0, -0.8, 0.6));
/// let lobes = kajiya_kay(Vec3::Y, light, eye, 32.0);
/// assert!((lobes.diffuse - 0.6).abs() < 1e-6 && (lobes.specular - 1.0).abs() < 1e-5);
/// ```
pub fn kajiya_kay(tangent: Vec3, to_light: Vec3, to_eye: Vec3, exponent: f32) -> Lobes {
    let (tl, te) = (tangent.dot(to_light), tangent.dot(to_eye));
    let sine = |cosine: f32| (1.0 - cosine * cosine).max(0.0).sqrt();
    let mirror = (sine(tl) * sine(te) - tl * te).clamp(0.0, 1.0);
    Lobes { diffuse: sine(tl), specular: mirror.powf(exponent) }
}

/// How fur throws light back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Light from everywhere, as a share of the sun's.
    pub ambient: f32,
    /// The share of the sun's light thrown back in all directions.
    pub diffuse: f32,
    /// The strength of the highlight, which has the sun's colour.
    pub specular: f32,
    /// How narrow the highlight is.
    pub exponent: f32,
    /// How far the light reaches around the body, 0 to 1: fur scatters light beyond the terminator.
    pub wrap: f32,
    /// The light that reaches the root of a strand between its neighbours, 0 to 1; it grows
    /// linearly to 1 at the tip.
    pub root: f32,
}

impl Default for Material {
    fn default() -> Self {
        Self { ambient: 0.3, diffuse: 0.8, specular: 0.18, exponent: 24.0, wrap: 0.4, root: 0.3 }
    }
}

impl Material {
    /// The share of light that reaches a place along a strand, 0 to 1, between its neighbours.
    pub fn depth(&self, along: f32) -> f32 {
        self.root + (1.0 - self.root) * along
    }

    /// The linear colour of a point of a strand, by the shares of the light from everywhere and of
    /// the sun's that reach it: between neighbours [`Material::depth`], 0 in a shadow. The thesis
    /// adds only the lobes.
    pub fn shade(&self, color: Vec3, strand: &Directions, sky: f32, sun: f32) -> Vec3 {
        let lobes = kajiya_kay(strand.tangent, strand.to_light, strand.to_eye, self.exponent);
        let facing = ((strand.normal.dot(strand.to_light) + self.wrap) / (1.0 + self.wrap)).clamp(0.0, 1.0);
        // Strands that point at the light show it their sides: half the light comes from the body's
        // slope alone.
        let diffuse = self.diffuse * (0.5 + 0.5 * lobes.diffuse) * facing;
        color * (sky * self.ambient + sun * diffuse)
            + Vec3::splat(sun * self.specular * lobes.specular * facing)
    }
}

/// The unit directions at a point of a strand, all in one space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Directions {
    /// Along the strand, away from the body.
    pub tangent: Vec3,
    /// The normal of the body below.
    pub normal: Vec3,
    /// Towards the light.
    pub to_light: Vec3,
    /// Towards the eye.
    pub to_eye: Vec3,
}

#[cfg(test)]
mod tests {
    use super::*;
    use casca_scenes::random::Dice;

    /// A sine is the root of 1 less a square: near 0 that loses digits.
    const SINE: f64 = 1e-4;

    #[test]
    fn lobes_are_those_of_the_angles() {
        let mut random = Dice::new(9, 0);
        for _ in 0..10_000 {
            let [t, l, e] = std::array::from_fn(|_| random.ball().normalize());
            let lobes = kajiya_kay(t, l, e, 8.0);
            let angle = |d: Vec3| t.as_dvec3().angle_between(d.as_dvec3());
            let (a, b) = (angle(l), angle(e));
            // The mirror cone has the angle pi - a around the strand.
            let mirror = (std::f64::consts::PI - a - b).cos().max(0.0).powi(8);
            assert!((f64::from(lobes.diffuse) - a.sin()).abs() < SINE, "{t} {l}");
            assert!((f64::from(lobes.specular) - mirror).abs() < SINE, "{t} {l} {e}");
        }
    }

    #[test]
    fn no_rounding_makes_nan_and_the_dark_side_is_dark() {
        let material = Material::default();
        // A little longer than 1, as rounding leaves it.
        let long = Vec3::new(0.6000001, 0.8000001, 0.0);
        for (l, e) in [(long, long), (-long, long), (long, -long)] {
            assert!(kajiya_kay(long, l, e, 32.0).specular.is_finite());
        }
        let strand = |to_light| Directions { tangent: Vec3::Y, normal: Vec3::Y, to_light, to_eye: Vec3::X };
        let at = |l, along, sun| {
            let depth = material.depth(along);
            material.shade(Vec3::ONE, &strand(l), depth, sun * depth).x
        };
        let light = |l| at(l, 1.0, 1.0);
        // The cylinder's light alone is the same on both sides.
        assert_eq!(light(Vec3::NEG_Y), material.ambient);
        assert!(light(Vec3::Y) > 2.0 * light(Vec3::NEG_Y));
        assert!(at(Vec3::Y, 0.0, 1.0) < 0.5 * light(Vec3::Y) && at(Vec3::Y, 1.0, 0.0) == material.ambient);
    }
}
