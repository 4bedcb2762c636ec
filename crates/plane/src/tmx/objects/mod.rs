//! Objects of maps: areas, walls, doors and places that were drawn over the tiles.

mod draft;
mod fault;
mod object;
mod place;
mod properties;
mod read;
mod shape;
mod template;
#[cfg(test)]
mod template_tests;
#[cfg(test)]
mod tests;

pub use fault::TmxFault;
pub use object::TmxObject;
pub use properties::TmxValue;
pub(super) use read::ObjectLayer;
pub use shape::TmxShape;
pub(super) use template::{Template, Templates};
