//! Point clouds: the points that an eye can see, clouds from files, and clouds larger than memory.
//!
//! Points hide nothing by themselves. They are taken as samples of a surface that nobody knows, so
//! every answer here is an estimate, and none is conservative. Two kinds of errors are counted
//! apart: a *false visible* point is reported though the surface hides it, a *false hidden* point
//! is left out though it can be seen.
//!
//! - [`surface`]: rays between discs that stand for the surface around points; the fewest errors,
//!   and [`visible`] in one call.
//! - [`hpr`]: hidden point removal: points are turned inside out around the eye, and those on their
//!   convex hull are visible.
//! - [`splat`]: points are drawn as squares into a depth image of a [`Camera`], and those behind it
//!   are hidden.
//! - [`spacing`]: the size of these squares from the distances between neighbouring points.
//!
//! The features `files`, `bricks` and `gpu` add the modules of these names; none is on by default.

mod auto;
#[cfg(feature = "bricks")]
pub mod bricks;
mod camera;
mod cloud;
#[cfg(feature = "files")]
pub mod files;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod hpr;
mod hull;
mod numeric;
#[cfg(test)]
mod samples;
pub mod spacing;
pub mod splat;
pub mod surface;

/// The version of glam whose types these functions take and give.
pub use glam;

pub use auto::AutoSettings;
pub use camera::{Camera, CameraError, MAX_PIXELS, MAX_SIDE, Projected};
pub use cloud::{LengthError, PointCloud};
pub use surface::visible;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
