//! Levels of the editor [LDtk](https://ldtk.io) (`.ldtk` files): which of their tiles block sight,
//! and their entities.
//!
//! Read are layers of the kind IntGrid, tiles of all layers, and entities with their fields; also
//! levels in files of their own, and several worlds in one project. Memory follows the bytes of the
//! files and the bits of the result, whatever the files promise.

mod entity;
mod error;
mod import;
mod level;
mod project;
mod read;
#[cfg(test)]
mod tests;
mod walls;

pub use entity::{LdtkEntity, LdtkValue};
pub use error::{LdtkError, LdtkWarning};
pub use import::LdtkImport;
pub use level::LdtkLevel;
