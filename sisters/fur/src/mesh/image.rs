//! Images that colour fur, and where vertices lie on them.

use std::sync::{Arc, LazyLock};

use glam::{UVec2, Vec2, Vec3};

use crate::error::{Error, range};
use crate::numeric::{MAX_IMAGE_SIDE, MAX_IMAGES, MAX_TEX_COORD};

/// Where texture coordinates outside of 0 to 1 lie, as in glTF.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Wrap {
    /// The image is repeated.
    #[default]
    Repeat,
    /// The texel at the border goes on.
    Clamp,
    /// The image is repeated, every other one as in a mirror.
    Mirror,
}

impl Wrap {
    /// The texel of a row of `side` texels, for any number.
    fn texel(self, number: f64, side: u32) -> usize {
        let side = f64::from(side);
        let within = match self {
            Self::Repeat => number.rem_euclid(side),
            Self::Clamp => number,
            Self::Mirror => {
                let place = number.rem_euclid(2.0 * side);
                if place < side { place } else { 2.0 * side - 1.0 - place }
            }
        };
        within.clamp(0.0, side - 1.0) as usize
    }
}

/// An image of colours: red, green and blue in sRGB, and opacity, which fur ignores. Clones share
/// the texels.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    size: UVec2,
    wrap: [Wrap; 2],
    texels: Arc<[u8]>,
}

/// The linear light of a byte of sRGB (IEC 61966-2-1), 0 to 1.
pub fn linear_of(byte: u8) -> f32 {
    static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
        std::array::from_fn(|byte| {
            let stored = byte as f64 / 255.0;
            let light = if stored <= 0.04045 { stored / 12.92 } else { ((stored + 0.055) / 1.055).powf(2.4) };
            light as f32
        })
    });
    LINEAR[usize::from(byte)]
}

impl Image {
    /// An image of four bytes a texel, row by row from the top, and how it goes on along u and v.
    ///
    /// # Errors
    /// Refuses sides of 0 or more than 16,384 texels, and another number of bytes.
    pub fn new(size: UVec2, texels: Vec<u8>, wrap: [Wrap; 2]) -> Result<Self, Error> {
        for side in size.to_array() {
            range("the side of an image in texels", side.into(), 1.0, MAX_IMAGE_SIDE.into())?;
        }
        let expected = 4 * size.x as usize * size.y as usize;
        if texels.len() != expected {
            return Err(Error::Count { what: "bytes of an image", found: texels.len(), expected });
        }
        Ok(Self { size, wrap, texels: texels.into() })
    }

    /// Width and height in texels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// Red, green, blue and opacity of each texel, row by row from the top.
    pub fn texels(&self) -> &[u8] {
        &self.texels
    }

    /// How the image goes on along u and v.
    pub fn wrap(&self) -> [Wrap; 2] {
        self.wrap
    }

    /// The linear colour at texture coordinates, 0 to 1 each: the mean of four texels by their
    /// nearness, mixed in linear light. (0, 0) is the corner of the image that is stored first.
    /// White for coordinates that are not finite.
    pub fn color(&self, uv: Vec2) -> Vec3 {
        if !uv.is_finite() {
            return Vec3::ONE;
        }
        let at = uv.as_dvec2() * self.size.as_dvec2() - 0.5;
        let first = at.floor();
        let part = (at - first).as_vec2();
        let texel = |x: f64, y: f64| {
            let column = self.wrap[0].texel(first.x + x, self.size.x);
            let row = self.wrap[1].texel(first.y + y, self.size.y);
            Self::linear(&self.texels[4 * (row * self.size.x as usize + column)..][..4])
        };
        let row = |y: f64| texel(0.0, y).lerp(texel(1.0, y), part.x);
        row(0.0).lerp(row(1.0), part.y)
    }

    /// The linear colour of a texel, which has three bytes at least.
    pub(crate) fn linear(texel: &[u8]) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|i| linear_of(texel[i])))
    }
}

/// Where a vertex lies on an image.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TexCoord {
    /// Across and down: 0 to 1 is the image, from its first corner to its last.
    pub uv: Vec2,
    /// Which of the mesh's images colours it; none: the coat alone. Corners of a triangle must
    /// agree.
    pub image: Option<u16>,
}

impl TexCoord {
    /// The linear colour there: white without an image, or with one that is not there.
    pub fn color(&self, images: &[Image]) -> Vec3 {
        let image = self.image.and_then(|image| images.get(usize::from(image)));
        image.map_or(Vec3::ONE, |image| image.color(self.uv))
    }
}

