//! Textures of glTF files: their images, from buffers and from files beside, and where vertices lie
//! in them.

use std::collections::HashMap;
use std::io::Cursor;
use std::path::Path;
use std::sync::LazyLock;

use casca_scenes::import::Trouble;
use casca_scenes::import::parts::{Buffers, Components, Known, beside, decoded, unfit};
use glam::{Mat2, UVec2, Vec2, Vec3};
use gltf::accessor::DataType;
use gltf::texture::{Info, WrappingMode};
use gltf::{Accessor, Primitive, Semantic};
use image::{DynamicImage, ImageDecoder, ImageReader, Limits};

/// Texels that all images of a file may have: a quarter of a gigabyte. A short file can hold an
/// image of any size.
const MOST_TEXELS: u64 = 1 << 26;
/// The longest side of an image.
const MOST_SIDE: u32 = 16_384;
/// Bytes of an image in a file of its own.
const MOST_BYTES: usize = 1 << 28;

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

/// An image, and how it goes on along u and v.
pub struct Picture {
    /// Its texels along both sides.
    pub size: UVec2,
    /// By texel, row by row from the top: red, green and blue in sRGB, and opacity.
    pub texels: Vec<u8>,
    /// How it goes on.
    pub wrap: [WrappingMode; 2],
}

impl Picture {
    /// The linear colour at finite texture coordinates: the mean of four texels by their nearness,
    /// mixed in linear light. (0, 0) is the corner of the image that is stored first.
    pub fn color(&self, uv: Vec2) -> Vec3 {
        let at = uv.as_dvec2() * self.size.as_dvec2() - 0.5;
        let first = at.floor();
        let part = (at - first).as_vec2();
        let texel = |x: f64, y: f64| {
            let column = texel_of(self.wrap[0], first.x + x, self.size.x);
            let row = texel_of(self.wrap[1], first.y + y, self.size.y);
            let at = 4 * (row * self.size.x as usize + column);
            Vec3::from_array([0, 1, 2].map(|i| linear_of(self.texels[at + i])))
        };
        let row = |y: f64| texel(0.0, y).lerp(texel(1.0, y), part.x);
        row(0.0).lerp(row(1.0), part.y)
    }
}

/// The texel of a row of `side` texels, for any number.
fn texel_of(wrap: WrappingMode, number: f64, side: u32) -> usize {
    let side = f64::from(side);
    let within = match wrap {
        WrappingMode::Repeat => number.rem_euclid(side),
        WrappingMode::ClampToEdge => number,
        WrappingMode::MirroredRepeat => {
            let place = number.rem_euclid(2.0 * side);
            if place < side { place } else { 2.0 * side - 1.0 - place }
        }
    };
    within.clamp(0.0, side - 1.0) as usize
}

/// Reads the images of textures; those that several materials share are read once.
pub struct Images<'a> {
    buffers: &'a Buffers,
    folder: Option<&'a Path>,
    known: HashMap<usize, Picture>,
    texels: u64,
}

impl<'a> Images<'a> {
    /// None so far, of a file with these buffers in this folder.
    pub fn new(buffers: &'a Buffers, folder: Option<&'a Path>) -> Self {
        Self { buffers, folder, known: HashMap::new(), texels: MOST_TEXELS }
    }

    /// The image of a texture.
    ///
    /// # Errors
    /// It is damaged, neither PNG nor JPEG, missing or too large.
    pub fn of(&mut self, texture: &gltf::Texture) -> Result<&Picture, Trouble> {
        if !self.known.contains_key(&texture.index()) {
            let picture = self.read(texture)?;
            self.known.insert(texture.index(), picture);
        }
        Ok(&self.known[&texture.index()])
    }

    /// Where the vertices of a primitive, so many, lie in a texture. Without coordinates all lie in
    /// its corner, as viewers draw it.
    ///
    /// # Errors
    /// Coordinates that are not finite, or are not there for each vertex.
    pub fn places(&self, primitive: &Primitive, info: &Info, count: usize) -> Result<Vec<Vec2>, Trouble> {
        let moved = info.texture_transform();
        let set = moved.as_ref().and_then(|t| t.tex_coord()).unwrap_or(info.tex_coord());
        let turn = moved.as_ref().map_or(Mat2::IDENTITY, |t| {
            Mat2::from_angle(-t.rotation()) * Mat2::from_diagonal(Vec2::from_array(t.scale()))
        });
        let offset = moved.map_or(Vec2::ZERO, |t| Vec2::from_array(t.offset()));
        let stored = match primitive.get(&Semantic::TexCoords(set)) {
            Some(accessor) => attribute(self.buffers, &accessor, "texture coordinates", count)?,
            None => vec![[0.0; 2]; count],
        };
        let places: Vec<Vec2> = stored.into_iter().map(|uv| turn * Vec2::from_array(uv) + offset).collect();
        match places.iter().all(|p| p.is_finite()) {
            true => Ok(places),
            false => Err(Trouble::NotFinite("a texture coordinate".to_owned())),
        }
    }

