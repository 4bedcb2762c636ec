//! Why maps are refused.

use std::io;

/// Why a map was not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TmxError {
    /// The file, or one that it names, cannot be read.
    #[error("{file} cannot be read: {why}")]
    File {
        /// Its path; that of a tileset as the map has it.
        file: String,
        /// The reason.
        why: io::Error,
    },
    /// A map that was opened by its path is refused.
    #[error("{file}: {why}")]
    In {
        /// The path.
        file: String,
        /// The reason.
        why: Box<TmxError>,
    },
    /// Layers or chunks lie so far apart, or so far away, that hardly a tile of the rectangle
    /// around them is theirs.
    #[error("the layers are spread over {width} by {height} tiles, but have {tiles} only")]
    Spread {
        /// The columns of the rectangle.
        width: u64,
        /// The rows of the rectangle.
        height: u64,
        /// The tiles of all layers.
        tiles: u64,
    },
    /// The map's tiles are no squares in rows and columns.
    #[error("the map is {0}, but only orthogonal and isometric maps have rows and columns of squares")]
    Orientation(String),
    /// The map has no layer of tiles.
    #[error("the map has no layer of tiles and no objects")]
    NoTiles,
    /// The dimensions of a layer are not those of the map.
    #[error("the layer {layer:?} has {found_width} by {found_height} tiles, but the map {width} by {height}")]
    Dimensions {
        /// The name of the layer.
        layer: String,
        /// The columns of the layer.
        found_width: u32,
        /// The rows of the layer.
        found_height: u32,
        /// The columns of the map.
        width: u32,
        /// The rows of the map.
        height: u32,
    },
    /// A file is no XML, lacks something, or its contents do not fit together; a layer has fewer
    /// tiles than its dimensions say, for example.
    #[error("{file}, line {line}: {why}")]
    Damaged {
        /// "the map", or the path of a tileset as the map has it.
        file: String,
        /// The line up to which the file was read, from 1.
        line: usize,
        /// What is wrong.
        why: String,
    },
}
