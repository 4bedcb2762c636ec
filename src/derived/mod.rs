//! Answers drawn from a PVS: draw lists, shadow casters, the aggressive mode.

pub(crate) mod aggressive;
pub(crate) mod draw;
pub(crate) mod shadows;

pub use aggressive::AggressiveOpacity;
pub use draw::{DrawItem, DrawOptions};
pub use shadows::Light;
