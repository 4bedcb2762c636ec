//! Visibility culling for dynamic 3D scenes on a regular grid: which objects can
//! be seen, every frame, without losing one that can.
//!
//! ```
//! use casca::glam::{Mat4, Vec3, Vec4};
//! use casca::{Aabb, ObjectDesc, Query, Scene, Sphere, View};
//! # fn main() -> Result<(), casca::Error> {
//! // A grid with cells of one metre.
//! let mut scene = Scene::new(1.0)?;
//! // Bounds are tested, occluders hide. Both may be spheres, boxes, convex solids or meshes.
//! let wall = Aabb::new(Vec3::new(0.0, 0.0, 30.0), Vec3::new(64.0, 16.0, 33.0));
//! scene.insert(ObjectDesc::fixed(wall).occluder(wall))?;
//! let bird = Sphere::new(Vec3::new(32.0, 4.0, 10.0), 0.3);
//! let bird_id = scene.insert(ObjectDesc::dynamic(bird).max_speed(12.0))?;
//! let mut query = Query::new();
//! let eye = Vec3::new(32.5, 2.5, 60.5);
//! // The matrix of your renderer. This one looks along -z, 60 degrees high and 16:9, with reversed depth from 0.1 m on.
//! let projection = Mat4::from_cols(Vec4::X * 0.974, Vec4::Y * 1.732, -Vec4::W, Vec4::Z * 0.1);
//! let matrix = projection * Mat4::from_translation(-eye);
//! for frame in 0..3 {
//!     scene.begin_frame(f64::from(frame) / 60.0)?;
//!     scene.update(bird_id, Sphere::new(bird.center + Vec3::X * frame as f32, bird.radius), None)?;
//!     let pvs = query.run(&scene, &View::perspective(eye, matrix)?);
//!     for id in pvs.visible() {
//!         // Draw the object of this id. They come roughly from near to far.
//!         assert_ne!(*id, bird_id, "the bird is behind the wall");
//!     }
//!     scene.end_frame([query.pvs()])?;
//! }
//! # Ok(())
//! # }
//! ```
//!
//! Data flows one way: [`Scene`] (objects, and the matrices of the [grid](Grid)) -> [`Query`]
//! (the walk of one [`View`] over that grid) -> [`Pvs`] (what can be seen). A [`KeptQuery`] answers
//! many frames of a camera that moves little from one such walk. A call "costs" what its time grows
//! with: one that costs the triangles takes time in proportion to their number.
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
//! - `internals`: the module `internals` with the matrices, recorded cells and occlusion buffers,
//!   for pictures and tests. Its names may change in any release.
//! - `serde`: options, shapes and descriptions of objects are read and written with
//!   [serde](https://serde.rs), see below.
//! - `rayon`: `Query::run_all`, which runs the queries of several views in parallel.
//!
//! # Versions of glam
//!
//! Vectors and matrices are those of [`glam`], 0.30.1 to 0.34, which is re-exported here. If a
//! program names a glam of its own, such as `glam = "0.33"`, cargo may pick two, and the compiler
//! says that types do not match. `cargo tree --duplicates --depth 0` lists both; this command makes
//! casca take the older one:
//!
//! ```sh
//! cargo update glam@0.34.2 --precise 0.33.12
//! ```
//!
//! # Storing
//!
//! With the feature `serde`, these are `Serialize` and `Deserialize`:
//!
//! - options ([`Method`], [`CellOptions`], [`PointOptions`], [`KeptOptions`], [`MeshOptions`],
//!   [`DrawOptions`]). Fields that a file lacks have their defaults, and fields that are not known
//!   are passed over, so that files of other versions are read. Ranges are checked where options
//!   are used, as by [`Query::set_method`];
//! - the size of cells, which [`Scene::new`] checks;
//! - shapes ([`Aabb`], [`Sphere`], [`Obb`], [`Plane`], [`Convex`]). Shapes that a scene would
//!   refuse are not read, and the error says why: those that are not finite, inverted, negative,
//!   flat or without direction. A convex solid is stored by its corners. Reading one makes its
//!   faces anew at the cost of [`Convex::from_points`], and may order its corners anew; it lies
//!   inside the solid stored;
//! - [`Bounds`], [`Occluder`], [`Motion`], [`Reports`] and [`ObjectDesc`]. A description that
//!   [`Scene::insert`] would refuse is neither written nor read.
//!
//! Meshes are left out: a [`TriMesh`] is shared by objects, and has a file format of its own
//! ([`TriMesh::write`]). To serialise bounds or occluders that are meshes or instances is an error.
//! Ids, scenes and results are not stored.
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
// Some functions serve `internals` only. With all features, the lint finds those that serve
// nothing.
#![cfg_attr(not(feature = "internals"), allow(dead_code))]

mod derived;
mod error;
mod geometry;
mod grid;
mod heap;
mod id;
#[cfg(feature = "internals")]
pub mod internals;
mod kept;
mod matrix;
mod mesh;
mod method;
mod numeric;
mod object;
mod occlusion;
mod pvs;
mod query;
#[cfg(test)]
mod random;
#[cfg(feature = "internals")]
mod reference;
mod scene;
mod shape;
mod simd;
mod view;
mod walk;

pub use derived::{DrawItem, DrawOptions, Light};
pub use error::{Error, FileError};
/// The version of glam whose types these functions take and give.
pub use glam;

pub use geometry::{Aabb, Obb, Plane, Sphere};
pub use grid::{Grid, cell_for};
pub use id::ObjectId;
pub use kept::{KeptJob, KeptOptions, KeptQuery, KeptResult};
pub use mesh::{Facing, Instance, MeshOptions, TriMesh};
pub use method::{CellOptions, Method, PointOptions};
pub use object::{Bounds, Motion, ObjectDesc, Occluder, Reports};
pub use pvs::{Pvs, PvsChanges, Stats};
pub use query::{CameraQuery, Query, Sight};
pub use scene::{FrameReport, MOST_NEW_VOLUMES, MemoryUse, ObjectRef, Scene};
pub use shape::{Convex, MAX_CONVEX};
pub use view::{MAX_PLANES, View};

#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct Readme;
