//! Fields of view on tiles against exact visibility.

mod faces;
mod fog;
mod fov;
mod maps;
mod oracle;
