//! Maps of the editor [Tiled](https://www.mapeditor.org) (`.tmx` files): which of their tiles block
//! sight, and the objects that are drawn over them.
//!
//! Only what that takes is read: tilesets, in the map or in files of their own (`.tsx`), and layers
//! of tiles and of objects, also those in groups. Memory is reserved in proportion to the bytes of
//! the files and the bits of the result, whatever the files promise.

// Not by the crate `tiled` (0.16), which files can make
// - overflow the stack: 10,000 groups in each other (150 kB), or properties of the type `class`; a
//   template whose object names that template (46 bytes);
// - ask for 1.7 TB: `tilecount="4294967295"`, in the map or a tileset;
// - divide by zero: a `spacing` of 2^32 - 1 beside tiles of one pixel;
// - index past the end: a layer of fewer tiles than its dimensions say;
// - take 4 GB: 4,000 objects (100 kB) copy the properties of a template of 1 MB;
// - take 1.5 GiB: 8,192 by 8,192 tiles in 350 kB of zlib, or 100 layers of 1,000 by 1,000 in
//   530 kB. It inflates without a limit and keeps 16 bytes for each tile of each layer. Here they
//   take 8 MiB and 0.2 MiB;
// - search each tile's tileset among all (2,000,000 tiles beside 5,000 tilesets, 400 kB: 5 s), and
//   compare each attribute with all (100,000 of one element, 1 MB: 29 s).
//
// A check before it would go through the XML of maps, tilesets and templates, inflate each layer to
// count its tiles, and add up tiles, tilesets and copies of templates over all files: as long as
// this reader. And it would refuse maps of many tiles, with which nothing is wrong, for no check
// makes a tile smaller. `tests/damaged.rs` has most of these files.

mod data;
mod error;
mod object;
mod parts;
#[cfg(test)]
mod tests;
mod tileset;
mod warning;
mod xml;

use std::collections::HashMap;
use std::io;
use std::path::Path;
use std::sync::Arc;

use glam::IVec2;

use crate::bits::BitGrid;
use crate::editor::{FARTHEST, Inventory, MOST_EMPTY, MapNames, Role, Rule, Says};
use crate::files::{file, text};
use crate::tiles::{TileError, TileLayer};
pub use error::TmxError;
use object::ObjectLayer;
pub use object::TmxObject;
use parts::{Extent, Frame, LONGEST_SIDE, Part, Space, damaged, layer_name};
use tileset::{Files, Open, TILE, Tilesets, properties};
pub use warning::TmxWarning;
use xml::{Element, Xml};

/// Tiles of a rectangle around all layers that is never too large: 2 MiB.
const SMALL: u64 = 1 << 24;

/// What of a map blocks sight, its objects, and warnings: see [`TmxImport::read`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TmxMap {
    /// The tiles that block.
    pub walls: BitGrid,
    /// The column and the row, as the editor counts them, of the tile `(0, 0)` of `walls`.
    pub origin: IVec2,
    /// The objects of all layers, in the order of the file, in tiles as the editor counts them.
    /// Texts and objects of templates are left out.
    pub objects: Vec<TmxObject>,
    /// What was passed over. Nothing of it blocks sight, but objects as the warning says.
    pub warnings: Vec<TmxWarning>,
}

impl TmxMap {
    /// The tiles that block, for a scene in which a tile is a world unit wide and the tile `(0, 0)`,
    /// as the editor counts, has its least corner at the origin. Copies the tiles.
    ///
    /// # Errors
    /// As [`TileLayer::new`].
    pub fn tile_layer(&self) -> Result<TileLayer, TileError> {
        TileLayer::new(self.origin.as_vec2(), 1.0, self.walls.clone())
    }

    /// Whether anything has one of these roles; tiles that block are walls.
    fn has(&self, roles: &[Role]) -> bool {
        self.walls.count() > 0 && roles.contains(&Role::Wall)
            || self.objects.iter().any(|object| roles.contains(&object.role))
    }
}

