//! Light with all of its bounces, by a radiosity cache: in a window or into pictures, and its time.

mod frame;
mod headless;
mod options;
mod picture;
mod renderer;
mod scene;
mod window;

#[cfg(test)]
mod tests;

pub use options::Options;
