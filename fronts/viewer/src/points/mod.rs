//! Point clouds: which points of them can be seen, in a window, in pictures and in files.

mod house;
mod large;
mod operators;
mod options;
mod panes;
mod view;

pub use options::Options;
