//! Test scenes for casca's tests, benches, laboratory and viewer. Nothing here is part of the
//! library's API.
//!
//! - [`world`]: test scenes: objects, their motion, a camera path.
//! - [`generated`]: the procedural scenes, seeded.
//! - [`import`]: scenes from glTF 2.0 files.
//! - [`export`]: scenes written as such files.
//! - [`lit`]: scenes with materials and lights.
//! - [`drive`]: a test scene put into the library, frame by frame.
//! - [`measure`]: what benches and the laboratory share.
//! - [`path_error`]: files and folders that cannot be had.
//! - [`random`]: random numbers from a seed.

pub mod drive;
pub mod export;
pub mod generated;
pub mod import;
pub mod lit;
pub mod measure;
mod numeric;
pub mod path_error;
pub mod random;
pub mod world;
