//! Test scenes for casca's tests, benches, laboratory and viewer. Nothing here is part of the
//! library's API.
//!
//! - [`world`]: test scenes: objects, their motion, a camera path.
//! - [`generated`]: the procedural scenes, seeded.
//! - [`import`]: scenes from glTF 2.0 files.
//! - [`export`]: such files, written.
//! - [`drive`]: a test scene put into the library, frame by frame.
//! - [`measure`]: what benches and the laboratory share.
//! - [`name`]: a scene on a command line, by its name or file.
//! - [`random`]: random numbers from a seed.

pub mod drive;
pub mod export;
pub mod generated;
pub mod import;
pub mod measure;
pub mod name;
mod numeric;
pub mod random;
pub mod world;
