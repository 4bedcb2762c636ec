//! Visibility in the plane: floor plans, tile maps, and what can be seen in them.
//!
//! The planar twin of [casca](https://docs.rs/casca): the same words, and the same guarantee. What can be seen is never left out.

mod bits;
mod cell;
mod error;
mod geometry;
mod grid;
mod id;
#[cfg(feature = "maps")]
pub mod maps;
mod matrix;
mod method;
mod numeric;
mod object;
mod point;
mod pvs;
mod query;
mod raster;
mod scene;
mod solid;
mod tiles;
#[cfg(feature = "tiled")]
pub mod tmx;
mod view;
mod volume;

pub use bits::BitGrid;
pub use cell::{CellOptions, Fusion};
pub use error::Error;
pub use geometry::{ConvexPolygon, DISC_SIDES, Disc, Polyline, Rect, Segment, Shape};
pub use grid::{Grid, GridSpec, MAX_CELLS_PER_AXIS};
pub use id::ObjectId;
pub use method::Method;
pub use object::{Motion, ObjectDesc, Reports};
pub use pvs::{Pvs, PvsChanges, Stats};
pub use query::Query;
pub use scene::{FrameReport, Scene};
pub use tiles::{
    FieldOfView, Fog, FovOptions, OpaqueTiles, Side, TileError, TileFace, TileLayer, TilePoint, TileState,
    VisibleFaces,
};
pub use view::View;
