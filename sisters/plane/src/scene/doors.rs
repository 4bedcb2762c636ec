//! Doors: a tile of a layer and an object of a scene that open and close together.

use crate::error::Error;
use crate::geometry::Rect;
use crate::id::ObjectId;
use crate::object::ObjectDesc;
use crate::scene::Scene;
use crate::tiles::TileLayer;

/// A door of a scene: see [`Scene::insert_door`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct TileDoor {
    /// Its column in the layer.
    pub x: u32,
    /// Its row in the layer.
    pub y: u32,
    /// Its object in the scene. That is removed as any other is; the tile of the layer stays.
    pub object: ObjectId,
}

impl Scene {
    /// Adds a door that fills a tile of a layer, closed or open: an object with the bounds of the
    /// tile, which hides others while the door is closed. The tile of the layer blocks sight then,
    /// too, for [`FieldOfView`](crate::FieldOfView).
    ///
    /// Costs as [`Scene::insert`].
    ///
    /// ```
    /// use casca_plane::{BitGrid, GridSpec, Query, Scene, TileLayer, View};
    /// use glam::{UVec2, Vec2};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let mut walls = BitGrid::new(9, 9);
    /// walls.fill(4, 0..4);
    /// walls.fill(4, 5..9);
    /// let mut layer = TileLayer::new(Vec2::ZERO, 1.0, walls)?;
    /// let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(9) })?;
    /// scene.insert_tiles(&layer)?;
    /// let door = scene.insert_door(&mut layer, 4, 4, true)?;
    /// let (view, behind) = (View::all_round(Vec2::new(4.5, 1.5))?, Vec2::new(4.5, 7.5));
    /// let mut query = Query::new();
    /// query.run(&scene, &view);
    /// assert!(layer.opaque().get(4, 4) && !query.sees_point(behind));
    /// scene.set_door(&mut layer, &door, false)?;
    /// query.run(&scene, &view);
    /// assert!(!layer.opaque().get(4, 4) && query.sees_point(behind));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`Error::DoorOutside`] for a tile that the layer does not have, [`Error::DoorInWall`] for
    /// one that blocks sight already, and those of [`Scene::insert`]. Nothing changes then.
    pub fn insert_door(
        &mut self,
        layer: &mut TileLayer,
        x: u32,
        y: u32,
        closed: bool,
    ) -> Result<TileDoor, Error> {
        check(layer, x, y)?;
        if layer.opaque().get(x, y) {
            return Err(Error::DoorInWall { x, y });
        }
        let [min, max] = [(x, y), (x + 1, y + 1)].map(|(x, y)| layer.corner(x, y).as_vec2());
        let rect = Rect::new(min, max);
        let desc = ObjectDesc::fixed(rect);
        let object = self.insert(if closed { desc.occluder(rect) } else { desc })?;
        let door = TileDoor { x, y, object };
        set_tile(layer, &door, closed);
        Ok(door)
    }

    /// Closes or opens a door, in the scene and in its layer. Costs as [`Scene::set_occluder`], and
    /// nothing if the door is so already.
    ///
    /// # Errors
    /// [`Error::DoorOutside`] for a layer that does not have the tile, [`Error::UnknownObject`] for
    /// a door that was removed or belongs to another scene. Nothing changes then.
    pub fn set_door(&mut self, layer: &mut TileLayer, door: &TileDoor, closed: bool) -> Result<(), Error> {
        check(layer, door.x, door.y)?;
        if self.occluder(door.object)?.is_some() != closed {
            let occluder = if closed { Some(self.bounds(door.object)?.clone()) } else { None };
            self.set_occluder(door.object, occluder)?;
        }
        set_tile(layer, door, closed);
        Ok(())
    }
}

fn check(layer: &TileLayer, x: u32, y: u32) -> Result<(), Error> {
    let (width, height) = (layer.opaque().width(), layer.opaque().height());
    if x < width && y < height { Ok(()) } else { Err(Error::DoorOutside { x, y, width, height }) }
}

fn set_tile(layer: &mut TileLayer, door: &TileDoor, closed: bool) {
    // It was checked that the layer has the tile.
    let _ = layer.set_tile(door.x, door.y, closed);
}
