//! Visibility in the plane: floor plans, tile maps, and what can be seen in them. What can be seen
//! is never left out.
//!
//! The planar twin of [casca](https://docs.rs/casca), with the same words.
//!
//! # Tiles
//!
//! [`FieldOfView`] finds the tiles that an eye sees on a map of [`OpaqueTiles`], exactly; [`Fog`]
//! remembers them for a group of viewers. [`VisibleFaces`] gives the sides of walls in sight.
//!
//! ```
//! use casca_plane::{BitGrid, FieldOfView, FovOptions, OpaqueTiles, TilePoint};
//!
//! let mut walls = BitGrid::new(16, 8);
//! walls.fill(4, 0..12);
//! let mut fov = FieldOfView::new();
//! let seen = fov.run(&OpaqueTiles::new(walls), TilePoint::center_of(3, 2), &FovOptions::default());
//! assert!(seen.get(3, 4) && !seen.get(3, 6), "the wall is seen, and no tile behind it");
//! ```
//!
//! # Objects
//!
//! A [`Scene`] keeps objects of any [`Shape`] on a grid, fixed or moving. A [`Query`] finds those
//! that a [`View`] sees, by a [`Method`]:
//!
//! | method | finds | cost |
//! |---|---|---|
//! | [`Method::Point`] (default) | the objects that the eye sees, exactly, and the visible region ([`Query::polygon`]) | the objects and walls in sight |
//! | [`Method::Cell`] | the objects that can be seen from anywhere in the eye's cell | the cells in sight, 64 at a time |
//! | [`Method::Sector`] | the objects in the view, hidden or not | all objects |
//!
//! A frame: [`Scene::begin_frame`], [`Scene::update`] for the objects that moved, queries,
//! [`Scene::end_frame`] with their results. Moving objects that nobody sees get temporal bounding
//! volumes, and queries do not test them until these come into sight or expire.
//!
//! The method is that of chapter 3.3 of H. C. Batagelo's thesis on visibility in dynamic scenes on
//! a regular grid (Unicamp 2002), with the exact methods added.
//!
//! # Features
//!
//! - `serde`: [`BitGrid`], [`GridSpec`], [`Shape`]s, [`Motion`], [`Method`] and [`CellOptions`] can
//!   be stored.
//! - `maps`: the module `maps`, with maps from seeds and a small one of a harbour.
//! - `ldtk`: the module `ldtk`, which reads projects of the editor LDtk.
//! - `tiled`: the module `tmx`, which reads maps of the editor Tiled.

mod bits;
mod cell;
mod cover;
#[cfg(any(feature = "ldtk", feature = "tiled"))]
mod editor;
mod error;
#[cfg(any(feature = "ldtk", feature = "maps", feature = "tiled"))]
mod files;
mod geometry;
mod grid;
mod id;
#[cfg(feature = "ldtk")]
pub mod ldtk;
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
#[cfg(any(feature = "ldtk", feature = "tiled"))]
pub use editor::{MapNames, Placed, Role};
pub use error::Error;
pub use geometry::{ConvexPolygon, DISC_SIDES, Disc, MAX_SPLIT_CORNERS, Polyline, Rect, Segment, Shape};
/// The version of glam whose types these functions take and give.
pub use glam;

pub use grid::{Grid, GridSpec, MAX_CELLS_PER_AXIS};
pub use id::ObjectId;
pub use method::Method;
pub use object::{Motion, ObjectDesc, Reports};
pub use pvs::{Pvs, PvsChanges, Stats};
pub use query::{Query, visible_region};
pub use scene::{FrameReport, Scene, TileDoor};
pub use tiles::{
    FieldOfView, Fog, FovOptions, OpaqueTiles, Side, SymmetricFov, TileError, TileFace, TileLayer, TilePoint,
    TileState, VisibleFaces,
};
pub use view::View;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
