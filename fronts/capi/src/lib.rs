//! The C ABI of casca. `include/casca.h` is its manual, and is made from these sources.
//!
//! Handles are numbers (`handle.rs`), all pointers of the caller's go through `border.rs`, and the
//! body of each function runs inside `error::call`, which no panic leaves.
//!
//! For Rust there is the crate `casca` itself. The functions here are unsafe to call as C
//! functions are: their pointers must lead to as much memory as their comments say.
#![deny(missing_docs)]
// The names are those of C.
#![allow(non_camel_case_types)]
// The manual states the one promise that callers make, for all functions.
#![allow(clippy::missing_safety_doc)]

mod border;
mod error;
mod frame;
mod handle;
mod job;
mod mesh;
mod plane;
mod plane_query;
mod query;
mod scene;
mod shape;
mod sight;
mod version;
mod view;

pub use error::*;
pub use frame::*;
pub use job::*;
pub use mesh::*;
pub use plane::*;
pub use plane_query::*;
pub use query::*;
pub use scene::*;
pub use shape::*;
pub use sight::*;
pub use version::*;
pub use view::*;
