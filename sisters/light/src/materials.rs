//! Materials, and textures: colours over triangles.

use std::sync::Arc;

use glam::{DVec2, Vec3};

use crate::checks::numbers;
use crate::error::LightError;
use crate::numeric::BRIGHTEST;

/// What a surface does to light.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Material {
    /// The share of light that is scattered diffusely, by channel, 0 to 1.
    pub albedo: Vec3,
    /// Emitted radiance, in watts per square metre and steradian, by channel.
    pub emission: Vec3,
    /// Index into [`crate::Scene::textures`]: its texels times `albedo` are the albedo.
    pub albedo_texture: Option<u32>,
    /// Index into [`crate::Scene::textures`]: its texels times `emission` are the emission.
    pub emission_texture: Option<u32>,
}

impl Material {
    /// A material without textures.
    pub const fn new(albedo: Vec3, emission: Vec3) -> Self {
        Self { albedo, emission, albedo_texture: None, emission_texture: None }
    }
}

/// Colours in rows: linear, not in sRGB. It repeats beyond 0 and 1. Clones share the texels.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// The texels, and halves of them down to one.
    levels: Arc<[Level]>,
    most: Vec3,
}

#[derive(Debug, Clone, PartialEq)]
struct Level {
    width: u32,
    height: u32,
    texels: Vec<Vec3>,
}

impl Level {
    fn texel(&self, x: i64, y: i64) -> Vec3 {
        let (w, h) = (i64::from(self.width), i64::from(self.height));
        self.texels[(y.rem_euclid(h) * w + x.rem_euclid(w)) as usize]
    }

    /// Between the middles of four texels.
    fn at(&self, uv: DVec2) -> Vec3 {
        let place = uv * DVec2::new(self.width.into(), self.height.into()) - 0.5;
        let (low, share) = (place.floor(), (place - place.floor()).as_vec2());
        let (x, y) = (low.x as i64, low.y as i64);
        let row = |y| self.texel(x, y).lerp(self.texel(x + 1, y), share.x);
        row(y).lerp(row(y + 1), share.y)
    }

    /// Half as many texels along each axis, rounded up. Each is the mean of those that it covers.
    fn half(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        // An odd edge has a last texel that covers one alone.
        let mean = |i: u32| {
            let (x, y) = (i % width * 2, i / width * 2);
            let covered =
                (y..(y + 2).min(self.height)).flat_map(|y| (x..(x + 2).min(self.width)).map(move |x| (x, y)));
            let sum = covered.fold((Vec3::ZERO, 0.0), |(sum, n), (x, y)| {
                (sum + self.texels[(y * self.width + x) as usize], n + 1.0)
            });
            sum.0 / sum.1
        };
        Self { width, height, texels: (0..width * height).map(mean).collect() }
    }
}

impl Texture {
    /// A texture of rows of texels; the first row is at `v` = 0.
    ///
    /// # Errors
    /// If there are not `width` times `height` texels, none, or one is negative, too bright or not
    /// finite.
    pub fn new(width: u32, height: u32, texels: Vec<Vec3>) -> Result<Self, LightError> {
        let count = u64::from(width) * u64::from(height);
        if count == 0 || count > u64::from(u32::MAX) || texels.len() as u64 != count {
            return Err(LightError::Texels { width, height, texels: texels.len() });
        }
        for (index, texel) in texels.iter().enumerate() {
            numbers("texel", index, *texel, 0.0..=BRIGHTEST)?;
        }
        let most = texels.iter().fold(Vec3::ZERO, |most, t| most.max(*t));
        let mut levels = vec![Level { width, height, texels }];
        while let Some(last) = levels.last().filter(|l| l.texels.len() > 1) {
            levels.push(last.half());
        }
        Ok(Self { levels: levels.into(), most })
    }

    /// The texels of the finest level along both axes.
    pub(crate) fn size(&self) -> DVec2 {
        DVec2::new(self.levels[0].width.into(), self.levels[0].height.into())
    }

    /// The colour at a place, as the mean over about so many texels.
    pub(crate) fn at(&self, uv: DVec2, texels: f64) -> Vec3 {
        // So far out, whole numbers end.
        if !uv.is_finite() || uv.abs().max_element() > f64::from(u32::MAX) {
            return self.levels[self.levels.len() - 1].texels[0];
        }
        let level = (0.5 * texels.max(1.0).log2()).round() as usize;
        self.levels[level.min(self.levels.len() - 1)].at(uv)
    }
}

/// Refuses materials without their textures, and those that scatter more than comes.
pub(crate) fn check_materials(materials: &[Material], textures: &[Texture]) -> Result<(), LightError> {
    let count = textures.len();
    for (index, m) in materials.iter().enumerate() {
        let most = |texture: Option<u32>| match texture {
            None => Ok(Vec3::ONE),
            Some(t) => match textures.get(t as usize) {
                Some(texture) => Ok(texture.most),
                None => Err(LightError::Texture { material: index, texture: t, count }),
            },
        };
        let (albedo, emission) = (most(m.albedo_texture)?, most(m.emission_texture)?);
        // The factors themselves must be sound, also where all texels are 0.
        numbers("the albedo of material", index, m.albedo, 0.0..=f32::MAX)?;
        numbers("the albedo of material", index, m.albedo * albedo, 0.0..=1.0)?;
        numbers("the emission of material", index, m.emission, 0.0..=BRIGHTEST)?;
        numbers("the emission of material", index, m.emission * emission, 0.0..=BRIGHTEST)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_keep_the_mean_of_even_sizes_and_places_repeat() {
        let texels: Vec<Vec3> = (0..32).map(|i| Vec3::new(i as f32, 1.0, (i % 8) as f32)).collect();
        let texture = Texture::new(8, 4, texels.clone()).unwrap();
        let mean = texels.iter().sum::<Vec3>() / 32.0;
        let last = texture.at(DVec2::splat(0.3), 1e9);
        assert!((last - mean).length() < 1e-5, "{last} {mean}");
        // The middle of the texel (5, 2), also some repeats away.
        for turn in [DVec2::ZERO, DVec2::new(-3.0, 7.0)] {
            let found = texture.at(DVec2::new(5.5 / 8.0, 2.5 / 4.0) + turn, 1.0);
            assert!((found - texels[2 * 8 + 5]).length() < 1e-5, "{found}");
        }
        assert_eq!(texture.at(DVec2::NAN, 1.0), last);
    }
}
