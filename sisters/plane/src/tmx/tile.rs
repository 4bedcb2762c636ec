//! Tiles of layers on which their tilesets draw shapes that hide.

use std::sync::Arc;

use glam::{DVec2, Vec2};

use super::objects::{TmxShape, parts};
use crate::editor::{Placed, Role};
use crate::error::Error;
use crate::geometry::Shape;
use crate::scene::Scene;

/// A tile of a layer with the walls, or the doors, that its tileset draws on it: see
/// [`TmxMap::tiles`](super::TmxMap::tiles). Tiles with the same shapes share them.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TmxTile {
    /// The column and the row of its cell, as the editor counts them. They have fractions on layers
    /// that are shifted by parts of a tile.
    pub place: DVec2,
    /// Its number as the map counts, with the upper bits that turn it.
    pub tile: u32,
    /// The name of its layer.
    pub layer: Arc<str>,
    /// False if its layer or a group around it is switched off in the editor. It hides all the
    /// same.
    pub visible: bool,
    /// Whether the shapes are walls or doors. Of tiles with both there are two.
    pub role: Role,
    /// Where the shapes are, in tiles from `place` on, turned as the tile is.
    pub shapes: Arc<[TmxShape]>,
}

impl TmxTile {
    /// Adds the shapes to a scene as fixed objects with this user data, walls and closed doors with
    /// occluders. The tile `(0, 0)` of the map, as the editor counts, has its least corner at
    /// `origin`; `tile_size` is the side of a tile in world units. The doors of a tile are opened
    /// together.
    ///
    /// Forms and costs are those of [`TmxObject::insert`](super::TmxObject::insert), for each
    /// shape.
    ///
    /// # Errors
    /// As [`TmxObject::insert`](super::TmxObject::insert). Nothing is added then.
    pub fn insert(
        &self,
        scene: &mut Scene,
        origin: Vec2,
        tile_size: f32,
        user_data: u64,
    ) -> Result<Placed, Error> {
        Placed::insert(scene, self.parts(origin, tile_size)?, user_data)
    }

    /// The shapes that [`Self::insert`] adds, with their occluders.
    ///
    /// # Errors
    /// As [`TmxObject::parts`](super::TmxObject::parts).
    pub fn parts(&self, origin: Vec2, tile_size: f32) -> Result<Vec<(Shape, Option<Shape>)>, Error> {
        let mut all = Vec::with_capacity(self.shapes.len());
        for shape in &*self.shapes {
            all.append(&mut parts(shape, self.role != Role::Plain, (origin, self.place), tile_size)?);
        }
        Ok(all)
    }
}
