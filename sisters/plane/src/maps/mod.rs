//! Maps for tests, benches and examples: floor plans, caves and open fields from a seed, and a
//! small map that comes with the crate.
//!
//! One seed always gives the same map.

mod caves;
mod drawing;
mod fields;
mod file;
mod rooms;

pub use drawing::{Drawing, HARBOUR};
pub use file::MapError;
pub use rooms::FloorPlan;

use crate::bits::BitGrid;

/// A kind of map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MapKind {
    /// Floor plans: rooms and corridors between walls of one tile, with doors of one tile.
    Rooms,
    /// Caves, from a cellular automaton.
    Caves,
    /// Open ground with rocks of one to five tiles.
    Fields,
}

impl MapKind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Rooms, Self::Caves, Self::Fields];

    /// The name of the kind: `"rooms"`, `"caves"` or `"fields"`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rooms => "rooms",
            Self::Caves => "caves",
            Self::Fields => "fields",
        }
    }

    /// The opaque tiles of a map of this kind. Costs some nanoseconds a tile.
    pub fn generate(self, width: u32, height: u32, seed: u64) -> BitGrid {
        match self {
            Self::Rooms => rooms::rooms(width, height, seed).walls,
            Self::Caves => caves::caves(width, height, seed),
            Self::Fields => fields::fields(width, height, seed),
        }
    }
}

#[cfg(test)]
mod tests;
