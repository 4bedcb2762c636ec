//! Fields of view on tiles against exact visibility.

#[path = "../common/mod.rs"]
#[allow(dead_code)]
mod common;
mod faces;
mod fog;
mod fov;
mod maps;
mod oracle;
