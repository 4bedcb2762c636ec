//! Light that bounces: voxel cone tracing on the grid of casca, with wgpu.
//!
//! After J. G. Villegas Guedez, *Trazado de Conos para el Cálculo de Iluminación Global empleando
//! Sombreado de Vóxeles* (thesis, Universidad Central de Venezuela 2016), which follows Crassin et
//! al. 2011 with dense textures instead of an octree.
//!
//! In the order of imports:
//!
//! - `numeric`: every margin and constant of the shaders, with its reason.
//! - [`error`]: why there is no light.
//! - [`volume`]: the grid of voxels and its bricks.
//! - [`data`]: triangles, materials and lights as the shaders take them.
//! - [`device`]: shaders and buffers.
//! - [`cones`]: the cones for a hemisphere, and how they march.
//! - [`layers`]: triangles into voxels, in a fixed and a moving layer.
//! - [`reach`]: which bricks a picture can read: the culler's part.
//! - [`shading`]: light in voxels, and the directional mips.
//! - [`picture`]: the light of each pixel.
//! - [`renderer`]: all passes, and which of them run again after a change.
//! - [`culling`]: a scene of the library for a lit scene.
//!
//! `casca-viewer light` shows it.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

pub mod cones;
pub mod culling;
pub mod data;
pub mod device;
pub mod error;
pub mod layers;
mod numeric;
pub mod picture;
pub mod reach;
pub mod renderer;
pub mod shading;
pub mod volume;
