//! Pictures and times without a window.

use std::time::Instant;

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

/// Pictures of one size in rows of `columns`, from the left and from the top; white where the last
/// row has none.
pub fn sheet(pictures: &[Picture], columns: usize) -> Picture {
    let columns = columns.max(1);
    let Some(first) = pictures.first() else { return Picture { size: (0, 0), pixels: Vec::new() } };
    let (width, height) = (first.size.0 as usize, first.size.1 as usize);
    let mut pixels = Vec::new();
    for row in pictures.chunks(columns) {
        for y in 0..height {
            row.iter().for_each(|p| pixels.extend(p.pixels.iter().skip(4 * width * y).take(4 * width)));
            pixels.resize(pixels.len() + 4 * width * (columns - row.len()), 255);
        }
    }
    let rows = pictures.len().div_ceil(columns);
    Picture { size: (first.size.0 * columns as u32, first.size.1 * rows as u32), pixels }
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

    /// The milliseconds that `frame` takes until the device is done.
    pub fn time(
        &self,
        frame: &mut dyn FnMut(&Canvas) -> Result<(), FurGpuError>,
    ) -> Result<f64, FurGpuError> {
        self.gpu.wait()?;
        let start = Instant::now();
        frame(&self.canvas)?;
        self.gpu.wait()?;
        Ok(start.elapsed().as_secs_f64() * 1e3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_has_its_pictures_side_by_side_and_below_each_other() {
        let one = |v: u8| Picture { size: (1, 2), pixels: [[v; 4], [v + 1; 4]].concat() };
        let made = sheet(&[one(0), one(10), one(20), one(30)], 2);
        let values: Vec<u8> = made.pixels.chunks(4).map(|p| p[0]).collect();
        assert_eq!((made.size, values), ((2, 4), vec![0, 10, 1, 11, 20, 30, 21, 31]));
        // White where one is missing.
        let made = sheet(&[one(0), one(10), one(20)], 2);
        let values: Vec<u8> = made.pixels.chunks(4).map(|p| p[0]).collect();
        assert_eq!((made.size, values), ((2, 4), vec![0, 10, 1, 11, 20, 255, 21, 255]));
        assert_eq!(sheet(&[], 2).size, (0, 0));
    }
}
