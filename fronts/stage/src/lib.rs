//! The parts that programs which show casca at work have in common. Nothing here knows the library.
//!
//! With the feature `gpu`:
//!
//! - `gpu`: the graphics device, and reading textures back.
//! - `canvas`: pictures and item buffers without a window.
//! - `kernel`: compute passes and what they are bound to.
//! - `pass`: render passes, and the pipelines that draw in them.
//! - `timing`: the time of each stage of a frame.
//!
//! With the feature `window`:
//!
//! - `window`: a window and its loop.
//! - `page`: a program in the canvas of a page; on WebAssembly only.
//! - `dial`: settings by their names.
//! - `report`: what a program says about itself.
//! - `fly`: a camera that is flown with keys and mouse.
//! - `panel`: text and images over a picture.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

#[cfg(feature = "gpu")]
pub mod canvas;
#[cfg(feature = "window")]
pub mod dial;
#[cfg(feature = "window")]
pub mod fly;
#[cfg(feature = "gpu")]
pub mod gpu;
#[cfg(feature = "gpu")]
pub mod kernel;
#[cfg(all(feature = "window", target_arch = "wasm32"))]
pub mod page;
#[cfg(feature = "window")]
pub mod panel;
#[cfg(feature = "gpu")]
pub mod pass;
#[cfg(feature = "window")]
pub mod report;
#[cfg(feature = "gpu")]
mod scope;
#[cfg(feature = "window")]
mod screen;
#[cfg(feature = "gpu")]
pub mod timing;
#[cfg(feature = "window")]
pub mod window;

// One version of each for all programs.
#[cfg(feature = "gpu")]
pub use wgpu;
#[cfg(feature = "window")]
pub use {egui, winit};
