//! Visibility on maps of square tiles.
//!
//! In the order of imports: [`TilePoint`] and [`FovOptions`] say who looks, and how far;
//! [`OpaqueTiles`] what blocks; [`FieldOfView`] finds the tiles that are seen; [`Fog`] remembers
//! them; [`TileLayer`] places tiles in a scene.

mod fog;
mod fov;
mod layer;
mod marks;
mod octant;
mod opaque;
mod options;
mod point;
mod ray;
mod scan;
mod sweep;
mod tile_sweep;
mod transpose;

pub use fog::{Fog, TileState};
pub use fov::FieldOfView;
pub use layer::TileLayer;
pub use opaque::OpaqueTiles;
pub use options::FovOptions;
pub use point::TilePoint;
