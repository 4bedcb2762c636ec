//! Maps of the editor [Tiled](https://www.mapeditor.org) (`.tmx` files): which of their tiles block
//! sight, the shapes that tilesets draw on them, and the objects that are drawn over them.
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
mod files;
mod layer;
mod map;
mod objects;
mod parts;
mod paths;
mod picture;
mod read;
mod space;
#[cfg(test)]
mod tests;
mod tile;
mod tileset;
mod warning;
mod xml;

use std::collections::HashMap;
use std::io;
use std::path::Path;

use crate::bits::BitGrid;
use crate::editor::{Inventory, MapNames, Role, Rule, Says};
use crate::files::{file, text};
use data::Data;
pub use error::TmxError;
use files::Files;
pub use map::TmxMap;
pub use objects::{TmxFault, TmxObject, TmxShape, TmxValue};
pub use tile::TmxTile;
use tileset::{Tilesets, properties};
pub use warning::TmxWarning;
use xml::{Element, Xml};

/// Tiles along a side of a map, at most: the editor makes no larger ones.
const LONGEST_SIDE: u32 = 1 << 20;

/// Reads maps. What blocks sight in them is said by names, each in one of these places:
///
/// | name of | what hides |
/// |---|---|
/// | a layer or a group of layers, or its class | all tiles and objects in it |
/// | a property of a layer or a group, if it is true | all tiles and objects in it |
/// | a property of a tile that is true | the tile, and objects with its picture |
/// | a class of a tile | the shapes drawn on it, or else the tile; objects with its picture |
/// | a class of an object, or a property of it that is true | the object |
///
/// Properties of an object count before its class, this before its tile, this before its layer; the
/// class of a tile counts for objects without one. A property that is false takes the role away
/// that the next ones would give. In a layer of walls all tiles hide. What is both is a door. Names
/// of doors make doors of objects, and of shapes that tilesets draw on tiles; tiles of layers are
/// no doors.
///
/// ```no_run
/// use casca_plane::tmx::TmxImport;
/// use casca_plane::{MapNames, OpaqueTiles};
///
/// # fn main() -> Result<(), casca_plane::tmx::TmxError> {
/// let names = MapNames { walls: vec!["hedge".into(), "rock".into()], ..MapNames::default() };
/// let import = TmxImport { names };
/// let walls = OpaqueTiles::new(import.read("level_1.tmx")?);
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
    /// The tiles of a file that block sight, column and row as in the editor; shifts of layers do
    /// not count. [`Self::read_map`] reads more, and warns of parts that it passed over. Tilesets
    /// in files of their own are looked for from the folder of the map.
    ///
    /// Tiles may be stored as text (CSV) or in base64, compressed by zlib, gzip or not at all. The
    /// cost is linear in the bytes of the files and the number of tiles.
    ///
    /// # Errors
    /// A file that is missing or damaged, an infinite map, one of hexagons, one whose tiles are
    /// stored in another way.
    pub fn read(&self, path: impl AsRef<Path>) -> Result<BitGrid, TmxError> {
        opened(path.as_ref(), |map, open| self.parse(map, open))
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
    ) -> Result<BitGrid, TmxError> {
        let (map, mut open) = (&text(map).0, once(open));
        let read = |rule: &Rule| self.grid(map, &mut open, rule);
        self.names.read(read, |walls| walls.count() > 0, |_, _| ())
    }

    fn grid(&self, map: &str, open: files::Open<'_>, rule: &Rule) -> Result<BitGrid, TmxError> {
        let mut xml = Xml::new(map, "the map");
        let root = xml.root("map")?;
        if xml.attribute(&root, "infinite")?.is_some_and(|infinite| infinite == "1") {
            return Err(TmxError::Infinite);
        }
        orientation(&xml, &root)?;
        let size = self.size(&xml, &root)?;
        let (mut files, mut opaque) = (Files::new(open, rule), None);
        self.walk(map, &mut files, &mut |xml, layer, _, tilesets, place| match is_objects(layer) {
            true => xml.skip(layer),
            false => self.layer(xml, layer, (size, place), tilesets, &mut opaque),
        })?;
        opaque.ok_or(TmxError::NoTiles)
    }

    /// Reads the tilesets of a map, and hands out its layers of tiles and of objects with those
    /// before them and with their place.
    fn walk(&self, map: &str, files: &mut Files<'_>, take: TakeLayer<'_>) -> Result<Tilesets, TmxError> {
        let mut xml = Xml::new(map, "the map");
        xml.root("map")?;
        let mut tilesets = Tilesets::default();
        let mut groups = vec![Place { shift: [0.0; 2], visible: true, role: None }];
        while let Some(&place) = groups.last() {
            let Some(child) = xml.child()? else {
                // The end of a group, or of the map.
                groups.pop();
                continue;
            };
            match child.local_name().as_ref() {
                b"group" => groups.push(place.inner(&xml, &child, files.rule)?),
                b"tileset" => files.tileset(&mut xml, &child, "", &mut tilesets)?,
                b"layer" | b"objectgroup" => {
                    let place = place.inner(&xml, &child, files.rule)?;
                    take(&mut xml, &child, files, &tilesets, place)?;
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

    /// Adds the tiles of a layer that block, from behind its start.
    fn layer(
        &self,
        xml: &mut Xml<'_>,
        layer: &Element<'_>,
        ((width, height), place): ((u32, u32), Place),
        tilesets: &Tilesets,
        opaque: &mut Option<BitGrid>,
    ) -> Result<(), TmxError> {
        let name = xml.attribute(layer, "name")?.unwrap_or_default().into_owned();
        let (found_width, found_height) = (xml.number(layer, "width")?, xml.number(layer, "height")?);
        if (found_width, found_height) != (width, height) {
            return Err(TmxError::Dimensions { layer: name, found_width, found_height, width, height });
        }
        let count = u64::from(width) * u64::from(height);
        let all = place.role == Some(Role::Wall);
        let mut has_data = count == 0;
        while let Some(child) = xml.child()? {
            if child.local_name().as_ref() != b"data" {
                xml.skip(&child)?;
                continue;
            }
            let data = Data::new(xml, &child)?;
            let text = xml.text()?;
            let fail = |why| xml.damaged(format!("the layer {name:?}: {why}"));
            // Before memory is reserved: a header may promise any number.
            data.check(&text, count).map_err(fail)?;
            let opaque = opaque.get_or_insert_with(|| BitGrid::new(width, height));
            let add = &mut |index: u64, id: u32| {
                if tilesets.blocks(id, all) {
                    opaque.set((index % u64::from(width)) as u32, (index / u64::from(width)) as u32, true);
                }
            };
            _ = data.decode(&text, count, add).map_err(fail)?;
            has_data = true;
        }
        if !has_data {
            return Err(xml.damaged(format!("the layer {name:?} has no tiles")));
        }
        opaque.get_or_insert_with(|| BitGrid::new(width, height));
        Ok(())
    }
}

/// Where a layer is, its groups included.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// Its shift in pixels.
    shift: [f64; 2],
    /// Whether it is switched on.
    visible: bool,
    /// The role that it gives to what is in it, if it gives one.
    role: Option<Role>,
}

impl Place {
    /// The place of a layer or a group in this one, at its start.
    fn inner(self, xml: &Xml<'_>, layer: &Element<'_>, rule: &Rule) -> Result<Self, TmxError> {
        let [x, y] = [xml.decimal(layer, "offsetx")?, xml.decimal(layer, "offsety")?];
        let hidden = xml.attribute(layer, "visible")?.is_some_and(|visible| visible == "0");
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
        Ok(Self { shift, visible: self.visible && !hidden, role: role.or(self.role) })
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

/// Reads a map that a path names, and the files beside it.
fn opened<M>(
    path: &Path,
    read: impl FnOnce(&[u8], &mut dyn FnMut(&str) -> io::Result<Vec<u8>>) -> Result<M, TmxError>,
) -> Result<M, TmxError> {
    let named = || path.display().to_string();
    let map = file(path).map_err(|why| TmxError::File { file: named(), why })?;
    let folder = path.parent().unwrap_or(Path::new(""));
    read(&map, &mut |source| file(&folder.join(source)))
        .map_err(|why| TmxError::In { file: named(), why: Box::new(why) })
}

/// Takes a layer, from behind its start, with the tilesets before it and its place.
type TakeLayer<'t> =
    &'t mut dyn FnMut(&mut Xml<'_>, &Element<'_>, &mut Files<'_>, &Tilesets, Place) -> Result<(), TmxError>;

/// Whether a layer is one of objects.
fn is_objects(layer: &Element<'_>) -> bool {
    layer.local_name().as_ref() == b"objectgroup"
}

/// Refuses maps whose tiles are no squares in rows and columns.
fn orientation(xml: &Xml<'_>, map: &Element<'_>) -> Result<String, TmxError> {
    let orientation = xml.required(map, "orientation")?.into_owned();
    match ["orthogonal", "isometric"].contains(&&*orientation) {
        true => Ok(orientation),
        false => Err(TmxError::Orientation(orientation)),
    }
}
