//! Triangle meshes, prepared to be tested and to hide others.

mod around;
pub(crate) mod cells;
mod convex;
mod file;
mod index;
pub(crate) mod inner;
mod instance;
mod lists;
mod parts;
mod preparation;
mod raster;
mod shell;
mod solid;
pub(crate) mod surface;
#[cfg(test)]
mod tests;
mod tri_mesh;
mod triangle;

pub use instance::Instance;
pub use preparation::{Facing, MeshOptions};
pub use tri_mesh::TriMesh;
