//! The columns, the nearest lines and the occlusion on the graphics processor, as compute shaders
//! of `wgpu`, for lines that move in every frame; and bundles of lines as objects of a
//! [`casca::Scene`], so that lines behind walls and meshes are not drawn, and those beyond the
//! reach of the occlusion not voxelised either.
//!
//! - [`set`]: lines in the memory of a device, in bundles.
//! - [`moving`]: lines of which a part moves, so that only that part is put into place anew.
//! - [`lens`]: a view as the shaders take it, and how far the occlusion of a pixel reaches.
//! - [`culling`]: the bundles that a view may see, and those that may darken what it sees.
//! - [`context`]: meshes among the lines, which hide them.
//! - [`hidden`]: lines behind nearer lines, which are not drawn.
//! - [`settings`]: what is computed.
//! - [`antialiasing`]: smooth borders of lines.
//! - `grid`: the cells of lines on the device, in parts where they are large; `rays`: the passes of
//!   rays through them.
//! - `sides`: the occlusion at places along lines, which stays from frame to frame.
//! - [`renderer`]: columns, nearest lines, occlusion, pictures.
//!
//! The results are those of the processor's version but for rounding: [`numeric`] says where that
//! decides and how far.

pub mod antialiasing;
#[cfg(test)]
mod colours;
pub mod context;
pub mod culling;
pub mod error;
mod frame;
mod grid;
pub mod hidden;
pub mod lens;
pub mod moving;
mod nearest;
pub mod numeric;
mod picture;
mod rays;
pub mod renderer;
pub mod set;
pub mod settings;
mod shader;
mod sides;
#[cfg(test)]
mod tests;
