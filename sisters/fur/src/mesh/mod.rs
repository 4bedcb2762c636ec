//! Preparation of meshes: triangle lists become indexed meshes that are cheap to draw many times.
//!
//! The steps, after chapter 4 of the thesis: [`center`], [`continuous_normals`], [`weld`],
//! [`Mesh::ordered`]; or all by [`prepare`].

mod levels;
mod normals;
mod order;
mod types;
mod weld;

pub use normals::continuous_normals;
pub use types::{Coat, Mesh, Vertex};
pub use weld::{Placing, center, prepare, weld};
