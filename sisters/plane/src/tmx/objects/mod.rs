//! Objects of maps: areas, walls, doors and places that were drawn over the tiles.

mod brought;
mod draft;
mod drawn;
mod fault;
mod object;
mod place;
mod properties;
mod read;
mod role;
mod shape;
mod template;
#[cfg(test)]
mod template_tests;
#[cfg(test)]
mod tests;

pub(super) use brought::{DrawnTiles, Standing};
pub(super) use drawn::Drawn;
pub use fault::TmxFault;
pub use object::TmxObject;
pub(super) use place::parts;
pub use properties::TmxValue;
pub(super) use read::ObjectLayer;
pub(super) use role::Roles;
pub use shape::TmxShape;
pub(super) use template::{Template, Templates};
