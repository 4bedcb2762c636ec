//! What the programs around casca share. Nothing here knows the library, a device or a window.
//!
//! - [`animation`]: pictures in a row, as one animated PNG.
//! - [`camera`]: an eye and its matrices.
//! - [`command_line`]: exit codes, folders and files that are tried before the work.
//! - [`image`]: sizes, halves and PNG files of pictures.
//! - `pictures`: charts as SVG, and pictures with text; with the feature `charts`.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

pub mod animation;
pub mod camera;
pub mod command_line;
pub mod image;
#[cfg(feature = "charts")]
pub mod pictures;
