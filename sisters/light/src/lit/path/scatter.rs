//! How a surface scatters light: Lambert's law and a lobe around the mirror direction (Lafortune &
//! Willems, *Using the Modified Phong Reflectance Model for Physically Based Rendering*, 1994),
//! which loses energy at grazing angles and never gains any.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};
use rand::RngExt;

use crate::lit::Material;
use casca_scenes::random::Generator;

/// A surface that is looked at from one direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scatter {
    normal: DVec3,
    mirror: DVec3,
    albedo: DVec3,
    specular: DVec3,
    exponent: f64,
    /// The chance that the diffuse part is sampled.
    diffuse: f64,
}

impl Scatter {
    /// `direction` is that of the look, towards the surface.
    pub(super) fn new(material: &Material, (colour, normal): (Vec3, DVec3), direction: DVec3) -> Self {
        let (albedo, specular) = ((material.albedo * colour).as_dvec3(), material.specular.as_dvec3());
        let (d, s) = (albedo.element_sum(), specular.element_sum());
        Self {
            normal,
            mirror: direction - normal * (2.0 * direction.dot(normal)),
            albedo,
            specular,
            exponent: material.exponent(),
            diffuse: if d + s > 0.0 { d / (d + s) } else { 1.0 },
        }
    }

    /// The unit normal.
    pub(super) fn normal(&self) -> DVec3 {
        self.normal
    }

    /// The share of light from a unit direction `way` that is scattered to the eye, times the
    /// cosine to the normal.
    pub(super) fn value(&self, way: DVec3) -> DVec3 {
        let cos = way.dot(self.normal).max(0.0);
        let lobe = way.dot(self.mirror).clamp(0.0, 1.0).powf(self.exponent);
        (self.albedo / PI + self.specular * ((self.exponent + 2.0) / TAU * lobe)) * cos
    }

    /// The density with which [`Self::sample`] finds a direction, by solid angle.
    pub(super) fn density(&self, way: DVec3) -> f64 {
        let cos = way.dot(self.normal).max(0.0);
        let lobe = way.dot(self.mirror).clamp(0.0, 1.0).powf(self.exponent);
        self.diffuse * cos / PI + (1.0 - self.diffuse) * (self.exponent + 1.0) / TAU * lobe
    }

    /// A direction, and its value over its density; `None` if the light is absorbed.
    pub(super) fn sample(&self, random: &mut Generator) -> Option<(DVec3, DVec3)> {
        let (a, b) = (random.random(), random.random());
        let way = match random.random::<f64>() < self.diffuse {
            true => around(self.normal, 0.0, a, b),
            false => around(self.mirror, self.exponent, a, b),
        };
        let (value, density) = (self.value(way), self.density(way));
        (value.max_element() > 0.0 && density > 0.0).then(|| (way, value / density))
    }
}

/// A unit vector around an axis, with a density in proportion to the cosine to it (exponent 0) or
/// to that power of the cosine.
fn around(axis: DVec3, exponent: f64, a: f64, b: f64) -> DVec3 {
    let cos = a.powf(1.0 / if exponent == 0.0 { 2.0 } else { exponent + 1.0 });
    turned(axis, cos, b)
}

/// The unit vector at an angle to an axis, given by its cosine, and turned around it by a share of
/// the full circle.
pub(super) fn turned(axis: DVec3, cos: f64, turn: f64) -> DVec3 {
    let (x, y) = axis.any_orthonormal_pair();
    let (sin, (s, c)) = ((1.0 - cos * cos).max(0.0).sqrt(), (TAU * turn).sin_cos());
    x * (sin * c) + y * (sin * s) + axis * cos
}
