//! A map, as it is read.

use glam::{IVec2, Vec2};

use super::objects::TmxObject;
use super::tile::TmxTile;
use super::warning::TmxWarning;
use crate::bits::BitGrid;
use crate::editor::Role;
use crate::tiles::{TileError, TileLayer};

/// The tiles of a map that block sight, its objects, and warnings about the map: see
/// [`TmxImport::read_map`](super::TmxImport::read_map).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TmxMap {
    /// The tiles that block.
    pub walls: BitGrid,
    /// The column and the row, as the editor counts them, of the tile `(0, 0)` of `walls`.
    pub origin: IVec2,
    /// The objects of all layers, in the order of the file. Texts are left out.
    pub objects: Vec<TmxObject>,
    /// Tiles on which tilesets draw shapes that hide, in the order of the file. So that a small
    /// file cannot make many, tiles and the corners of their shapes are together at most 2^20 and
    /// two for each byte of the map; the others are left out, with a warning.
    pub tiles: Vec<TmxTile>,
    /// What was passed over. Nothing of it blocks sight, but objects as their fault says.
    pub warnings: Vec<TmxWarning>,
}

impl TmxMap {
    /// Whether anything has one of these roles; tiles that block are walls.
    pub(super) fn has(&self, roles: &[Role]) -> bool {
        self.walls.count() > 0 && roles.contains(&Role::Wall)
            || self.objects.iter().any(|object| roles.contains(&object.role))
            || self.tiles.iter().any(|tile| roles.contains(&tile.role))
    }

    /// The tiles that block, placed in a scene as [`TmxObject::insert`] places objects: the tile
    /// `(0, 0)` of the map, as the editor counts, has its least corner at `origin`; `tile_size` is
    /// the side of a tile in world units. Copies the tiles.
    ///
    /// # Errors
    /// As [`TileLayer::new`].
    pub fn tile_layer(&self, origin: Vec2, tile_size: f32) -> Result<TileLayer, TileError> {
        let least = origin.as_dvec2() + self.origin.as_dvec2() * f64::from(tile_size);
        TileLayer::new(least.as_vec2(), tile_size, self.walls.clone())
    }
}
