//! Objects of maps: areas, walls, doors and places that were drawn over the tiles.

mod fault;
mod object;
mod place;
mod properties;
mod read;
mod shape;
#[cfg(test)]
mod tests;

pub use fault::TmxFault;
pub use object::TmxObject;
pub use properties::TmxValue;
pub(super) use read::ObjectLayer;
pub use shape::TmxShape;
