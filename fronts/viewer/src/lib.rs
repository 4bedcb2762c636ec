//! The viewer: casca and the systems around it, each in a window or in pictures.
//!
//! - [`scene`]: draws exactly the objects that casca finds visible, and proves pixel by pixel that
//!   none is missing.
//! - `plane`: what an eye sees on a map.
//! - `points`: the points of a cloud that an eye can see.
//! - `light`: light that bounces, by voxels.
//! - `lines`: dense sets of lines, and their occlusion.
//! - `fur`: fur in layers, and what visibility saves on it.
//! - [`systems`]: their names, and the windows that they open.
//! - `common`: what all share.
//!
//! How casca is wired into a render loop is in `scene::frame_loop`. What is public serves the program,
//! its page and the tests.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

mod common;
mod fur;
mod light;
mod lines;
mod plane;
mod points;
pub mod scene;
pub mod systems;
