//! Why projects are refused, and the parts that are passed over.

use std::io;

use crate::editor::{nothing_blocks, obstacles_block};

/// Why a project was not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LdtkError {
    /// The file, or one that it names, cannot be read.
    #[error("{file} cannot be read: {why}")]
    File {
        /// Its path; that of a level as the project has it.
        file: String,
        /// The reason.
        why: io::Error,
    },
    /// A file is no JSON, or lacks a part that all projects have.
    #[error("{file}: {why}")]
    Damaged {
        /// "the project", or the path of a level as the project has it.
        file: String,
        /// The reason, with line and column.
        why: serde_json::Error,
    },
    /// A project that was opened by its path is refused.
    #[error("{file}: {why}")]
    In {
        /// The path.
        file: String,
        /// The reason.
        why: Box<LdtkError>,
    },
    /// Two levels are in one file.
    #[error("two levels name the file {0}")]
    Twice(String),
    /// A layer has another number of values than its columns and rows say.
    #[error("the layer {layer:?} of the level {level:?} has {found} values, but {width} by {height} tiles")]
    Values {
        /// The name of the level.
        level: String,
        /// The name of the layer.
        layer: String,
        /// How many values there are.
        found: usize,
        /// The columns of the layer.
        width: u32,
        /// The rows of the layer.
        height: u32,
    },
    /// A layer has tiles of no size.
    #[error("the layer {layer:?} of the level {level:?} has tiles of no size")]
    NoSize {
        /// The name of the level.
        level: String,
        /// The name of the layer.
        layer: String,
    },
    /// Levels have so many tiles that hardly one of them is in the file.
    #[error("the level {level:?} has {width} by {height} tiles, but hardly any of them are in the file")]
    Spread {
        /// The name of the level with which the levels became too large.
        level: String,
        /// Its columns.
        width: u64,
        /// Its rows.
        height: u64,
    },
}

/// Something that was passed over in a level, so that it blocks no sight.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LdtkWarning {
    /// Nothing in the level blocks sight, and it has no door.
    #[error("{}", nothing_blocks([layers, names], "Values, tags, entities and fields"))]
    NothingBlocks {
        /// The layers, up to twelve.
        layers: Vec<String>,
        /// The names of values, tags, entities and fields, up to twelve.
        names: Vec<String>,
    },
    /// Nothing in the project is a wall by [`MapNames::walls`](crate::MapNames::walls), so that
    /// [`MapNames::obstacles`](crate::MapNames::obstacles) count: it blocks sight.
    #[error("{}", obstacles_block(names))]
    Obstacles {
        /// The names in the level that made walls.
        names: Vec<String>,
    },
    /// A file of the project is neither UTF-8 nor UTF-16, and was read as Latin-1.
    #[error("the project is not in UTF-8: names in other letters than those of English may be wrong")]
    Encoding,
    /// The tiles of a layer do not lie on those of the finest layer that blocks. Only tiles of that
    /// layer block which they cover wholly, one by one.
    #[error(
        "the layer {layer:?} has tiles of {tile} pixels, shifted by {shift:?}: they do not fit those of {finest}"
    )]
    Uneven {
        /// The name of the layer.
        layer: String,
        /// The side of its tiles in pixels.
        tile: u32,
        /// Its shift in pixels.
        shift: [i32; 2],
        /// The side of the finest tiles that block in the level.
        finest: u32,
    },
    /// The tiles of a layer are more than 64 times as wide as the finest that block: they block
    /// nothing.
    #[error("the layer {layer:?} has tiles of {tile} pixels beside others of {finest}: they block nothing")]
    Coarse {
        /// The name of the layer.
        layer: String,
        /// The side of its tiles in pixels.
        tile: u32,
        /// The side of the finest tiles that block in the level.
        finest: u32,
    },
    /// A layer has values that its definition does not name.
    #[error("the layer {layer:?} has {count} values that its definition lacks, the first {value}")]
    UnknownValues {
        /// The name of the layer.
        layer: String,
        /// The first.
        value: i64,
        /// How many there are.
        count: usize,
    },
    /// An entity lies farther than 2^30 pixels away or has a negative size: it is left out.
    #[error("the entity {entity} of the layer {layer:?} lies too far away or has a negative size")]
    Far {
        /// The name of the entity.
        entity: String,
        /// The name of its layer.
        layer: String,
    },
}
