//! Triangle meshes, prepared to be tested and to hide others.

pub(crate) mod cells;
pub(crate) mod file;
pub(crate) mod index;
pub(crate) mod instance;
pub(crate) mod parts;
pub(crate) mod raster;
pub(crate) mod surface;
pub(crate) mod tri_mesh;

pub use instance::Instance;
pub use tri_mesh::{Facing, Preparation, TriMesh};