    fn read(&mut self, texture: &gltf::Texture) -> Result<Picture, Trouble> {
        let source = texture.source();
        let fail = |why: String| Trouble::Part(format!("image {} {why}", source.index()));
        let bytes = match source.source() {
            gltf::image::Source::View { view, .. } => self.buffers.view(&view)?.to_vec(),
            gltf::image::Source::Uri { uri: "", .. } => {
                return Err(fail("has no source that is read; export it as PNG or JPEG".to_owned()));
            }
            gltf::image::Source::Uri { uri, .. } => match uri.split_at_checked(5) {
                Some((scheme, rest)) if scheme.eq_ignore_ascii_case("data:") => {
                    decoded(rest).map_err(fail)?
                }
                _ => beside(self.folder, uri, MOST_BYTES, &mut Known::new()).map_err(fail)?.to_vec(),
            },
        };
        let (size, texels) = pixels(&bytes, self.texels).map_err(fail)?;
        self.texels -= u64::from(size.x) * u64::from(size.y);
        Ok(Picture { size, texels, wrap: [texture.sampler().wrap_s(), texture.sampler().wrap_t()] })
    }
}

/// Floats, or normalised integers without sign; one for each vertex of a primitive.
///
/// # Errors
/// There are none of these types, or not as many.
pub fn attribute<const N: usize>(
    buffers: &Buffers,
    accessor: &Accessor,
    what: &'static str,
    count: usize,
) -> Result<Vec<[f32; N]>, Trouble> {
    if !matches!(accessor.data_type(), DataType::F32 | DataType::U8 | DataType::U16) {
        return Err(unfit(accessor, what, "of a type that is not read"));
    }
    if accessor.count() != count {
        return Err(unfit(accessor, what, "not as long as the positions"));
    }
    buffers.floats(accessor, what, Components::Normalized)
}

/// The size of an image, and four bytes a texel.
fn pixels(bytes: &[u8], most: u64) -> Result<(UVec2, Vec<u8>), String> {
    let why = |e: image::ImageError| format!("is no sound PNG or JPEG, and others are not read: {e}");
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string())?;
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(MOST_SIDE), Some(MOST_SIDE));
    limits.max_alloc = Some(16 * most);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(why)?;
    let (width, height) = decoder.dimensions();
    // Before it is decoded.
    if width == 0
        || height == 0
        || width.max(height) > MOST_SIDE
        || u64::from(width) * u64::from(height) > most
    {
        return Err(format!("has {width} x {height} texels; images of a file may have {MOST_TEXELS} in all"));
    }
    let picture = DynamicImage::from_decoder(decoder).map_err(why)?.into_rgba8();
    Ok((UVec2::new(width, height), picture.into_raw()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(wrap: WrappingMode) -> Picture {
        // Black, white; middle grey, red.
        let texels = [[0, 0, 0, 255], [255; 4], [128, 128, 128, 255], [255, 0, 0, 0]].concat();
        Picture { size: UVec2::splat(2), texels, wrap: [wrap; 2] }
    }

    #[test]
    fn colours_are_mixed_in_linear_light_and_images_go_on_as_they_say() {
        let (repeated, clamped, mirrored) =
            (WrappingMode::Repeat, WrappingMode::ClampToEdge, WrappingMode::MirroredRepeat);
        let at = |u: f32, v: f32| picture(clamped).color(Vec2::new(u, v));
        assert_eq!((at(0.25, 0.25), at(0.75, 0.25)), (Vec3::ZERO, Vec3::ONE));
        // sRGB 128 is 21.6% of the light, and not a half.
        assert!((at(0.25, 0.75) - 0.2158605).abs().max_element() < 1e-6);
        assert!((at(0.5, 0.25) - 0.5).abs().max_element() < 1e-6, "half of the light of white");
        let at = |wrap: WrappingMode, u: f32| picture(wrap).color(Vec2::new(u, 0.25)).x;
        for (wrap, values) in [(repeated, [1.0, 0.0]), (clamped, [0.0, 1.0]), (mirrored, [0.0, 1.0])] {
            assert_eq!([-0.25, 1.25].map(|u| at(wrap, u)), values, "{wrap:?}");
        }
        assert_eq!([clamped, mirrored].map(|wrap| at(wrap, 1.75)), [1.0, 0.0]);
        // Far away, too.
        assert!(at(mirrored, 1e30).is_finite() && at(repeated, -1e30).is_finite());
    }
}
