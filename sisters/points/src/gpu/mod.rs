//! Surface splatting on the graphics processor, with the render shaders of `wgpu`: a
//! [`SurfelRenderer`] draws points as a closed surface.
//!
//! The device comes from `casca_stage::gpu::Gpu`.

mod surfels;

pub use surfels::{Pane, Style, Surfel, SurfelRenderer, Surfels};

#[cfg(test)]
mod tests;
