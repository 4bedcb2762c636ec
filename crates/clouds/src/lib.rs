//! Point clouds from files, and clouds larger than memory.
//!
//! - [`PointCloud`]: points with their colours, normals and radii.
//! - [`files`]: clouds from PLY, LAS, LAZ, E57 and surfel files, in chunks.
//! - [`bricks`]: clouds larger than memory, culled by `casca` and loaded as far as a picture needs them.

pub mod bricks;
mod cloud;
pub mod files;
mod numeric;
// Points and configurations that the tests of these crates share.
#[cfg(test)]
#[path = "../../points/src/samples.rs"]
mod samples;

/// The version of glam whose types these functions take and give.
pub use glam;

pub use cloud::{LengthError, PointCloud};
