//! Textures of pictures.

use casca_radiosity::gpu::Surfaces;
use casca_stage::gpu::{DEPTH, Gpu, GpuError};
use casca_stage::wgpu::{TextureFormat, TextureUsages, TextureView};

/// The format of places and light.
pub const FLOATS: TextureFormat = TextureFormat::Rgba32Float;
/// The formats of what is drawn of surfaces: 32 bytes in all, as many as any device takes.
pub const SURFACES: [TextureFormat; 3] = [FLOATS, TextureFormat::Rgba16Float, TextureFormat::Rg32Float];

/// Textures of one size.
pub struct Frame {
    pub size: (u32, u32),
    /// Places, normals, and roughness with the material.
    pub surfaces: [TextureView; 3],
    pub depth: TextureView,
    /// Irradiance with gaps, without, and of the rest.
    pub gapped: TextureView,
    pub lit: TextureView,
    pub rest: TextureView,
    pub mirrored: TextureView,
    pub light: TextureView,
}

impl Frame {
    /// Textures of a size, or as large as the device has them.
    ///
    /// # Errors
    /// The device has no room for them.
    pub fn new(gpu: &Gpu, size: (u32, u32)) -> Result<Self, GpuError> {
        let size = gpu.clamp(size);
        let texture = |format, usage| {
            let made = gpu.try_room(|| gpu.texture_for(size, format, usage));
            let bytes = 16 * u64::from(size.0) * u64::from(size.1);
            let most = gpu.device.limits().max_buffer_size;
            made.map(|t| t.create_view(&Default::default())).ok_or(GpuError::NoRoom { bytes, most })
        };
        let stored = || texture(FLOATS, TextureUsages::STORAGE_BINDING);
        let of_surface = |format| texture(format, TextureUsages::RENDER_ATTACHMENT);
        Ok(Self {
            size,
            surfaces: [of_surface(SURFACES[0])?, of_surface(SURFACES[1])?, of_surface(SURFACES[2])?],
            gapped: stored()?,
            lit: stored()?,
            rest: stored()?,
            mirrored: stored()?,
            depth: texture(DEPTH, TextureUsages::RENDER_ATTACHMENT)?,
            light: stored()?,
        })
    }

    /// What was drawn of surfaces, for the cache.
    pub fn drawn(&self) -> Surfaces<'_> {
        let [place, normals, _] = &self.surfaces;
        Surfaces { place, normals }
    }
}
