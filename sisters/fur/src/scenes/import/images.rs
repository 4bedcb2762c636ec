//! Images of colours, from buffers and from files beside.

use std::collections::HashMap;
use std::io::Cursor;
use std::path::Path;

use crate::mesh::{Image, Wrap};
use glam::UVec2;
use gltf::texture::WrappingMode;
use image::{DynamicImage, ImageDecoder, ImageReader, Limits};

use casca_scenes::import::Trouble;
use casca_scenes::import::parts::{Buffers, Known, beside, decoded};

/// Texels that all images of a file may have: a quarter of a gigabyte. A short file can hold an
/// image of any size.
const MOST_TEXELS: u64 = 1 << 26;
/// The longest side of an image.
const MOST_SIDE: u32 = 16_384;
/// Bytes of an image in a file of its own.
const MOST_BYTES: usize = 1 << 28;
/// Images that a mesh may have.
const MOST_IMAGES: usize = 64;

/// What the reader says of fur that is refused.
pub(in crate::scenes) fn refused(error: crate::Error) -> Trouble {
    Trouble::Skin(Box::new(error))
}

/// Reads the images of textures; those that several materials share are read once.
pub(super) struct Images<'a> {
    buffers: &'a Buffers,
    folder: Option<&'a Path>,
    known: HashMap<usize, u16>,
    pub(super) read: Vec<Image>,
    texels: u64,
}

impl<'a> Images<'a> {
    pub(super) fn new(buffers: &'a Buffers, folder: Option<&'a Path>) -> Self {
        Self { buffers, folder, known: HashMap::new(), read: Vec::new(), texels: MOST_TEXELS }
    }

    /// The number of the image of a texture.
    pub(super) fn number(&mut self, texture: &gltf::Texture) -> Result<u16, Trouble> {
        if let Some(&known) = self.known.get(&texture.index()) {
            return Ok(known);
        }
        let source = texture.source();
        let fail = |why: String| Trouble::Image { image: source.index(), why };
        if self.read.len() >= MOST_IMAGES {
            return Err(fail(format!("one of more than {MOST_IMAGES}")));
        }
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
        let wrap = |mode: WrappingMode| match mode {
            WrappingMode::Repeat => Wrap::Repeat,
            WrappingMode::ClampToEdge => Wrap::Clamp,
            WrappingMode::MirroredRepeat => Wrap::Mirror,
        };
        let sampler = texture.sampler();
        let (size, texels) = pixels(&bytes, self.texels).map_err(fail)?;
        self.texels -= u64::from(size.x) * u64::from(size.y);
        let image =
            Image::new(size, texels, [wrap(sampler.wrap_s()), wrap(sampler.wrap_t())]).map_err(refused)?;
        let number = self.read.len() as u16;
        self.read.push(image);
        self.known.insert(texture.index(), number);
        Ok(number)
    }
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
