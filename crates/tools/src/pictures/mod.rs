//! Charts of lines, and pictures with text.
//!
//! Charts are SVG: the reader's program sets their text. Pictures made of pixels are PNG. All
//! colours and marks are those of [`palette`].

mod lines;
pub mod palette;
pub mod raster;
pub mod svg;

use std::path::Path;

pub use lines::{Axis, Line, lines};

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
#[error("cannot draw {path}: {why}")]
pub struct PictureError {
    path: String,
    why: String,
}

impl PictureError {
    /// The picture at `path` was not made; the reason comes after.
    pub fn at(path: &Path) -> impl Fn(String) -> Self + '_ {
        move |why| Self { path: path.display().to_string(), why }
    }
}
