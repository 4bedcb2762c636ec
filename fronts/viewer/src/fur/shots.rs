//! Pictures without a window.

use casca_fur::gpu::error::FurGpuError;
use casca_fur::gpu::records::{DrawList, Sun};
use casca_fur::gpu::renderer::Renderer;
use casca_scenes::world::Camera;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::Gpu;
use casca_tools::image::halved;

/// A picture and its size.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    pub size: (u32, u32),
    /// Red, green, blue, opacity, row by row.
    pub pixels: Vec<u8>,
}

/// Draws pictures of one size, larger by a power of two and halved as often.
pub struct Shooter<'a> {
    gpu: &'a Gpu,
    canvas: Canvas,
    smooth: u32,
}

impl<'a> Shooter<'a> {
    pub fn new(gpu: &'a Gpu, (width, height): (u32, u32), smooth: u32) -> Self {
        // What the device cannot draw larger is drawn as it is.
        let most = gpu.device.limits().max_texture_dimension_2d;
        let smooth = (0..=smooth).rev().find(|s| (width.max(height) << s) <= most).unwrap_or(0);
        Self { gpu, canvas: Canvas::new(gpu, (width << smooth, height << smooth)), smooth }
    }

    /// Width over height.
    pub fn aspect(&self) -> f32 {
        self.canvas.aspect()
    }

    /// The height that is drawn, in pixels.
    pub fn drawn_height(&self) -> u32 {
        self.canvas.size().1
    }

    /// Draws a list, with the shadows that the renderer has.
    pub fn shoot(
        &self,
        renderer: &mut Renderer,
        camera: &Camera,
        list: &DrawList,
        sun: &Sun,
    ) -> Result<Picture, FurGpuError> {
        renderer.draw(self.gpu, &self.canvas.picture(), camera, list, sun)?;
        let (mut size, mut pixels) = (self.canvas.size(), self.canvas.read_picture(self.gpu)?);
        for _ in 0..self.smooth {
            pixels = halved(&pixels, size);
            size = (size.0 / 2, size.1 / 2);
        }
        Ok(Picture { size, pixels })
    }
}