/// Refuses another number of coordinates than vertices, coordinates that are not finite or above
/// 1e6, images above 64, and triangles whose corners lie on different images.
pub(super) fn check_tex_coords(
    coords: &[TexCoord],
    vertices: usize,
    triangles: &[[u32; 3]],
) -> Result<(), Error> {
    if coords.len() != vertices {
        return Err(Error::Count { what: "texture coordinates", found: coords.len(), expected: vertices });
    }
    for (vertex, coord) in coords.iter().enumerate() {
        // NaN is not below.
        if !coord.uv.abs().cmple(Vec2::splat(MAX_TEX_COORD)).all() {
            let (what, value) = ("texture coordinate", coord.uv.extend(0.0));
            return Err(Error::Vertex { vertex, what, value, max: MAX_TEX_COORD });
        }
        let image = coord.image.unwrap_or(0);
        range("the number of an image", image.into(), 0.0, f64::from(MAX_IMAGES) - 1.0)?;
    }
    let image = |v: u32| coords[v as usize].image;
    match triangles.iter().position(|t| image(t[0]) != image(t[1]) || image(t[1]) != image(t[2])) {
        Some(triangle) => Err(Error::Images { triangle }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(wrap: Wrap) -> Image {
        // Black, white; middle grey, red.
        let texels = [[0, 0, 0, 255], [255; 4], [128, 128, 128, 255], [255, 0, 0, 0]].concat();
        Image::new(UVec2::splat(2), texels, [wrap; 2]).unwrap()
    }

    #[test]
    fn colours_are_linear_and_mixed_in_linear_light() {
        let image = image(Wrap::Clamp);
        let at = |u: f32, v: f32| image.color(Vec2::new(u, v));
        assert_eq!((at(0.25, 0.25), at(0.75, 0.25)), (Vec3::ZERO, Vec3::ONE));
        // sRGB 128 is 21.6% of the light, and not a half.
        assert!((at(0.25, 0.75) - 0.2158605).abs().max_element() < 1e-6);
        assert!((at(0.5, 0.25) - 0.5).abs().max_element() < 1e-6, "half of the light of white");
        assert_eq!(at(f32::NAN, 0.0), Vec3::ONE);
    }

    #[test]
    fn images_go_on_as_they_say() {
        let at = |wrap: Wrap, u: f32| image(wrap).color(Vec2::new(u, 0.25)).x;
        for (wrap, values) in
            [(Wrap::Repeat, [1.0, 0.0]), (Wrap::Clamp, [0.0, 1.0]), (Wrap::Mirror, [0.0, 1.0])]
        {
            assert_eq!([-0.25, 1.25].map(|u| at(wrap, u)), values, "{wrap:?}");
        }
        assert_eq!([Wrap::Clamp, Wrap::Mirror].map(|wrap| at(wrap, 1.75)), [1.0, 0.0]);
        // Far away, too.
        assert!(at(Wrap::Mirror, 1e30).is_finite() && at(Wrap::Repeat, -1e30).is_finite());
    }

    #[test]
    fn absurd_images_and_coordinates_are_refused() {
        let made = |x: u32, y: u32, bytes: usize| {
            Image::new(UVec2::new(x, y), vec![0; bytes], [Wrap::Repeat; 2]).map(drop)
        };
        assert!(matches!(made(0, 1, 0), Err(Error::Range { .. })));
        assert!(matches!(made(u32::MAX, u32::MAX, 0), Err(Error::Range { .. })));
        assert!(matches!(made(2, 2, 15), Err(Error::Count { expected: 16, .. })));
        let on = |u: f32, image: Option<u16>| TexCoord { uv: Vec2::new(u, 0.0), image };
        let check = |coords: &[TexCoord]| check_tex_coords(coords, 3, &[[0, 1, 2]]);
        assert_eq!(check(&[on(-3.0, Some(1)); 3]), Ok(()));
        assert!(matches!(check(&[on(0.0, None); 2]), Err(Error::Count { .. })));
        assert!(matches!(check(&[on(f32::NAN, None); 3]), Err(Error::Vertex { vertex: 0, .. })));
        assert!(matches!(check(&[on(0.0, Some(64)); 3]), Err(Error::Range { .. })));
        let mixed = [on(0.0, Some(1)), on(0.0, Some(1)), on(0.0, None)];
        assert_eq!(check(&mixed), Err(Error::Images { triangle: 0 }));
    }
}
