//! Test scenes, exact visibility and pictures for casca's examples, tests,
//! benches and fuzz targets. Nothing here is part of the library's API.
//!
//! - [`world`]: what a test scene is: objects, their motion, a camera path.
//! - [`scenes`]: the procedural scenes, seeded.
//! - [`import`]: scenes from glTF 2.0 binary files.
//! - [`oracle`]: exact visibility, which shares no code with the library.
//! - [`drive`]: a test scene put into the library, frame by frame.
//! - [`pictures`]: charts and views from above.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

pub mod drive;
pub mod import;
pub mod oracle;
pub mod pictures;
pub mod scenes;
pub mod world;
