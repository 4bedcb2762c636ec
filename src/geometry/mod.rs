//! Geometry that knows neither grid nor scene.

pub(crate) mod aspect;
pub(crate) mod block;
pub(crate) mod body;
pub(crate) mod clip;
pub(crate) mod offset;
pub(crate) mod placement;
pub(crate) mod plane;
pub(crate) mod polytope;
pub(crate) mod primitives;
pub(crate) mod room;
#[cfg(feature = "serde")]
mod stored;

pub(crate) use block::Block;
pub use plane::Plane;
pub use primitives::{Aabb, Obb, Sphere};
pub(crate) use room::Room;
