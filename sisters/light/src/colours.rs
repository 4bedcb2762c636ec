//! The colours of surfaces: at points, and their means over parts.

use glam::{DVec3, Vec3};

use crate::clip::{Polygon, cross, point_of};
use crate::materials::{Material, Texture};
use crate::numeric::{GOLDEN, TEXEL_SAMPLES};
use crate::surfaces::Surface;

/// The materials of a scene with their textures.
#[derive(Debug, Clone, Default)]
pub(crate) struct Materials {
    pub(crate) all: Vec<Material>,
    pub(crate) textures: Vec<Texture>,
}

/// Which colour of a material.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Colour {
    Albedo,
    Emission,
}

impl Materials {
    /// Whether a surface is a lamp.
    pub(crate) fn emits(&self, surface: &Surface) -> bool {
        self.all[surface.material as usize].emission.max_element() > 0.0
    }

    fn colour(&self, surface: &Surface, which: Colour) -> (Vec3, Option<&Texture>) {
        let m = &self.all[surface.material as usize];
        let (factor, texture) = match which {
            Colour::Albedo => (m.albedo, m.albedo_texture),
            Colour::Emission => (m.emission, m.emission_texture),
        };
        (factor, texture.map(|t| &self.textures[t as usize]))
    }

    /// The colour at a point of a surface.
    pub(crate) fn at(&self, surface: &Surface, point: DVec3, which: Colour) -> Vec3 {
        let (factor, texture) = self.colour(surface, which);
        texture.map_or(factor, |t| factor * t.at(surface.coordinates(point), 1.0))
    }

    /// The mean colour over a part of a surface; `part` gives its polygon.
    pub(crate) fn over(&self, surface: &Surface, which: Colour, part: impl FnOnce() -> Polygon) -> Vec3 {
        let (factor, Some(texture)) = self.colour(surface, which) else {
            return self.colour(surface, which).0;
        };
        let part = part();
        let area = 0.5 * cross(&part).length();
        let texels = surface.texels(texture.size()) * area / surface.area;
        let count = f64::from(TEXEL_SAMPLES);
        let sample = |i: u32| {
            let (along, across) = ((f64::from(i) + 0.5) / count, (f64::from(i) * GOLDEN + 0.5).fract());
            texture.at(surface.coordinates(point_of(&part, along * area, across)), texels / count)
        };
        factor * (0..TEXEL_SAMPLES).map(sample).sum::<Vec3>() / TEXEL_SAMPLES as f32
    }
}
