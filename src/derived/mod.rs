//! Answers drawn from a PVS: draw lists, shadow casters, sets for networks, the aggressive mode.

pub(crate) mod aggressive;
pub(crate) mod draw;
pub(crate) mod shadows;

pub use aggressive::AggressiveOpacity;
pub use draw::{DrawItem, DrawOptions};
pub use shadows::Light;
