//! The cell method and temporal bounding volumes, over frames, against rays that share no code with
//! the library.

#[path = "../common/cases.rs"]
mod cases;
mod frames;
mod point;
mod rays;
mod scenes;
