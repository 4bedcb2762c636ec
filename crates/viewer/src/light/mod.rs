//! Light that bounces, in a window or into pictures, and its time.

mod cached;
mod controls;
mod headless;
mod options;
mod run;
mod scene;
mod stages;
mod window;

pub use options::Options;
