//! Faults of a map that is read all the same.

use std::fmt;
use std::sync::Arc;

use super::objects::TmxFault;

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
    /// The property of a tile is not of the type `bool`.
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
    /// A layer is shifted by a part of a tile: its tiles lie on no others, and hide by the shapes
    /// only that their tilesets draw on them.
    Offset {
        /// The name of the layer.
        layer: String,
        /// By how many tiles to the right.
        x: f64,
        /// By how many tiles down.
        y: f64,
    },
    /// Something is amiss with an object that a tileset draws on a tile. There is one warning,
    /// wherever the tile stands.
    TileObject {
        /// The first tile of the tileset, as the map counts.
        first: u32,
        /// The number of the tile in the tileset.
        tile: u32,
        /// The number of the object on the tile; 0 if the file gives none.
        id: u32,
        /// The fault.
        fault: TmxFault,
    },
    /// Tiles before these brought more shapes than are kept: see
    /// [`TmxMap::tiles`](super::TmxMap::tiles). Those of these tiles are left out.
    ManyShapes {
        /// The name of the layer.
        layer: String,
        /// How many tiles of the layer they are.
        count: u64,
    },
    /// Something is amiss with an object.
    Object {
        /// Its number in the map; 0 if the file gives none.
        id: u32,
        /// The name of its layer.
        layer: Arc<str>,
        /// The fault.
        fault: TmxFault,
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
                "tile {tile} of the tileset from {first} on has a property {property} of the type {kind}, not bool"
            ),
            Self::Offset { layer, x, y } => {
                write!(f, "the layer {layer:?} is shifted by {x} and {y} tiles: only whole tiles are read")
            }
            Self::TileObject { first, tile, id, fault } => {
                write!(f, "the object {id} on tile {tile} of the tileset from {first} on: {fault}")
            }
            Self::ManyShapes { layer, count } => {
                write!(
                    f,
                    "the layer {layer:?} has {count} tiles whose shapes are left out: the map has too many"
                )
            }
            Self::Object { id, layer, fault } => write!(f, "the object {id} of the layer {layer:?}: {fault}"),
        }
    }
}
