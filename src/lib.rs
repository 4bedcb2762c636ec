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

mod derived;
mod error;
mod geometry;
mod grid;
mod id;
pub mod matrix;
mod mesh;
mod method;
mod numeric;
mod object;
mod occlusion;
mod pvs;
mod query;
pub mod reference;
mod scene;
mod shape;
mod view;
mod walk;

pub use derived::{AggressiveOpacity, DrawItem, DrawOptions, Light};
pub use error::{Error, FileError};
pub use geometry::{Aabb, Obb, Plane, Sphere};
pub use grid::run::CellRun;
pub use grid::{Grid, GridSpec, MAX_CELLS_PER_AXIS};
pub use id::ObjectId;
pub use mesh::{Facing, Instance, MeshOptions, TriMesh};
pub use method::{CellOptions, Method, PointOptions};
pub use object::{Bounds, Motion, ObjectDesc, Occluder, Reports};
pub use occlusion::image::OcclusionImage;
pub use pvs::{Pvs, PvsChanges, Stats};
pub use query::Query;
pub use scene::{FrameReport, MemoryUse, ObjectRef, Scene};
pub use shape::{Convex, MAX_CONVEX, Shape};
pub use view::{MAX_PLANES, View};

#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct Readme;
