//! Fields of view on tiles against exact visibility.

mod fov;
mod maps;
mod oracle;
