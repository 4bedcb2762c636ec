//! Maps with all that may be amiss with them: infinite ones, layers beside the map, tiles that no
//! tileset has.

use std::io;
use std::path::Path;
use std::sync::Arc;

use glam::IVec2;

use super::files::{Files, Open};
use super::layer::{Stock, TileLayer};
use super::map::TmxMap;
use super::objects::{ObjectLayer, Roles, Templates};
use super::parts::{Extent, Frame, Part, damaged, layer_name};
use super::space::Space;
use super::tileset::Tilesets;
use super::warning::TmxWarning;
use super::xml::{Element, Xml};
use super::{Place, TmxError, TmxImport, is_objects, once, opened, orientation};
use crate::bits::BitGrid;
use crate::editor::{FARTHEST, Inventory, MOST_EMPTY, Role, Rule};
use crate::files::text;

/// Tiles of a rectangle around all layers that is never too large: 2 MiB.
const SMALL: u64 = 1 << 24;

impl TmxImport {
    /// As [`Self::read`], also for infinite maps, with the shifts of layers, with objects, and with
    /// warnings.
    ///
    /// The walls are those of a rectangle around all layers of tiles, which may begin left of or
    /// above the map. Tiles that no tileset has, and layers that are shifted by parts of a tile,
    /// block nothing, and there is a warning for them; also for properties of the right name that
    /// are no `bool`. Objects are read from all layers, in tiles; the shifts of layers and groups
    /// count, by parts of tiles, too. [`TmxObject::insert`] puts them into scenes. Objects that are
    /// made of templates take over the properties that they do not have themselves; templates are
    /// found from the folder of the map, and their tilesets from that of the template. Texts are
    /// not read.
    ///
    /// [`TmxObject::insert`]: super::TmxObject::insert
    ///
    /// Shapes that tilesets draw on their tiles ("Tile Collision Editor") hide wherever such a tile
    /// stands on a layer, turned as it is, if they are walls or doors: by their own properties and
    /// classes, and else by those of the tile and the name of the layer, as objects are. Other
    /// shapes are passed over. A tile that blocks does so in its whole cell, whatever is drawn on
    /// it, unless one of its shapes is a door: then only its shapes hide. Rectangles over a whole
    /// cell are among the walls.
    ///
    /// ```no_run
    /// use casca_plane::tmx::TmxImport;
    /// use casca_plane::{GridSpec, Role, Scene, TileLayer};
    /// use glam::{UVec2, Vec2};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let grid = GridSpec { min: Vec2::ZERO, cell: 16.0, dims: UVec2::splat(256) };
    /// let mut scene = Scene::new(&grid)?;
    /// let map = TmxImport::default().read_map("world.tmx")?;
    /// map.warnings.iter().for_each(|warning| eprintln!("world.tmx: {warning}"));
    /// // Tiles of 16 world units, walls and objects in one scene.
    /// let layer = TileLayer::new(map.origin.as_vec2() * 16.0, 16.0, map.walls)?;
    /// scene.insert_tiles(&layer)?;
    /// for object in &map.objects {
    ///     let placed = object.insert(&mut scene, Vec2::ZERO, 16.0)?;
    ///     if object.role == Role::Door {
    ///         placed.set_closed(&mut scene, false)?;
    ///     }
    /// }
    /// for tile in &map.tiles {
    ///     tile.insert(&mut scene, Vec2::ZERO, 16.0, 0)?;
    /// }
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`Self::read`], but infinite maps are read. [`TmxError::Spread`] if the rectangle would
    /// have more than 2^24 tiles and four times as many as all layers together.
    pub fn read_map(&self, path: impl AsRef<Path>) -> Result<TmxMap, TmxError> {
        opened(path.as_ref(), |map, open| self.parse_map(map, open))
    }

    /// As [`Self::read_map`], from the bytes of a map: see [`Self::parse`].
    ///
    /// # Errors
    /// As [`Self::read_map`].
    pub fn parse_map(
        &self,
        map: &[u8],
        open: impl FnMut(&str) -> io::Result<Vec<u8>>,
    ) -> Result<TmxMap, TmxError> {
        let ((map, is_odd), mut open) = (text(map), once(open));
        let read = |rule: &Rule| self.map(&map, &mut open, rule);
        let warn = |rule: &Rule, (found, inventory): &mut (TmxMap, Inventory)| {
            let names = std::mem::take(inventory).walls(rule);
            found.warnings.push(TmxWarning::Obstacles { names });
        };
        let has_walls = |(found, _): &(TmxMap, Inventory)| found.has(&[Role::Wall]);
        let (mut found, inventory) = self.names.read(read, has_walls, warn)?;
        if is_odd {
            found.warnings.push(TmxWarning::Encoding { file: "the map".into() });
        }
        if !found.has(&[Role::Wall, Role::Door]) {
            let [layers, names] = inventory.lists();
            found.warnings.push(TmxWarning::NothingBlocks { layers, names });
        }
        Ok(found)
    }

    /// Reads a map by a rule, with what might have said that something blocks.
    fn map(&self, map: &str, open: Open<'_>, rule: &Rule) -> Result<(TmxMap, Inventory), TmxError> {
        let (mut files, mut left) = (Files::new(open, rule), Templates::most(map.len()));
        let (mut extent, mut inventory) = (Extent::NONE, Inventory::default());
        let frame = self.frame(map)?;
        // First the parts, whose texts are long enough for them; then their tiles.
        let tilesets = self.walk(map, &mut files, &mut |xml, layer, _, _, place| {
            let (name, offset) = (layer_name(xml, layer)?, frame.offset(place.shift));
            inventory.add_layer(&name);
            if is_objects(layer) {
                return xml.skip(layer);
            }
            frame.parts(xml, layer, &mut |xml, part, data, text| {
                data.check(text, part.tiles()).map_err(|why| damaged(xml, &name, why))?;
                if let Some(offset) = offset {
                    extent.add(&Part { x: part.x + offset[0], y: part.y + offset[1], ..part });
                }
                Ok(())
            })
        })?;
        let mut found = TmxMap::default();
        for (first, tile, [property, kind]) in tilesets.wrong() {
            found.warnings.push(TmxWarning::PropertyType { first, tile, property, kind });
        }
        tilesets.names().for_each(|names| inventory.extend(names));
        if extent.tiles > 0 {
            let size = [0, 1].map(|axis| (extent.most[axis] - extent.least[axis]) as u64);
            let tiles = size[0].saturating_mul(size[1]);
            let far = extent.least.iter().chain(&extent.most).any(|at| at.abs() > FARTHEST);
            if far || tiles > SMALL.max(extent.tiles.saturating_mul(MOST_EMPTY)) {
                return Err(TmxError::Spread { width: size[0], height: size[1], tiles: extent.tiles });
            }
            found.walls = BitGrid::new(size[0] as u32, size[1] as u32);
            found.origin = IVec2::new(extent.least[0] as i32, extent.least[1] as i32);
        }
        let mut stock = Stock::new(frame.space, map.len());
        self.walk(map, &mut files, &mut |xml, layer, files, tilesets, place| {
            let mut open = |path: &str| files.template(path);
            let templates = &mut Templates::new(&mut open, &mut left);
            let roles = Roles { rule, layer: place.role };
            if !is_objects(layer) {
                let tiles = (tilesets, templates, &mut stock);
                return self.tiles(xml, layer, (&frame, &extent, place, roles), tiles, &mut found);
            }
            self.objects(xml, layer, (&frame.space, tilesets, place, roles), templates, &mut found)
        })?;
        if !extent.any && found.warnings.is_empty() && found.objects.is_empty() {
            return Err(TmxError::NoTiles);
        }
        found.warnings.extend(files.odd.into_iter().map(|file| TmxWarning::Encoding { file }));
        for object in &found.objects {
            object.properties.keys().for_each(|name| inventory.add_name(name));
            inventory.add_name(&object.class);
        }
        Ok((found, inventory))
    }

    fn frame(&self, map: &str) -> Result<Frame, TmxError> {
        let mut xml = Xml::new(map, "the map");
        let root = xml.root("map")?;
        let orientation = orientation(&xml, &root)?;
        let infinite = xml.attribute(&root, "infinite")?.is_some_and(|infinite| infinite == "1");
        let size = if infinite { (0, 0) } else { self.size(&xml, &root)? };
        let tile = [xml.number(&root, "tilewidth")?, xml.number(&root, "tileheight")?].map(f64::from);
        if tile.contains(&0.0) {
            return Err(xml.damaged("tiles of no size"));
        }
        Ok(Frame { size, infinite, space: Space { isometric: orientation == "isometric", tile } })
    }

    /// Reads the objects of a layer.
    fn objects(
        &self,
        xml: &mut Xml<'_>,
        layer: &Element<'_>,
        (space, tilesets, place, roles): (&Space, &Tilesets, Place, Roles<'_>),
        templates: &mut Templates<'_>,
        found: &mut TmxMap,
    ) -> Result<(), TmxError> {
        let name: Arc<str> = layer_name(xml, layer)?.into();
        let layer = ObjectLayer {
            space,
            tilesets,
            shift: place.shift,
            visible: place.visible,
            roles,
            name: name.clone(),
        };
        layer.read(xml, templates, &mut found.objects, &mut |id, fault| {
            found.warnings.push(TmxWarning::Object { id, layer: name.clone(), fault });
        })
    }

    /// Reads the tiles of a layer.
    fn tiles(
        &self,
        xml: &mut Xml<'_>,
        layer: &Element<'_>,
        (frame, extent, place, roles): (&Frame, &Extent, Place, Roles<'_>),
        (tilesets, templates, stock): (&Tilesets, &mut Templates<'_>, &mut Stock),
        found: &mut TmxMap,
    ) -> Result<(), TmxError> {
        let name = layer_name(xml, layer)?;
        let mut tiles = TileLayer::new((&name, roles), (frame, extent, place), tilesets);
        let mut missing = 0;
        frame.parts(xml, layer, &mut |xml, part, data, text| {
            let take = &mut |index: u64, id: u32| {
                let width = u64::from(part.width);
                let at = [part.x + (index % width) as i64, part.y + (index / width) as i64];
                tiles.take(at, id, (templates, stock), found);
            };
            missing += data.decode(text, part.tiles(), take).map_err(|why| damaged(xml, &name, why))?;
            Ok(())
        })?;
        if missing > 0 {
            found.warnings.push(TmxWarning::Commas { layer: name, count: missing });
        }
        tiles.warn(&mut found.warnings);
        Ok(())
    }
}
