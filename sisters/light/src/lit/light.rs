//! Lights that are no surfaces: directional, point and spot, each with a size that makes its
//! shadows soft.

use glam::Vec3;

/// Where a light is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// Infinitely far away, like the sun.
    Directional {
        /// Where its light travels to; any length but 0.
        direction: Vec3,
        /// Half the angle that it is seen under, in radians; 0 for sharp shadows.
        half_angle: f32,
    },
    /// A ball that shines into all directions.
    Point {
        /// Its centre.
        position: Vec3,
        /// Its radius in metres; 0 for sharp shadows.
        radius: f32,
    },
    /// A ball that shines into a cone.
    Spot {
        /// Its centre.
        position: Vec3,
        /// The axis of the cone; any length but 0.
        direction: Vec3,
        /// Its radius in metres; 0 for sharp shadows.
        radius: f32,
        /// Half the angle of the full light, in radians.
        inner: f32,
        /// Half the angle beyond which there is none, in radians; more than `inner`.
        outer: f32,
    },
}

/// How the light of points and spots decreases with the distance d: by 1 / (constant + linear d +
/// quadratic d²).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Falloff {
    /// The constant part.
    pub constant: f32,
    /// By metre.
    pub linear: f32,
    /// By square metre.
    pub quadratic: f32,
}

impl Falloff {
    /// That of nature, 1 / d².
    pub const INVERSE_SQUARE: Self = Self { constant: 0.0, linear: 0.0, quadratic: 1.0 };

    /// The share of the light at a distance in metres.
    pub fn at(&self, d: f32) -> f32 {
        let share = 1.0 / (self.constant + self.linear * d + self.quadratic * d * d);
        if share.is_finite() && share > 0.0 { share } else { 0.0 }
    }
}

/// A light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Where it is.
    pub kind: LightKind,
    /// Its strength by channel: the irradiance of a surface that faces a directional light; for the
    /// others the radiant intensity, which is that irradiance at a metre by inverse squares.
    pub color: Vec3,
    /// How it decreases; not used by directional lights.
    pub falloff: Falloff,
}

/// A light as a point sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Incident {
    /// Unit vector to its centre.
    pub direction: Vec3,
    /// Distance to its centre in metres; infinite for directional lights.
    pub distance: f32,
    /// The cosine of half the angle that it is seen under; 1 for lights without size, 0 within the
    /// light.
    pub cos_half_angle: f32,
    /// Its irradiance on a surface that faces it, if nothing hides it.
    pub irradiance: Vec3,
}

impl Light {
    /// A light without size that decreases by inverse squares.
    pub const fn point(position: Vec3, color: Vec3) -> Self {
        Self { kind: LightKind::Point { position, radius: 0.0 }, color, falloff: Falloff::INVERSE_SQUARE }
    }

    /// How a point sees the light; `None` where there is none of it, or values are not sound.
    pub fn incident(&self, from: Vec3) -> Option<Incident> {
        let (position, radius) = match self.kind {
            LightKind::Directional { direction, half_angle } => {
                let cos = half_angle.clamp(0.0, std::f32::consts::FRAC_PI_2).cos();
                return sound(-direction.try_normalize()?, f32::INFINITY, cos, self.color);
            }
            LightKind::Point { position, radius } | LightKind::Spot { position, radius, .. } => {
                (position, radius.max(0.0))
            }
        };
        let (direction, distance) = (position - from).normalize_and_length();
        let mut irradiance = self.color * self.falloff.at(distance);
        if let LightKind::Spot { direction: axis, inner, outer, .. } = self.kind {
            irradiance *= smoothstep(outer.cos(), inner.cos(), -axis.try_normalize()?.dot(direction));
        }
        let sin = (radius / distance).min(1.0);
        sound(direction, distance, (1.0 - sin * sin).max(0.0).sqrt(), irradiance)
    }
}

fn sound(direction: Vec3, distance: f32, cos_half_angle: f32, irradiance: Vec3) -> Option<Incident> {
    let usable = direction.is_finite()
        && direction != Vec3::ZERO
        && irradiance.is_finite()
        && irradiance.max_element() > 0.0
        && cos_half_angle.is_finite();
    usable.then_some(Incident { direction, distance, cos_half_angle, irradiance })
}

/// 0 up to `low`, 1 from `high`, smooth between.
fn smoothstep(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
