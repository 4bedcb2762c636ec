//! Objects as the application describes them.

pub(crate) mod cells;
pub(crate) mod desc;
pub(crate) mod kinds;

pub use desc::{Motion, ObjectDesc, Reports};
pub use kinds::{Bounds, Occluder};
