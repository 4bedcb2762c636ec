//! Why nothing can be drawn.

use crate::platform::IS_PAGE;

/// Why nothing can be drawn.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// The machine has no adapter that serves; with the words of the graphics library.
    #[error("no graphics adapter: {} is needed; a software one will do", if IS_PAGE { "WebGPU or WebGL 2" } else { "a Vulkan, Metal or Direct3D 12 driver" })]
    NoAdapter(String),
    /// The adapter gives no device.
    #[error("the graphics adapter gives no device: {0}")]
    NoDevice(String),
    /// The adapter has no room for a buffer.
    #[error("the graphics adapter has no room for {bytes} bytes in one buffer (its limit is {most})")]
    NoRoom {
        /// The size of the buffer.
        bytes: u64,
        /// The largest buffer that shaders can be given.
        most: u64,
    },
    /// The device refused commands.
    #[error("the graphics device refused {stage}: {why}")]
    Refused {
        /// The stage.
        stage: &'static str,
        /// The device's words.
        why: String,
    },
    /// A picture cannot be read back.
    #[error("the picture cannot be read back: {0}")]
    Read(String),
}
