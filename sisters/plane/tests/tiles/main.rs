//! Fields of view on tiles against exact visibility.

#[path = "../common/cases.rs"]
mod cases;
mod fog;
mod fov;
mod from_tile;
mod maps;
mod oracle;
mod point;
