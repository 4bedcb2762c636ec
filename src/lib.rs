//! Visibility culling for dynamic 3D scenes on a regular grid: which objects can
//! be seen, every frame, without losing one that can.
//!
//! Data flows one way:
//! [`Scene`] (objects, and the [matrices](matrix) of the [grid](GridSpec)) ->
//! [`Query`] (the walk of one [`View`] over that grid) -> [`Pvs`] (what can be seen).
//!
//! The method is that of H. C. Batagelo's thesis on visibility in dynamic scenes
//! on a regular grid (Unicamp 2002), with the occlusion of its view cells restated as a
//! rule on the lattice of cells, which direction masks decide by a look-up each
//! ([`Method::Cell`]), and with the occluder fusion in image space that it names as future work
//! ([`Method::Point`]).
#![deny(missing_docs)]
#![forbid(unsafe_code)]

mod aggressive;
mod bricks;
mod cells;
mod cut;
mod draw;
mod error;
mod fused;
mod geometry;
mod grid;
mod mask;
pub mod matrix;
mod object;
mod occlusion;
mod outer;
mod pvs;
mod query;
pub mod reference;
mod scene;
mod shadows;
mod shape;
mod solids;
mod surface;
mod tbv;
mod view;
mod walk;

pub use aggressive::AggressiveOpacity;
pub use draw::{DrawItem, DrawOptions};
pub use error::{Error, FileError};
pub use geometry::{Aabb, Obb, Sphere};
pub use grid::{Grid, GridSpec, MAX_CELLS_PER_AXIS};
pub use object::{Motion, ObjectDesc, ObjectId, Reports};
pub use occlusion::OcclusionImage;
pub use pvs::{Pvs, Stats};
pub use query::{Method, Query, Settings};
pub use scene::{FrameReport, MemoryUse, Scene};
pub use shape::{
    Bounds, CellRun, Convex, Facing, Instance, MAX_CONVEX, Occluder, Preparation, Shape, TriMesh,
};
pub use view::{MAX_PLANES, Plane, View};

#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct Readme;
