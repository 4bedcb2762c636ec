//! How solids become cells (thesis, sections 3.3.1 and 3.4.1).
//!
//! *Touched* cells are a superset of the cells that contain a point of the shape: every point lies
//! in at least one of them. *Opaque* cells are a subset of the cells wholly inside the solid. A new
//! kind of bounds or occluders implements [`Shape`] and [`kind::Kind`] in a file of its own, and
//! becomes a variant of the enums in `object`.

mod aabb;
pub(crate) mod convex;
mod filter;
pub(crate) mod kind;
mod obb;
pub(crate) mod pieces;
mod sphere;
mod traits;

pub use convex::{Convex, MAX_CONVEX};
pub use traits::{Shape, Which};
