//! Parts that maps of all editors share: which objects hide, how they get into scenes, files.

mod placed;
mod role;

use std::io;
use std::path::Path;

pub use placed::Placed;
pub use role::Role;

/// The bytes of a file. Pipes and devices are not opened: they may have no end.
pub(crate) fn file(path: &Path) -> io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::Error::other("is no file"));
    }
    std::fs::read(path)
}

/// Tiles of a rectangle around all layers, for each tile that a file names, at most. Else two tiles
/// far apart would take any memory.
pub(crate) const MOST_EMPTY: u64 = 4;

/// Coordinates in tiles, at most.
pub(crate) const FARTHEST: i64 = 1 << 30;