/// Reads maps. What blocks sight in them is said by names, each in one of these places:
///
/// | name of | what hides |
/// |---|---|
/// | a layer or a group of layers, or its class | all tiles and objects in it |
/// | a property of a layer or a group, if it is true | all tiles and objects in it |
/// | a property of a tile that is true, or its class | the tile, and objects with its picture |
/// | a class of an object, or a property of it that is true | the object |
///
/// Properties of an object count before its class, this before its tile, this before its layer; the
/// class of a tile counts for objects without one. A property that is false takes the role away
/// that the next ones would give. In a layer of walls all tiles hide. What is both is a door. Names
/// of doors make doors of objects; tiles of layers are no doors.
///
/// Shapes that tilesets draw on their tiles ("Tile Collision Editor") are not read. As they may be
/// smaller than the tile, the class of such a tile does not make it hide, and nothing does if one
/// of the shapes is a door; there is a warning.
///
/// ```no_run
/// use casca_plane::tmx::TmxImport;
/// use casca_plane::{MapNames, OpaqueTiles};
///
/// # fn main() -> Result<(), casca_plane::tmx::TmxError> {
/// let names = MapNames { walls: vec!["hedge".into(), "rock".into()], ..MapNames::default() };
/// let import = TmxImport { names };
/// let walls = OpaqueTiles::new(import.read("level_1.tmx")?.walls);
/// # let _ = walls;
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct TmxImport {
    /// The names that count.
    pub names: MapNames,
}

impl TmxImport {
    /// Reads the map in a file. Tilesets in files of their own are looked for from its folder.
    ///
    /// The walls are those of a rectangle around all layers of tiles, which may begin left of or
    /// above the map. Tiles may be stored as text (CSV) or in base64, compressed by zlib, gzip or
    /// not at all. Tiles that no tileset has, and layers that are shifted by parts of a tile, block
    /// nothing, and there is a warning for them. Objects are read from all layers; the shifts of
    /// layers and groups count, by parts of tiles, too. Costs the bytes of the files and the tiles.
    ///
    /// ```no_run
    /// use casca_plane::tmx::TmxImport;
    /// use casca_plane::{GridSpec, Scene};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let map = TmxImport::default().read("world.tmx")?;
    /// map.warnings.iter().for_each(|warning| eprintln!("world.tmx: {warning}"));
    /// let layer = map.tile_layer()?;
    /// let mut scene = Scene::new(&GridSpec::covering(layer.bounds(), layer.tile_size())?)?;
    /// scene.insert_tiles(&layer)?;
    /// for object in &map.objects {
    ///     scene.insert(object.desc())?;
    /// }
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// A file that is missing or damaged, a map of hexagons, one whose tiles are stored in another
    /// way. [`TmxError::Spread`] if the rectangle would have more than 2^24 tiles and four times as
    /// many as all layers together.
    pub fn read(&self, path: impl AsRef<Path>) -> Result<TmxMap, TmxError> {
        let path = path.as_ref();
        let named = || path.display().to_string();
        let map = file(path).map_err(|why| TmxError::File { file: named(), why })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        self.parse(&map, |source| file(&folder.join(source)))
            .map_err(|why| TmxError::In { file: named(), why: Box::new(why) })
    }

