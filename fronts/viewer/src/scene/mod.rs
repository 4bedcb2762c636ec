//! Scenes: draws exactly the objects that casca finds visible, in a window or into pictures, and
//! proves pixel by pixel that none is missing.
//!
//! How casca is wired into a render loop is in [`frame_loop`].

pub mod birds_eye;
pub mod camera_fit;
pub mod draw;
pub mod frame_loop;
pub mod geometry;
pub mod headless;
pub mod legend;
mod options;
pub mod overlays;
pub mod panel;
pub mod playback;
pub mod proof;
pub mod renderer;
pub mod role;
pub mod window;

pub use options::Options;
