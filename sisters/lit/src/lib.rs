//! glTF files as lit scenes for `casca-radiosity`: their materials, textures and lights.

mod file;
mod paint;

pub use file::{load_lit, read_lit};
