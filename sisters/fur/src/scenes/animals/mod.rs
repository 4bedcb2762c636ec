//! Generated animals: closed meshes with coats, so that fur needs no files.

mod animal;
mod body;
mod polygons;
mod rig;

pub use animal::{Animal, LEVELS};
pub use rig::Rig;
