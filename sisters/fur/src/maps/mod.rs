//! The fur maps of the thesis, for comparison with [`crate::strands`]: textures with hairs as
//! opaque texels, looked up by direction.
//!
//! The lookups have seams and stretched places, and [`fur_direction`] has singularities; strands by
//! hashed cells have none of these.

mod lookup;
mod texture;

pub use lookup::{CubePlace, cube_direction, cube_uv, fur_direction, fur_direction_or_normal};
pub use texture::{FurMap, Neighborhood, blue_noise, fur_map};
