//! Fur for Bevy: layers (shells) on any mesh, lit, shadowed and fogged by Bevy's own renderer.
//!
//! [`FurPlugin`] gives each entity with a mesh and [`Furry`] a child, the [`Coat`], whose mesh
//! holds all layers of the fur, and chooses in each frame how many there are: by their height in
//! pixels, by the animals that were visible in the last frame, and by a budget ([`FurSettings`]).
//! [`casca_fur`] has the shader text that places strands. The README has an example.

mod coat;
mod grow;
mod material;
mod numeric;
mod plugin;
mod shells;
mod sights;
mod store;

pub use casca_fur;

pub use coat::{Coat, FurSettings, Furry};
pub use material::{FurExtension, FurMaterial, fur_material};
pub use plugin::{FurPlugin, FurSystems};
pub use shells::{ATTRIBUTE_FUR_LAYER, ATTRIBUTE_FUR_LENGTH};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
