//! Visibility culling for dynamic 3D scenes on a regular grid: which objects can
//! be seen, every frame, without losing one that can.
//!
//! Data flows one way:
//! [`Scene`] (objects, and the matrices of the [grid](GridSpec)) ->
//! [`Query`] (the walk of one [`View`] over that grid) -> [`Pvs`] (what can be seen).
//!
//! The method is that of H. C. Batagelo's thesis on visibility in dynamic scenes
//! on a regular grid (Unicamp 2002), with the occlusion of its view cells restated as a
//! rule on the lattice of cells, which direction masks decide by a look-up each
//! ([`Method::Cell`]), and with the occluder fusion in image space that it names as future work
//! ([`Method::Point`]).
//!
//! # Features
//!
//! None is on by default. These pages show the library with all of them.
//!
//! - `internals`: the module `internals` with the matrices, recorded cells and occlusion buffers, for pictures and tests.
//!   Its names may change in any release.
//! - `rayon`: `Query::run_all`, which runs the queries of several views in parallel.
#![deny(missing_docs)]
#![forbid(unsafe_code)]
// Some functions serve `internals` only. With all features, the lint finds those that serve nothing.
#![cfg_attr(not(feature = "internals"), allow(dead_code))]

mod derived;
mod error;
mod geometry;
mod grid;
mod id;
#[cfg(feature = "internals")]
pub mod internals;
mod matrix;
mod mesh;
mod method;
mod numeric;
mod object;
mod occlusion;
mod pvs;
mod query;
#[cfg(feature = "internals")]
mod reference;
mod scene;
mod shape;
mod view;
mod walk;

pub use derived::{AggressiveOpacity, DrawItem, DrawOptions};
pub use error::{Error, FileError};
pub use geometry::{Aabb, Obb, Plane, Sphere};
pub use grid::{Grid, GridSpec, MAX_CELLS_PER_AXIS};
pub use id::ObjectId;
pub use mesh::{Facing, Instance, MeshOptions, TriMesh};
pub use method::{CellOptions, Method, PointOptions};
pub use object::{Bounds, Motion, ObjectDesc, Occluder, Reports};
pub use pvs::{Pvs, PvsChanges, Stats};
pub use query::Query;
pub use scene::{FrameReport, MemoryUse, ObjectRef, Scene};
pub use shape::{Convex, MAX_CONVEX};
pub use view::{MAX_PLANES, View};

#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct Readme;
