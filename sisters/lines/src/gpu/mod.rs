//! The nearest lines and the occlusion on the graphics processor, as compute shaders of `wgpu`, for
//! lines that move in every frame; and bundles of lines as objects of a [`casca::Scene`], so that
//! lines behind walls and meshes are not drawn.
//!
//! - [`set`]: lines in the memory of a device, in bundles.
//! - [`lens`]: a view as the shaders take it.
//! - [`culling`]: the bundles that a view may see.
//! - [`context`]: meshes among the lines, which hide them.
//! - [`settings`]: what is computed.
//! - [`antialiasing`]: smooth borders of lines.
//! - `rays`: the cells of lines on the device, and the passes of rays through them.
//! - `sides`: the occlusion at places along lines, which stays from frame to frame.
//! - [`renderer`]: nearest lines, occlusion, pictures.
//!
//! The results are those of the processor's version but for rounding: [`numeric`] says where that
//! decides and how far.

pub mod antialiasing;
pub mod context;
pub mod culling;
pub mod error;
mod frame;
pub mod lens;
mod nearest;
pub mod numeric;
mod picture;
mod rays;
pub mod renderer;
pub mod set;
pub mod settings;
mod sides;
#[cfg(test)]
mod tests;
