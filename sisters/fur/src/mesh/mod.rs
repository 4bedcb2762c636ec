//! Preparation of meshes: triangle lists become indexed meshes that are cheap to draw many times.
//!
//! The steps, after chapter 4 of the thesis: [`center`], [`continuous_normals`], [`weld`],
//! [`Mesh::ordered`]; or all by [`prepare`].
//!
//! ```
//! use casca_fur::mesh::prepare;
//! use glam::Vec3;
//!
//! # fn main() -> Result<(), casca_fur::Error> {
//! let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
//! let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
//! let (mesh, placing) = prepare(&corners, &[], &faces)?;
//! assert_eq!((mesh.vertices().len(), mesh.open_edges()), (4, 0));
//! assert!((placing.aabb_radius - 0.75f32.sqrt()).abs() < 1e-6);
//! # Ok(())
//! # }
//! ```

mod center;
mod image;
mod levels;
mod normals;
mod order;
mod types;
mod weld;

pub use center::{Placing, center};
pub use image::{Image, TexCoord, Wrap};
pub use levels::Level;
pub use normals::continuous_normals;
pub use types::{Coat, Mesh, Vertex};
pub use weld::{prepare, weld, weld_textured};
