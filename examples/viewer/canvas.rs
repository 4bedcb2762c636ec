//! Pictures and item buffers of one size, drawn without a window.

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use casca_lab::command_line::PathError;
use casca_lab::world::{Camera, Object};

use super::geometry::{DrawList, Geometry, colour_of};
use super::gpu::{COLOUR, DEPTH, Gpu, GpuError, ITEMS};
use super::renderer::{Marks, NO_ITEM, Output, Renderer};

/// Textures to draw to.
pub struct Canvas {
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// The picture.
    pub picture: wgpu::Texture,
    items: wgpu::Texture,
    depth: wgpu::Texture,
}

/// What an item buffer says about a set of objects.
#[derive(Debug, Clone, Default)]
pub struct Check {
    /// Tested objects that some pixel shows, ascending.
    pub shown: Vec<usize>,
    /// Those of them that are not in the set.
    pub lost: Vec<usize>,
}

impl Canvas {
    /// Textures of `size`, made smaller if the device has no such large ones.
    pub fn new(gpu: &Gpu, size: (u32, u32)) -> Self {
        Self {
            size: gpu.clamp(size),
            picture: gpu.texture(size, COLOUR),
            items: gpu.texture(size, ITEMS),
            depth: gpu.texture(size, DEPTH),
        }
    }

    /// Draws the picture.
    pub fn draw(&self, gpu: &Gpu, renderer: &mut Renderer, camera: &Camera, list: &DrawList, marks: &Marks) {
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        renderer.draw(gpu, Output::Picture, (&view(&self.picture), &view(&self.depth)), camera, list, marks);
    }

    /// Draws the picture and reads it: red, green, blue, opacity, row by row.
    ///
    /// # Errors
    /// As [`Gpu::read`].
    pub fn pixels(
        &self,
        gpu: &Gpu,
        renderer: &mut Renderer,
        camera: &Camera,
        list: &DrawList,
    ) -> Result<Vec<u8>, GpuError> {
        self.draw(gpu, renderer, camera, list, &Marks::default());
        gpu.read(&self.picture)
    }

    /// Draws the item buffer and reads it: the number of the object in each pixel, or [`NO_ITEM`].
    ///
    /// # Errors
    /// As [`Gpu::read`].
    pub fn items(
        &self,
        gpu: &Gpu,
        renderer: &mut Renderer,
        camera: &Camera,
        list: &DrawList,
    ) -> Result<Vec<u32>, GpuError> {
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        let views = (&view(&self.items), &view(&self.depth));
        renderer.draw(gpu, Output::Items, views, camera, list, &Marks::default());
        let bytes = gpu.read(&self.items)?;
        Ok(bytes.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect())
    }

    /// Compares a set, ascending, with what an item buffer of all objects shows. One looks
    /// through objects that hide nothing: for those, all that hides is drawn once more without them.
    ///
    /// # Errors
    /// As [`Gpu::read`].
    pub fn check(
        &self,
        gpu: &Gpu,
        renderer: &mut Renderer,
        camera: &Camera,
        (geometry, objects): (&Geometry, &[Object]),
        set: &[usize],
    ) -> Result<Check, GpuError> {
        let mut seen = vec![false; objects.len()];
        let all = objects.iter().all(|o| o.occludes);
        for occluders in [false, true] {
            if occluders && all {
                break;
            }
            let drawn = (0..objects.len()).filter(|&i| !occluders || objects[i].occludes);
            let list = geometry.list(objects, drawn, &|_| [0; 4]);
            for item in self.items(gpu, renderer, camera, &list)? {
                if item != NO_ITEM {
                    seen[item as usize] = true;
                }
            }
        }
        let shown: Vec<usize> = (0..objects.len()).filter(|&i| seen[i] && objects[i].tested).collect();
        let lost = shown.iter().copied().filter(|i| set.binary_search(i).is_err()).collect();
        Ok(Check { shown, lost })
    }
}

/// The list that draws some objects in their own colours.
pub fn coloured(geometry: &Geometry, objects: &[Object], visible: &[usize]) -> DrawList {
    geometry.list(objects, visible.iter().copied(), &|i| colour_of(i, &objects[i]))
}

/// Writes a picture of four bytes a pixel as a PNG.
///
/// # Errors
/// The file cannot be written.
pub fn write_png(path: &Path, (width, height): (u32, u32), pixels: &[u8]) -> Result<(), Box<dyn Error>> {
    let file = File::create(path).map_err(PathError::write(path))?;
    let mut encoder = png::Encoder::new(BufWriter::new(file), width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let opaque: Vec<u8> = pixels.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(&opaque)?;
        writer.finish()
    });
    written.map_err(|why| format!("cannot write {}: {why}", path.display()).into())
}
