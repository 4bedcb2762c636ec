//! The cache on the processor: beside closed forms, behind walls, after moves, and on bad input.

mod closed;
#[path = "../common/mod.rs"]
mod common;
mod flush;
mod lattice;
mod moves;
mod open;
mod parts;
mod smooth;
mod sound;
mod textures;
mod walls;
mod windows;
