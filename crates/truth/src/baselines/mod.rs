//! The methods that engines use today, as a yardstick: a sampled depth buffer, tested by
//! rectangles. Fast code that one would ship, without casca's guarantee: what shows between the
//! samples is lost.
//!
//! - [`Hzb`]: triangles of occluders are rasterised front to back with pixel-centre sampling, and
//!   objects tested by their boxes on the way and at the end, against farthest depths of tiles and
//!   then pixels (Greene, Kass & Miller 1993; as in software occlusion culling of today's engines).
//!   All in f32 and in vectors.
//!
//! It is given the objects inside the frustum; finding those is not part of its time.

mod depth;
mod hzb;
mod models;
mod screen;
#[cfg(test)]
mod tests;

use depth::DepthPyramid;
pub use hzb::Hzb;
