//! Visibility on maps of square tiles.
//!
//! In the order of imports: [`TilePoint`] and [`FovOptions`] say who looks, and how far; [`OpaqueTiles`] what blocks;
//! [`FieldOfView`] finds the tiles that are seen.

mod error;
mod fov;
mod octant;
mod opaque;
mod options;
mod point;
mod scan;
mod sweep;
mod transpose;

pub use error::TileError;
pub use fov::FieldOfView;
pub use opaque::OpaqueTiles;
pub use options::FovOptions;
pub use point::TilePoint;