    /// As [`Self::read`], from the bytes of a map. `open` gives the bytes of a tileset in a file of
    /// its own, by the path that the map has for it; it is called once for each path.
    ///
    /// # Errors
    /// As [`Self::read`]; those of `open` become [`TmxError::File`].
    pub fn parse(
        &self,
        map: &[u8],
        open: impl FnMut(&str) -> io::Result<Vec<u8>>,
    ) -> Result<TmxMap, TmxError> {
        let ((map, is_odd), mut open) = (text(map), once(open));
        let MapNames { walls, obstacles, doors } = &self.names;
        let (mut found, inventory) = self.map(&map, &mut open, &Rule::new(walls, doors))?;
        if !found.has(&[Role::Wall]) && !obstacles.is_empty() {
            let rule = Rule::new(obstacles, doors);
            let (mut other, names) = self.map(&map, &mut open, &rule)?;
            if other.has(&[Role::Wall]) {
                other.warnings.push(TmxWarning::Obstacles { names: names.walls(&rule) });
                found = other;
            }
        }
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
        let mut files = Files::new(open, rule);
        let (mut extent, mut inventory) = (Extent::NONE, Inventory::default());
        let frame = self.frame(map)?;
        // First the parts, whose texts are long enough for them; then their tiles.
        let tilesets = self.walk(map, &mut files, &mut |xml, layer, _, place| {
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
        self.walk(map, &mut files, &mut |xml, layer, tilesets, place| {
            if !is_objects(layer) {
                return tiles(xml, layer, (&frame, &extent, place), tilesets, &mut found);
            }
            let name: Arc<str> = layer_name(xml, layer)?.into();
            let (space, shift, role) = (&frame.space, place.shift, place.role);
            let layer = ObjectLayer { space, tilesets, rule, name: name.clone(), shift, role };
            let (objects, warnings) = (&mut found.objects, &mut found.warnings);
            let count = layer.read(xml, objects, &mut inventory, &mut |id, why| {
                warnings.push(TmxWarning::Object { id, layer: name.clone(), why });
            })?;
            if count > 0 {
                warnings.push(TmxWarning::Templates { layer: name.to_string(), count });
            }
            Ok(())
        })?;
        if !extent.any && found.warnings.is_empty() && found.objects.is_empty() {
            return Err(TmxError::NoTiles);
        }
        found.warnings.extend(files.odd.into_iter().map(|file| TmxWarning::Encoding { file }));
        Ok((found, inventory))
    }

    fn frame(&self, map: &str) -> Result<Frame, TmxError> {
        let mut xml = Xml::new(map, "the map");
        let root = xml.root("map")?;
        let orientation = xml.required(&root, "orientation")?.into_owned();
        if !["orthogonal", "isometric"].contains(&&*orientation) {
            return Err(TmxError::Orientation(orientation));
        }
        let infinite = xml.attribute(&root, "infinite")?.is_some_and(|infinite| infinite == "1");
        let size = if infinite { (0, 0) } else { self.size(&xml, &root)? };
        let tile = [xml.number(&root, "tilewidth")?, xml.number(&root, "tileheight")?].map(f64::from);
        if tile.contains(&0.0) {
            return Err(xml.damaged("tiles of no size"));
        }
        Ok(Frame { size, infinite, space: Space { isometric: orientation == "isometric", tile } })
    }

    /// Reads the tilesets of a map, and hands out its layers of tiles and of objects with those
    /// before them and with their place.
    fn walk(&self, map: &str, files: &mut Files<'_>, take: TakeLayer<'_>) -> Result<Tilesets, TmxError> {
        let mut xml = Xml::new(map, "the map");
        xml.root("map")?;
        let mut tilesets = Tilesets::default();
        let mut groups = vec![Place { shift: [0.0; 2], role: None }];
        while let Some(&place) = groups.last() {
            let Some(child) = xml.child()? else {
                // The end of a group, or of the map.
                groups.pop();
                continue;
            };
            match child.local_name().as_ref() {
                b"group" => groups.push(place.inner(&xml, &child, files.rule)?),
                b"tileset" => files.tileset(&mut xml, &child, &mut tilesets)?,
                b"layer" | b"objectgroup" => {
                    let place = place.inner(&xml, &child, files.rule)?;
                    take(&mut xml, &child, &tilesets, place)?;
                }
                _ => xml.skip(&child)?,
            }
        }
        Ok(tilesets)
    }

    /// The columns and rows of a map.
    fn size(&self, xml: &Xml<'_>, map: &Element<'_>) -> Result<(u32, u32), TmxError> {
        let (width, height) = (xml.number(map, "width")?, xml.number(map, "height")?);
        match width.max(height) <= LONGEST_SIDE {
            true => Ok((width, height)),
            false => Err(xml
                .damaged(format!("{width} by {height} tiles: at most {LONGEST_SIDE} along a side are read"))),
        }
    }
}

/// Reads the tiles of a layer, from behind its start.
fn tiles(
    xml: &mut Xml<'_>,
    layer: &Element<'_>,
    (frame, extent, place): (&Frame, &Extent, Place),
    tilesets: &Tilesets,
    found: &mut TmxMap,
) -> Result<(), TmxError> {
    let name = layer_name(xml, layer)?;
    let offset = frame.offset(place.shift);
    let (mut missing, mut drawn, mut unknown) = (0, 0, None);
    frame.parts(xml, layer, &mut |xml, part, data, text| {
        let take = &mut |index: u64, id: u32| {
            if id & TILE == 0 {
                return;
            }
            let Some((set, number)) = tilesets.find(id) else {
                unknown.get_or_insert((id & TILE, 0)).1 += 1;
                return;
            };
            drawn += u64::from(set.has_shapes(number));
            if let (Some(offset), true) = (offset, set.blocks(number, place.role == Some(Role::Wall))) {
                let width = u64::from(part.width);
                let x = part.x + (index % width) as i64 + offset[0] - extent.least[0];
                let y = part.y + (index / width) as i64 + offset[1] - extent.least[1];
                found.walls.set(x as u32, y as u32, true);
            }
        };
        missing += data.decode(text, part.tiles(), take).map_err(|why| damaged(xml, &name, why))?;
        Ok(())
    })?;
    if missing > 0 {
        found.warnings.push(TmxWarning::Commas { layer: name.clone(), count: missing });
    }
    if offset.is_none() {
        let [x, y] = frame.space.tiles(place.shift);
        found.warnings.push(TmxWarning::Offset { layer: name.clone(), x, y });
    }
    if let Some((id, count)) = unknown {
        found.warnings.push(TmxWarning::UnknownTiles { layer: name.clone(), id, count });
    }
    if drawn > 0 {
        found.warnings.push(TmxWarning::DrawnShapes { layer: name, count: drawn });
    }
    Ok(())
}

/// Where a layer is, its groups included.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// Its shift in pixels.
    shift: [f64; 2],
    /// The role that it gives to what is in it, if it gives one.
    role: Option<Role>,
}

impl Place {
    /// The place of a layer or a group in this one, at its start.
    fn inner(self, xml: &Xml<'_>, layer: &Element<'_>, rule: &Rule) -> Result<Self, TmxError> {
        let [x, y] = [xml.decimal(layer, "offsetx")?, xml.decimal(layer, "offsety")?];
        let shift = [self.shift[0] + x, self.shift[1] + y];
        let mut says = Says::default();
        // The properties stand before all else.
        if let Some(mut inside) = xml.inside()
            && let Some(child) = inside.child()?
            && child.local_name().as_ref() == b"properties"
        {
            says = properties(&mut inside, rule, &mut Inventory::default(), |_, _| ())?;
        }
        let mut role = says.role();
        for name in ["class", "name"] {
            let named = xml.attribute(layer, name)?;
            role = role.or_else(|| rule.role(&named.unwrap_or_default()));
        }
        Ok(Self { shift, role: role.or(self.role) })
    }
}

/// Opens each file once, and keeps what it gave: a map may be read twice.
fn once(mut open: impl FnMut(&str) -> io::Result<Vec<u8>>) -> impl FnMut(&str) -> io::Result<Vec<u8>> {
    let mut known: HashMap<String, Result<Vec<u8>, (io::ErrorKind, String)>> = HashMap::new();
    move |path| {
        let found = known.entry(path.to_owned());
        let found = found.or_insert_with(|| open(path).map_err(|why| (why.kind(), why.to_string())));
        found.clone().map_err(|(kind, why)| io::Error::new(kind, why))
    }
}

/// Takes a layer, from behind its start, with the tilesets before it and its place.
type TakeLayer<'t> = &'t mut dyn FnMut(&mut Xml<'_>, &Element<'_>, &Tilesets, Place) -> Result<(), TmxError>;

/// Whether a layer is one of objects.
fn is_objects(layer: &Element<'_>) -> bool {
    layer.local_name().as_ref() == b"objectgroup"
}
