//! Visibility in the plane: floor plans, tile maps, and what can be seen in them.
//!
//! The planar twin of [casca](https://docs.rs/casca): the same words, and the same guarantee. What can be seen is never left out.

mod bits;
#[cfg(feature = "maps")]
pub mod maps;
mod numeric;
mod tiles;
#[cfg(feature = "tiled")]
pub mod tmx;

pub use bits::BitGrid;
pub use tiles::{
    FieldOfView, Fog, FovOptions, OpaqueTiles, Side, TileError, TileFace, TileLayer, TilePoint, TileState,
    VisibleFaces,
};
