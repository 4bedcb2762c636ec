//! Parts that maps of all editors share: which objects hide, and how they get into scenes.

pub(crate) mod names;
mod placed;
mod role;

pub use names::MapNames;
pub(crate) use names::{Inventory, Rule, Says, nothing_blocks, obstacles_block, truth};
pub use placed::Placed;
pub use role::Role;

/// Tiles of a rectangle around all layers, for each tile that a file names, at most. Else two tiles
/// far apart would take any memory.
pub(crate) const MOST_EMPTY: u64 = 4;

/// Coordinates in tiles, at most.
pub(crate) const FARTHEST: i64 = 1 << 30;
