//! Fur on any closed mesh, drawn as layers (shells), and what a visibility culler saves on it.
//!
//! After B. P. Evangelista, "Real-time rendering of fur on arbitrary meshes obtained from real
//! objects" (Master's thesis in Portuguese, UFMG 2009), with the errors of the thesis mended.
//! Without the feature `gpu` it is the processor's part: no window, no graphics.
//!
//! - [`mesh`]: centring, continuous normals, welding, vertex-cache order, levels of detail.
//! - [`strands`]: where strands of fur stand: a rule without texture coordinates and without
//!   singularities, for shaders and rays.
//! - [`skin`]: skeletons, clips and poses of animals that move, and bounds that hold them.
//! - [`shading`]: the light of a strand (Kajiya and Kay 1989).
//! - [`shader`]: the rule of strands as text for shaders, for other renderers.
//! - [`visibility`]: bounds that contain the fur, the occluders of furry objects, and how many
//!   layers each object gets.
//!
//! - `gpu`, behind the feature of that name: shells on the graphics processor, and rays that hit
//!   the same strands.
//! - `scenes`, behind the feature of that name: furry animals and fields of them among walls,
//!   and characters of glTF files.

mod error;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod mesh;
mod numeric;
#[cfg(test)]
mod samples;
#[cfg(feature = "scenes")]
pub mod scenes;
pub mod shader;
pub mod shading;
pub mod skin;
pub mod strands;
pub mod visibility;

/// The version of glam whose types these functions take and give.
pub use glam;

pub use error::Error;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
