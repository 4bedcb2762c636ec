//! Why nothing can be drawn.

use casca_stage::gpu::GpuError;

/// Why nothing can be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FurGpuError {
    /// The fur or the mesh is refused.
    #[error(transparent)]
    Fur(#[from] crate::Error),
    /// A pass that this device or these shaders cannot draw into.
    #[error(
        "a pass of {format:?} with {samples} samples a pixel cannot be drawn into: give a format for colours that \
         does not convert them (not sRGB), and 1 or 4 samples"
    )]
    Pass {
        /// The format of its colours.
        format: casca_stage::wgpu::TextureFormat,
        /// Its samples.
        samples: u32,
    },
    /// The device fails, or has no room.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The view or the scene is refused.
    #[error("casca refused the view or the scene: {0}")]
    Scene(#[from] casca::Error),
}
