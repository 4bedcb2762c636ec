//! Fur on the graphics processor: meshes drawn as shells, in one draw for all layers of all objects
//! that share a mesh, and a ray-traced reference of the same strands.
//!
//! - [`renderer`]: shells, skins, ground and walls, and the shadow map of the sun, also in a pass of
//!   the application's own.
//! - [`look`]: the strands, how fragments find them, and how light falls on them.
//! - [`records`]: places of objects, and lists of what to draw.
//! - [`mod@reference`]: the same strands as tubes, hit by rays.

mod bindings;
mod buffers;
pub mod error;
pub mod look;
mod numeric;
mod pipelines;
pub mod records;
pub mod reference;
pub mod renderer;
#[cfg(test)]
mod twins;
