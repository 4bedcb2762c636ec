//! Fields of view on tiles against exact visibility.

#[path = "../common/cases.rs"]
mod cases;
mod faces;
mod fog;
mod fov;
mod maps;
mod oracle;
