//! Ambient occlusion for dense sets of lines: streamlines, hair, wires. Where thousands of lines
//! cross, nobody can tell which is in front; darkening lines by the lines around them shows it.
//!
//! After L. de P. B. Benevides, *Oclusão de ambiente para renderização de linhas* (ambient
//! occlusion for the rendering of lines; master's thesis, PUC-Rio 2015), but by rays through a grid
//! of the lines; the example `thesis` has the columns of the source. Lines may move in every frame.
//!
//! - [`sets`]: sets of polylines, seeded generators, files, colours, and regions.
//! - [`view`]: orthographic and perspective views.
//! - [`buffers`]: the nearest line in each pixel; [`walk`]: the pixels that a segment crosses.
//! - [`cells`]: a grid of the world that names the segments near each cell, for rays.
//! - [`places`] and [`directions`]: places along lines for rays that serve all views, and
//!   directions in 32 bits.
//! - [`samples`]: points in the unit disc, for directions of rays.
//! - [`occlusion`]: how much of the hemisphere above a line other lines hide.
//! - [`mesh`]: triangle meshes among the lines.
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
#[cfg(test)]
mod testing;
pub mod view;
pub mod walk;

/// The version of glam whose types these functions take and give.
pub use glam;

pub use sets::LineSet;
