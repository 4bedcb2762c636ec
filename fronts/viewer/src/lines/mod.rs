//! Dense sets of lines with ambient occlusion, in a window or into pictures, and the time of each
//! stage.

mod context;
mod headless;
mod legend;
mod options;
mod run;
mod source;
mod times;
mod window;

pub use options::Options;
