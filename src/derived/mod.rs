//! Answers drawn from a PVS: draw lists, shadow casters, sets for networks.

pub(crate) mod draw;
pub(crate) mod shadows;

pub use draw::{DrawItem, DrawOptions};
pub use shadows::Light;
