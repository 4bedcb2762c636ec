//! Dense sets of lines with ambient occlusion, in a window or into pictures, and the time of each
//! stage.

mod headless;
mod legend;
mod options;
mod source;
mod times;
mod window;

pub use options::Options;
