//! Objects as the application describes them.

mod bounds;
mod desc;
mod kinds;
mod occluder;
mod placed;
mod shifted;
#[cfg(feature = "serde")]
mod stored;
mod union;

pub use bounds::Bounds;
pub(crate) use desc::{ALL_LAYERS, check_pair};
pub use desc::{Motion, ObjectDesc, Reports};
pub use occluder::Occluder;
pub(crate) use placed::{Placed, instances_at, transform_of_instances};
pub(crate) use union::union_contains;
