//! Fields of view on tiles against exact visibility.

mod cases;
mod cell;
mod exact;
mod fog;
mod fov;
mod from_tile;
mod maps;
mod oracle;
mod point;
