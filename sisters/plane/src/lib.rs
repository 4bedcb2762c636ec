//! Visibility in the plane: floor plans, tile maps, and what can be seen in them. What can be seen
//! is never left out.
//!
//! The planar twin of [casca](https://docs.rs/casca), with the same words.
//!
//! - [`FieldOfView`] finds the tiles that an eye sees on a map of [`OpaqueTiles`], exactly; [`Fog`]
//!   remembers them for a group of viewers.
//! - A [`Scene`] keeps objects of any [`Shape`] on a grid. A [`Query`] finds those that a [`View`]
//!   sees, exactly, and the visible region for light and fog ([`Query::polygon`]). It costs the
//!   objects and walls in sight. [`Scene::update`] costs the cells that an object touches.
//!
//! The walk is that of chapter 3.3 of H. C. Batagelo's thesis on visibility in dynamic scenes on a
//! regular grid (Unicamp 2002). The thesis' own method, the set of a whole cell by extended
//! occluders, with temporal bounding volumes, is in the example `cell`;
//! [`FieldOfView::run_from_tile`] is exact where that is not.

mod bits;
mod error;
mod geometry;
mod grid;
mod id;
mod numeric;
mod point;
mod pvs;
mod raster;
mod scene;
mod tiles;
mod view;

pub use bits::BitGrid;
pub use error::Error;
pub use geometry::{ConvexPolygon, DISC_SIDES, Disc, Polyline, Rect, Segment, Shape};
/// The version of glam whose types these functions take and give.
pub use glam;
pub use grid::{GridSpec, MAX_CELLS_PER_AXIS};
pub use id::ObjectId;
pub use point::{Query, visible_region};
pub use pvs::{Pvs, PvsChanges, Stats};
pub use scene::{ObjectDesc, Scene};
pub use tiles::{FieldOfView, Fog, FovOptions, OpaqueTiles, TileLayer, TilePoint, TileState};
pub use view::View;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
