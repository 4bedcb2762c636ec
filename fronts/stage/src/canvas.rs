//! Pictures and item buffers of one size, drawn without a window.

use crate::gpu::{COLOUR, DEPTH, Gpu, GpuError, ITEMS, Reading};

/// Textures to draw into.
pub struct Canvas {
    size: (u32, u32),
    picture: wgpu::Texture,
    items: wgpu::Texture,
    depth: wgpu::Texture,
}

/// A texture that is drawn into, with a depth texture of the same size.
pub struct Target {
    /// Colours, or the numbers of objects.
    pub colour: wgpu::TextureView,
    /// Depth.
    pub depth: wgpu::TextureView,
}

impl Target {
    /// Views of two textures.
    pub fn new(colour: &wgpu::Texture, depth: &wgpu::Texture) -> Self {
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        Self { colour: view(colour), depth: view(depth) }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        let texture = self.colour.texture();
        (texture.width(), texture.height())
    }
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

    /// Width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Width over height.
    pub fn aspect(&self) -> f32 {
        self.size.0 as f32 / self.size.1 as f32
    }

    /// The picture, to draw into. Its format is [`COLOUR`].
    pub fn picture(&self) -> Target {
        Target::new(&self.picture, &self.depth)
    }

    /// The item buffer, to draw into. Its format is [`ITEMS`].
    pub fn items(&self) -> Target {
        Target::new(&self.items, &self.depth)
    }

    /// The picture as it was drawn: red, green, blue, opacity, row by row.
    ///
    /// # Errors
    /// As [`Gpu::read`].
    pub fn read_picture(&self, gpu: &Gpu) -> Result<Vec<u8>, GpuError> {
        gpu.read(&self.picture)
    }

    /// The item buffer as it was drawn: the number in each pixel, row by row.
    ///
    /// # Errors
    /// As [`Gpu::read`].
    pub fn read_items(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        Ok(items_of(&gpu.read(&self.items)?).collect())
    }

    /// Begins to read the item buffer as it was drawn; [`items_of`] what is read.
    ///
    /// # Errors
    /// As [`Gpu::read_later`].
    pub fn read_items_later(&self, gpu: &Gpu) -> Result<Reading, GpuError> {
        gpu.read_later(&self.items)
    }
}

/// The numbers in the bytes of an item buffer.
pub fn items_of(bytes: &[u8]) -> impl Iterator<Item = u32> {
    bytes.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b))
}
