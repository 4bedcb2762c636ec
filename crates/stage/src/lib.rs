//! The parts that programs which show casca at work have in common. Nothing here knows the library.
//!
//! - [`animation`]: pictures in a row, as one animated PNG.
//! - [`gpu`]: the graphics device, and reading textures back.
//! - [`canvas`]: pictures and item buffers without a window.
//! - [`compare`]: two pictures, pixel by pixel.
//! - [`window`]: a window and its loop.
//! - [`fly`]: a camera that is flown with keys and mouse.
//! - [`panel`]: text and images over a picture.
//! - [`timing`]: the time of each stage of a frame.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

pub mod animation;
pub mod canvas;
pub mod compare;
pub mod fly;
pub mod gpu;
pub mod panel;
pub mod timing;
pub mod window;

// One version of each for all programs.
pub use {egui, wgpu, winit};
