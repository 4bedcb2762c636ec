//! Faults of a map that is read all the same.

use std::borrow::Cow;
use std::fmt;
use std::sync::Arc;

use crate::editor::{nothing_blocks, obstacles_block};

/// A part of a map that was passed over, so that it blocks no sight, or a fault of an object.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum TmxWarning {
    /// A layer has tiles that no tileset of the map has.
    UnknownTiles {
        /// The name of the layer.
        layer: String,
        /// The id of the first, without the bits that turn it.
        id: u32,
        /// How many tiles there are of this kind.
        count: u64,
    },
    /// A property of a tile that says whether it blocks is neither true nor false: it says nothing.
    PropertyType {
        /// The first tile of the tileset, as the map counts.
        first: u32,
        /// The number of the tile in the tileset.
        tile: u32,
        /// The name of the property.
        property: String,
        /// Its type: `string` if the file names none.
        kind: String,
    },
    /// Nothing in the map blocks sight, and it has no door.
    NothingBlocks {
        /// The layers, up to twelve.
        layers: Vec<String>,
        /// The properties and classes of tiles and objects, up to twelve.
        names: Vec<String>,
    },
    /// Nothing is a wall by [`MapNames::walls`](crate::MapNames::walls), so that
    /// [`MapNames::obstacles`](crate::MapNames::obstacles) count: it blocks sight.
    Obstacles {
        /// The names in the map that made walls.
        names: Vec<String>,
    },
    /// A list of tiles has commas without a number between them, or one at its end. Between them
    /// is no tile.
    Commas {
        /// The name of the layer.
        layer: String,
        /// How many numbers are missing.
        count: u64,
    },
    /// A file is neither UTF-8 nor UTF-16, and does not say that it is Latin-1, as which it was
    /// read.
    Encoding {
        /// "the map", or the path of a tileset as the map has it.
        file: String,
    },
    /// A layer is shifted by a part of a tile: its tiles lie on no others, and hide nothing.
    Offset {
        /// The name of the layer.
        layer: String,
        /// By how many tiles to the right.
        x: f64,
        /// By how many tiles down.
        y: f64,
    },
    /// Tiles of a layer would hide by the shapes that their tilesets draw on them ("Tile Collision
    /// Editor"). These are not read, and hide nothing.
    DrawnShapes {
        /// The name of the layer.
        layer: String,
        /// How many tiles there are of this kind.
        count: u64,
    },
    /// Objects of a layer are made of templates. These are not read, and hide nothing.
    Templates {
        /// The name of the layer.
        layer: String,
        /// How many objects there are of this kind.
        count: u64,
    },
    /// Something is amiss with an object.
    Object {
        /// Its number in the map; 0 if the file gives none.
        id: u32,
        /// The name of its layer.
        layer: Arc<str>,
        /// What is amiss, and whether it is left out. Texts from the file are cut to 40 characters.
        why: Cow<'static, str>,
    },
}

impl fmt::Display for TmxWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownTiles { layer, id, count } => {
                write!(f, "the layer {layer:?} has {count} tiles of no tileset, the first of id {id}")
            }
            Self::PropertyType { first, tile, property, kind } => write!(
                f,
                "tile {tile} of the tileset from {first} on has a property {property}, of the type {kind}, that is \
                 neither true nor false"
            ),
            Self::NothingBlocks { layers, names } => f.write_str(&nothing_blocks([layers, names])),
            Self::Obstacles { names } => f.write_str(&obstacles_block(names)),
            Self::Commas { layer, count } => {
                write!(f, "the layer {layer:?} has {count} commas without a number: no tile is read there")
            }
            Self::Encoding { file } => write!(
                f,
                "{file} is not in UTF-8: names in other letters than those of English may be wrong (save it as UTF-8)"
            ),
            Self::Offset { layer, x, y } => {
                write!(f, "the layer {layer:?} is shifted by {x} and {y} tiles: only whole tiles are read")
            }
            Self::DrawnShapes { layer, count } => write!(
                f,
                "the layer {layer:?} has {count} tiles that are walls or doors by shapes drawn on them: these hide nothing \
                 (give the tile a property \"opaque\", or draw an object)"
            ),
            Self::Templates { layer, count } => write!(
                f,
                "the layer {layer:?} has {count} objects of templates, which are not read (Detach in the editor)"
            ),
            Self::Object { id, layer, why } => write!(f, "the object {id} of the layer {layer:?}: {why}"),
        }
    }
}
