//! The cell method and temporal bounding volumes, over frames, against rays that share no code with the library.

#[path = "../common/cases.rs"]
mod cases;
mod frames;
mod rays;
mod scenes;
