//! Visibility on maps of square tiles.
//!
//! In the order of imports: [`TilePoint`] and [`FovOptions`] say who looks, and how far;
//! [`OpaqueTiles`] what blocks; [`FieldOfView`] finds the tiles that are seen; [`Fog`] remembers
//! them; [`TileLayer`] places tiles in a scene.

mod fog;
mod fov;
mod octant;
mod opaque;
mod options;
mod sweep;
mod tile_sweep;

pub use fog::{Fog, TileState};
pub use fov::FieldOfView;
pub use opaque::{OpaqueTiles, TileLayer};
pub use options::{FovOptions, TilePoint};
