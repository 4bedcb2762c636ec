//! What names in maps of editors say: what hides.

pub(crate) mod names;

pub use names::MapNames;
pub(crate) use names::{Inventory, Rule, Says, nothing_blocks, obstacles_block, truth};

/// Whether an object of a map hides what is behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Role {
    /// It hides nothing.
    #[default]
    Plain,
    /// It hides.
    Wall,
    /// It hides until it is opened.
    Door,
}

/// Tiles of a rectangle around all layers, for each tile that a file names, at most. Else two tiles
/// far apart would take any memory.
pub(crate) const MOST_EMPTY: u64 = 4;

/// Coordinates in tiles, at most.
pub(crate) const FARTHEST: i64 = 1 << 30;
