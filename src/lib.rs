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
//! - `serde`: options, shapes and descriptions of objects are read and written with [serde](https://serde.rs), see below.
//! - `rayon`: `Query::run_all`, which runs the queries of several views in parallel.
//!
//! # Storing
//!
//! With the feature `serde`, these are `Serialize` and `Deserialize`:
//!
//! - options ([`Method`], [`CellOptions`], [`PointOptions`], [`MeshOptions`], [`DrawOptions`]). Fields that a file lacks have
//!   their defaults, and fields that are not known are passed over, so that files of other versions are read. Ranges are
//!   checked where options are used, as by [`Query::set_method`];
//! - the [grid](GridSpec), which [`Scene::new`] checks;
//! - shapes ([`Aabb`], [`Sphere`], [`Obb`], [`Plane`], [`Convex`]). Shapes that a scene would refuse are not read, and
//!   the error says why: those that are not finite, inverted, negative, flat or without direction. A convex solid is stored
//!   by its corners. Reading one makes its faces anew at the cost of [`Convex::from_points`], and may order its corners
//!   anew; it lies inside the solid stored;
//! - [`Bounds`], [`Occluder`], [`Motion`], [`Reports`] and [`ObjectDesc`]. A description that [`Scene::insert`] would refuse is
//!   neither written nor read.
//!
//! Meshes are left out: a [`TriMesh`] is shared by objects, and has a file format of its own ([`TriMesh::write`]). To
//! serialise bounds or occluders that are meshes or instances is an error. Ids, scenes and results are not stored.
//!
//! ```
//! # #[cfg(feature = "serde")] {
//! use casca::{Method, ObjectDesc, PointOptions};
//!
//! # fn main() -> Result<(), serde_json::Error> {
//! let wall: ObjectDesc = serde_json::from_str(
//!     r#"{
//!         "bounds": { "box": { "min": [0, 0, 30], "max": [64, 16, 33] } },
//!         "occluder": { "box": { "min": [0, 0, 30], "max": [64, 16, 33] } },
//!         "motion": "static"
//!     }"#,
//! )?;
//! let method: Method = serde_json::from_str(r#"{ "point": { "pixel_degrees": 0.1 } }"#)?;
//! assert_eq!(method, Method::Point(PointOptions::new().pixel_degrees(0.1)));
//! # let _ = wall;
//! # Ok(())
//! # }
//! # main().unwrap();
//! # }
//! ```
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

pub use derived::{AggressiveOpacity, DrawItem, DrawOptions, Light};
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
