//! The plane: what an eye sees on a map with guards, in a window or into a picture.

mod draw;
mod level;
mod options;
mod window;

pub use options::Options;
