//! casca for pages and Node, as WebAssembly: `.ci/web` makes the npm package `casca` of it, with
//! types for TypeScript. `README.md` shows how it is used.
//!
//! Boxes, spheres, transforms and points are numbers one after the other in a `Float32Array`; ids
//! of objects are bigints, and several of them a `BigUint64Array`. What cannot be used is refused
//! with an `Error` that says why, and changes nothing.
#![deny(missing_docs)]

mod arrays;
mod mesh;
mod plane;
mod query;
mod scene;
mod view;

pub use mesh::Mesh;
pub use plane::{field_of_view, visible_region};
pub use query::{KeptQuery, Query};
pub use scene::Scene;
pub use view::View;
