//! Lights as points see them.

use glam::Vec3;

use crate::Light;

/// A light as a point sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Incident {
    /// Unit vector to its centre.
    pub direction: Vec3,
    /// Distance to its centre in metres; infinite for suns.
    pub distance: f32,
    /// The cosine of half the angle that it is seen under; 1 for lights without size, 0 within the
    /// light.
    pub cos_half_angle: f32,
    /// Its irradiance on a surface that faces it, if nothing hides it.
    pub irradiance: Vec3,
}

impl Light {
    /// How a point sees the light; `None` where there is none of it, or values are not sound.
    pub fn incident(&self, from: Vec3) -> Option<Incident> {
        let (position, radius, mut irradiance) = match *self {
            Self::Sun { direction, irradiance, half_angle } => {
                let cos = half_angle.clamp(0.0, std::f32::consts::FRAC_PI_2).cos();
                return sound(-direction.try_normalize()?, f32::INFINITY, cos, irradiance);
            }
            Self::Point { position, intensity, radius } | Self::Spot { position, intensity, radius, .. } => {
                (position, radius.max(0.0), intensity)
            }
        };
        let (direction, distance) = (position - from).normalize_and_length();
        irradiance /= distance * distance;
        if let Self::Spot { direction: axis, inner, outer, .. } = *self {
            let (low, high, cosine) = (outer.cos(), inner.cos(), -axis.try_normalize()?.dot(direction));
            let t = ((cosine - low) / (high - low).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
            irradiance *= t * t * (3.0 - 2.0 * t);
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
