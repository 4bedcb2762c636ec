//! Layers of tiles in a scene.

use crate::error::Error;
use crate::id::ObjectId;
use crate::object::ObjectDesc;
use crate::scene::Scene;
use crate::tiles::TileLayer;

impl Scene {
    /// Adds the tiles of a layer that block sight, as fixed objects with occluders: one for each of the [rectangles](TileLayer::rects) of
    /// such tiles. Gives their ids.
    ///
    /// For [`Method::Cell`](crate::Method::Cell), cells that lie wholly inside one of the rectangles are opaque; these are the
    /// cells of all tiles where tiles have the size of cells and lie on them. Tiles that open and close, as doors do, are better left
    /// out of the layer and added as objects. Costs the cells that the tiles touch.
    ///
    /// # Errors
    /// As [`Scene::insert`]; then none is added.
    pub fn insert_tiles(&mut self, layer: &TileLayer) -> Result<Vec<ObjectId>, Error> {
        let rects = layer.rects();
        let mut ids = Vec::with_capacity(rects.len());
        for rect in rects {
            match self.insert(ObjectDesc::fixed(rect).occluder(rect)) {
                Ok(id) => ids.push(id),
                Err(error) => {
                    ids.into_iter().try_for_each(|id| self.remove(id))?;
                    return Err(error);
                }
            }
        }
        Ok(ids)
    }
}

#[cfg(test)]
mod tests {
    use glam::{IVec2, UVec2, Vec2};

    use super::*;
    use crate::bits::BitGrid;
    use crate::grid::GridSpec;

    fn bits(rows: &[&str]) -> BitGrid {
        let mut bits = BitGrid::new(rows[0].len() as u32, rows.len() as u32);
        for (y, row) in (0..).zip(rows) {
            (0..).zip(row.bytes()).for_each(|(x, tile)| bits.set(x, y, tile == b'#'));
        }
        bits
    }

    #[test]
    fn tiles_on_cells_make_them_opaque() {
        let spec = GridSpec { min: Vec2::splat(-2.0), cell: 0.5, dims: UVec2::splat(12) };
        let mut scene = Scene::new(&spec).unwrap();
        let tiles = bits(&["#.#", "###", "..#"]);
        let layer = TileLayer::new(Vec2::new(-1.0, -1.5), 0.5, tiles.clone()).unwrap();
        let ids = scene.insert_tiles(&layer).unwrap();
        assert_eq!(ids.len(), scene.len());
        let [fixed, _] = scene.opacity();
        for cell in (0..144).map(|i| IVec2::new(i % 12, i / 12)) {
            let tile = cell - IVec2::new(2, 1);
            let opaque = tile.cmpge(IVec2::ZERO).all() && tiles.get(tile.x as u32, tile.y as u32);
            assert_eq!(fixed.get(cell.x as u32, cell.y as u32), opaque, "{cell}");
        }
        ids.into_iter().for_each(|id| scene.remove(id).unwrap());
        assert_eq!(scene.opacity()[0].cells().count(), 0);
    }
}
