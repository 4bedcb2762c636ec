//! No shadow on what can be seen is ever lost: with the casters found alone, every light ray that
//! something blocks stays blocked. Judged by exact rays, which share no code with the library.

#[path = "../common/mod.rs"]
mod common;

mod cases;
mod exact;
mod lights;
mod masks;
mod scenes;
