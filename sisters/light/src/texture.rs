//! Textures: colours and holes over triangles.

use std::sync::Arc;

use glam::{DVec2, Vec2, Vec3, Vec4, Vec4Swizzles};

use crate::error::LightError;
use crate::numeric::{GOLDEN, LEAST_SAMPLES, MOST_SAMPLES, TEXEL_SAMPLES};
use crate::spread::{in_triangle, unit};

/// Colours and holes in rows, without a blur between them. It repeats beyond 0 and 1. Clones share the
/// texels.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    width: u32,
    height: u32,
    /// Roots of linear light, so that a byte is fine enough where it is dark; and 0 for holes.
    texels: Arc<[[u8; 4]]>,
    has_holes: bool,
}

impl Texture {
    /// A texture of rows of texels, each linear red, green and blue from 0 to 1, and opacity: less than
    /// a half is a hole, which light passes; all else is solid. The first row is at `v` = 0.
    ///
    /// # Errors
    /// If there are not `width` times `height` texels, or none.
    pub fn new(width: u32, height: u32, texels: impl IntoIterator<Item = Vec4>) -> Result<Self, LightError> {
        // Not a number becomes 0.
        let stored = |t: Vec4| {
            let [r, g, b] = t.xyz().to_array().map(|c| (c.clamp(0.0, 1.0).sqrt() * 255.0).round() as u8);
            [r, g, b, if t.w < 0.5 { 0 } else { u8::MAX }]
        };
        let texels: Arc<[[u8; 4]]> = texels.into_iter().map(stored).collect();
        let count = u64::from(width) * u64::from(height);
        if texels.is_empty() || texels.len() as u64 != count {
            return Err(LightError::Texels { width, height, texels: texels.len() });
        }
        let has_holes = texels.iter().any(|t| t[3] == 0);
        Ok(Self { width, height, texels, has_holes })
    }

    /// Texels along both axes.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Whether light passes somewhere.
    pub fn has_holes(&self) -> bool {
        self.has_holes
    }

    /// Row by row: roots of linear red, green and blue, as bytes, and 0 for holes or 255.
    pub fn texels(&self) -> &[[u8; 4]] {
        &self.texels
    }

    /// The linear colour at a place; `None` in a hole.
    pub fn at(&self, place: DVec2) -> Option<Vec3> {
        // Places that are no number are in the corner.
        let texel = |part: f64, size: u32| (((part - part.floor()) * f64::from(size)) as u32).min(size - 1);
        let (x, y) = (texel(place.x, self.width), texel(place.y, self.height));
        let [r, g, b, solid] = self.texels[y as usize * self.width as usize + x as usize];
        (solid > 0).then(|| Vec3::from_array([r, g, b].map(|c| (f32::from(c) / 255.0).powi(2))))
    }

    /// The mean colour of what is solid in a triangle, and the share of that in it.
    pub fn mean(&self, uv: [Vec2; 3]) -> (Vec3, f32) {
        self.over(uv, 1.0, 0, |share, across| {
            let [_, s, t] = in_triangle(share, across);
            [s, t]
        })
    }

    /// The same for a part of a triangle, which is a share of it; `at` gives barycentric coordinates of the
    /// second and the third corner by two numbers from 0 to 1.
    pub(crate) fn over(
        &self,
        uv: [Vec2; 3],
        part: f64,
        key: u64,
        at: impl Fn(f64, f64) -> [f64; 2],
    ) -> (Vec3, f32) {
        let [u, v, w] = uv.map(|p| p.as_dvec2() * DVec2::new(self.width.into(), self.height.into()));
        let texels = 0.5 * (v - u).perp_dot(w - u).abs() * part;
        let count = (TEXEL_SAMPLES * texels).clamp(LEAST_SAMPLES, MOST_SAMPLES).ceil();
        let (turn, shift) = (unit(key, 2), unit(key, 3));
        let sample = |i: u32| {
            let i = f64::from(i);
            self.at(place(uv, at((i + turn) / count, (i * GOLDEN + shift).fract())))
        };
        let solid = (0..count as u32).filter_map(sample);
        let (sum, found) = solid.fold((Vec3::ZERO, 0.0), |(sum, n), colour| (sum + colour, n + 1.0_f32));
        (sum / found.max(1.0), found / count as f32)
    }
}

/// The place in a texture at barycentric coordinates of the second and the third corner.
fn place(uv: [Vec2; 3], [s, t]: [f64; 2]) -> DVec2 {
    let [u, v, w] = uv.map(|p| p.as_dvec2());
    u + (v - u) * s + (w - u) * t
}

/// A texture over a triangle.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Skin {
    pub(crate) texture: Texture,
    /// Where the corners lie in it.
    pub(crate) uv: [Vec2; 3],
    /// The mean colour of what is solid, and how much of the triangle that is.
    pub(crate) mean: Vec3,
    pub(crate) solid: f32,
}

impl Skin {
    pub(crate) fn new(texture: &Texture, uv: [Vec2; 3]) -> Self {
        let (mean, solid) = texture.mean(uv);
        Self { texture: texture.clone(), uv, mean, solid }
    }

    /// Whether there is something at barycentric coordinates of the second and the third corner.
    pub(crate) fn is_solid(&self, shares: [f64; 2]) -> bool {
        self.texture.at(place(self.uv, shares)).is_some()
    }
}
