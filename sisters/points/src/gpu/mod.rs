//! The operators on the graphics processor, with compute and render shaders of `wgpu`.
//!
//! - [`SplatOperator`]: the splat operator, with the same answers as
//!   [`splat::visible_points`](crate::splat::visible_points).
//! - [`SurfelRenderer`]: surface splatting, which draws points as a closed surface.
//!
//! The device comes from `casca_stage::gpu::Gpu`.

mod splat;
mod surfels;

pub use splat::{GpuPoints, GpuSplatError, SplatOperator};
pub use surfels::{Pane, Style, Surfel, SurfelRenderer, Surfels};

#[cfg(test)]
mod tests;
