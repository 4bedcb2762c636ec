//! Ambient occlusion for dense sets of lines: streamlines, hair, wires. Where thousands of lines
//! cross, nobody can tell which is in front; darkening lines by the lines around them shows it.
//!
//! After L. de P. B. Benevides, *Oclusão de ambiente para renderização de linhas* (ambient
//! occlusion for the rendering of lines; master's thesis, PUC-Rio 2015), by its columns of slices,
//! or by rays. Lines may move in every frame.
//!
//! - [`sets`]: sets of polylines, seeded generators, files, colours, and regions.
//! - [`view`]: orthographic and perspective views.
//! - [`slabs`]: a grid of bits along the view, a column of 128 or 256 slices for each pixel. It can
//!   be used alone.
//! - [`cells`]: a grid of the world that names the segments near each cell, for rays.
//! - [`mesh`]: triangle meshes among the lines.
//! - [`buffers`]: the nearest line in each pixel.
//! - [`samples`]: blue-noise points that choose columns.
//! - [`places`] and [`directions`]: places along lines for rays that serve all views, and
//!   directions in 32 bits.
//! - [`occlusion`]: how much of the hemisphere above a line other lines hide.
//! - [`numeric`]: all margins and constants of the estimate, for twins on other processors.
//! - `gpu`, only with the feature `gpu`: the same as compute shaders, and culling of bundles of
//!   lines behind walls and meshes.
//!
//! Results are estimates, the same for any number of threads.

pub mod buffers;
pub mod cells;
pub mod directions;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod mesh;
pub mod numeric;
pub mod occlusion;
pub mod places;
pub mod samples;
pub mod sets;
pub mod slabs;
#[cfg(test)]
mod testing;
pub mod view;

/// The version of glam whose types these functions take and give.
pub use glam;

pub use sets::LineSet;
