//! Maps of the editor [Tiled](https://www.mapeditor.org) (`.tmx` files): which of their tiles block
//! sight, and the objects that are drawn over them.
//!
//! Only what that takes is read: tilesets, in the map or in files of their own (`.tsx`), and layers
//! of tiles and of objects with a shape, also those in groups. Memory is reserved in proportion to
//! the bytes of the files and the bits of the result, whatever the files promise.

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

mod above;
mod data;
mod error;
mod names;
mod object;
mod parts;
#[cfg(test)]
mod tests;
mod tileset;
mod xml;

use std::io;
use std::path::Path;
use std::sync::Arc;

use glam::IVec2;

use crate::Error;
use crate::bits::BitGrid;
use crate::file;
use crate::tiles::TileLayer;
use above::Above;
use error::{FARTHEST, shortened};
use names::{Rule, WALLS};
use object::ObjectLayer;
use parts::{Chunk, Extent, Frame, damaged, layer_name};
use tileset::{TILE, Tilesets};
use xml::{Element, Xml, utf8};

pub use error::TmxError;
pub use names::Role;
#[cfg(feature = "maps")]
pub(crate) use names::plain;
pub use object::TmxObject;

/// Tiles of a rectangle around all layers that is never too large: 2 MiB.
const SMALL: u64 = 1 << 24;

/// Tiles of a rectangle around all layers, for each tile that a file names, at most. Else two tiles
/// far apart would take any memory.
const MOST_EMPTY: u64 = 4;

/// What of a map blocks sight, its objects, and warnings: see [`TmxImport::read`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TmxMap {
    /// The tiles that block.
    pub walls: BitGrid,
    /// The column and the row, as the editor counts them, of the tile `(0, 0)` of `walls`.
    pub origin: IVec2,
    /// The objects of all layers, in the order of the file, in tiles as the editor counts them.
    /// Texts, pictures and objects of templates are left out.
    pub objects: Vec<TmxObject>,
    /// What was passed over, for people. Nothing of it blocks sight, but objects as it says.
    pub warnings: Vec<String>,
}

impl TmxMap {
    /// The tiles that block, for a scene in which a tile is a world unit wide and the tile `(0, 0)`,
    /// as the editor counts, has its least corner at the origin. Copies the tiles.
    ///
    /// # Errors
    /// As [`TileLayer::new`].
    pub fn tile_layer(&self) -> Result<TileLayer, Error> {
        TileLayer::new(self.origin.as_vec2(), 1.0, self.walls.clone())
    }
}

/// Reads maps. What blocks sight in them is said by names, each in one of these places:
///
/// | name of | what hides |
/// |---|---|
/// | a layer or a group of layers, or its class | all tiles and objects in it |
/// | a property of a layer or a group, if it is true | all tiles and objects in it |
/// | a property of a tile that is true, or its class | the tile |
/// | a class of an object, or a property of it that is true | the object |
///
/// Capitals, blanks, `_`, `-` and a number at the end of a name in a map do not count: `Walls 2` is
/// `walls`. A property says yes with `true`, `yes`, `on` and numbers but 0, and no with `false`,
/// `no`, `off` and 0.
///
/// Properties of an object count before its class, this before its layer. A property that is false
/// takes the role away that the next ones would give. In a layer of walls all tiles hide. What is
/// both is a door. Names of doors make doors of objects; tiles of layers are no doors.
///
/// Shapes that tilesets draw on their tiles ("Tile Collision Editor") are not read. As they may be
/// smaller than the tile, the class of such a tile does not make it hide, and nothing does if one
/// of the shapes is a door; there is a warning.
///
/// ```no_run
/// use casca_plane::OpaqueTiles;
/// use casca_plane::tmx::TmxImport;
///
/// # fn main() -> Result<(), casca_plane::tmx::TmxError> {
/// let import = TmxImport { walls: vec!["hedge".into(), "rock".into()], ..TmxImport::default() };
/// let walls = OpaqueTiles::new(import.read("level_1.tmx")?.walls);
/// # let _ = walls;
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TmxImport {
    /// What blocks sight; at first `opaque`, `wall`, `walls`, `occluder`, `occluders`, `occlusion`,
    /// and `blocks` or `block` before `sight`, `view`, `vision`, `light` and `los`.
    pub walls: Vec<String>,
    /// What hides until it is opened; at first `door` and `doors`.
    pub doors: Vec<String>,
}

impl Default for TmxImport {
    fn default() -> Self {
        let owned = |all: &[&str]| all.iter().map(|&name| name.to_owned()).collect();
        Self { walls: owned(&WALLS), doors: owned(&["door", "doors"]) }
    }
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
    /// # Errors
    /// A file that is missing or damaged, a map of hexagons, one whose tiles are stored in another
    /// way, and one whose rectangle would have more than 2^24 tiles and four times as many as all
    /// layers together.
    pub fn read(&self, path: impl AsRef<Path>) -> Result<TmxMap, TmxError> {
        let path = path.as_ref();
        let name = path.display().to_string();
        let map = file(path).map_err(|why| TmxError::File { file: name.clone(), why })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        self.parse_named(&name, &map, &mut |source| file(&folder.join(source)))
    }

    /// As [`Self::read`], from the bytes of a map. `open` gives the bytes of a tileset in a file of
    /// its own, by the path that the map has for it; it is called once for each path.
    ///
    /// # Errors
    /// As [`Self::read`]; those of `open` become [`TmxError::File`].
    pub fn parse(
        &self,
        map: &[u8],
        mut open: impl FnMut(&str) -> io::Result<Vec<u8>>,
    ) -> Result<TmxMap, TmxError> {
        self.parse_named("the map", map, &mut open)
    }

    fn parse_named(
        &self,
        name: &str,
        map: &[u8],
        open: &mut dyn FnMut(&str) -> io::Result<Vec<u8>>,
    ) -> Result<TmxMap, TmxError> {
        let start = Xml::new(utf8(map, name)?, name);
        let frame = Frame::read(&mut start.again())?;
        let (rule, mut tilesets) = (Rule::new(&self.walls, &self.doors), Tilesets::new(open));
        let (mut extent, mut found) = (Extent::NONE, TmxMap::default());
        // First the chunks, whose texts are long enough for them; then their tiles.
        walk(start.again(), &mut tilesets, &rule, &mut |xml, layer, _, above| {
            if is_objects(layer) {
                return xml.skip(layer);
            }
            let (name, offset) = (layer_name(xml, layer)?, frame.space.whole_tiles(above.shift));
            frame.chunks(xml, layer, &mut |xml, chunk, data, text| {
                data.check(text, chunk.tiles()).map_err(|why| damaged(xml, &name, why))?;
                if let Some(offset) = offset {
                    extent.add(&Chunk { x: chunk.x + offset[0], y: chunk.y + offset[1], ..chunk });
                }
                Ok(())
            })
        })?;
        if extent.tiles > 0 {
            let size = [0, 1].map(|axis| (extent.most[axis] - extent.least[axis]) as u64);
            let tiles = size[0].saturating_mul(size[1]);
            let far = extent.least.iter().chain(&extent.most).any(|at| at.abs() > FARTHEST);
            if far || tiles > SMALL.max(extent.tiles.saturating_mul(MOST_EMPTY)) {
                let ([width, height], tiles) = (size, extent.tiles);
                let why =
                    format!("its layers are spread over {width} by {height} tiles, but have {tiles} only");
                return Err(start.damaged(why));
            }
            found.walls = BitGrid::new(size[0] as u32, size[1] as u32);
            found.origin = IVec2::new(extent.least[0] as i32, extent.least[1] as i32);
        }
        walk(start.again(), &mut tilesets, &rule, &mut |xml, layer, tilesets, above| {
            if !is_objects(layer) {
                return tiles(xml, layer, (&frame, &extent, above), tilesets, &mut found);
            }
            let name: Arc<str> = layer_name(xml, layer)?.into();
            let layer = ObjectLayer { space: &frame.space, rule: &rule, name, above };
            layer.read(xml, &mut found.objects, &mut found.warnings)
        })?;
        if !extent.any && found.warnings.is_empty() && found.objects.is_empty() {
            return Err(start.damaged("it has no layer of tiles and no objects"));
        }
        if found.walls.count() == 0 && found.objects.iter().all(|object| object.role == Role::Plain) {
            found.warnings.push(
                "nothing blocks sight: what hides are layers named \"walls\", and what has the class \"wall\" or \
                 a property \"opaque\" that is true (TmxImport::walls takes other names)"
                    .into(),
            );
        }
        Ok(found)
    }
}

/// Takes a layer, from behind its start, with the tilesets before it and what holds in it.
type TakeLayer<'t> =
    &'t mut dyn FnMut(&mut Xml<'_>, &Element<'_>, &Tilesets<'_>, Above) -> Result<(), TmxError>;

/// Reads the tilesets of a map, and hands out its layers of tiles and of objects with the tilesets
/// before them and with what their groups and they themselves say of what is in them.
fn walk(
    mut xml: Xml<'_>,
    tilesets: &mut Tilesets<'_>,
    rule: &Rule,
    take: TakeLayer<'_>,
) -> Result<(), TmxError> {
    xml.root("map")?;
    tilesets.clear();
    let mut groups = vec![Above { shift: [0.0; 2], role: None }];
    while let Some(&above) = groups.last() {
        let Some(child) = xml.child()? else {
            // The end of a group, or of the map.
            groups.pop();
            continue;
        };
        match child.local_name().as_ref() {
            b"group" => groups.push(above.inner(&xml, &child, rule)?),
            b"tileset" => tilesets.add(&mut xml, &child, rule)?,
            b"layer" | b"objectgroup" => {
                let above = above.inner(&xml, &child, rule)?;
                take(&mut xml, &child, tilesets, above)?;
            }
            _ => xml.skip(&child)?,
        }
    }
    Ok(())
}

/// Reads the tiles of a layer, from behind its start.
fn tiles(
    xml: &mut Xml<'_>,
    layer: &Element<'_>,
    (frame, extent, above): (&Frame, &Extent, Above),
    tilesets: &Tilesets<'_>,
    found: &mut TmxMap,
) -> Result<(), TmxError> {
    let name = layer_name(xml, layer)?;
    let offset = frame.space.whole_tiles(above.shift);
    let (mut drawn, mut unknown) = (0, None);
    frame.chunks(xml, layer, &mut |xml, chunk, data, text| {
        let take = &mut |index: u64, id: u32| {
            if id & TILE == 0 {
                return;
            }
            let Some(tile) = tilesets.find(id) else {
                unknown.get_or_insert((id & TILE, 0)).1 += 1;
                return;
            };
            drawn += u64::from(tile.has_shapes());
            if let (Some(offset), true) = (offset, tile.blocks(above.role == Some(Role::Wall))) {
                let width = u64::from(chunk.width);
                let x = chunk.x + (index % width) as i64 + offset[0] - extent.least[0];
                let y = chunk.y + (index / width) as i64 + offset[1] - extent.least[1];
                found.walls.set(x as u32, y as u32, true);
            }
        };
        data.decode(text, chunk.tiles(), take).map_err(|why| damaged(xml, &name, why))
    })?;
    let mut warn = |what: String| found.warnings.push(format!("the layer {:?} {what}", shortened(&name)));
    if offset.is_none() {
        let [x, y] = frame.space.tiles(above.shift);
        warn(format!("is shifted by {x} and {y} tiles: only whole tiles are read"));
    }
    if let Some((id, count)) = unknown {
        warn(format!("has {count} tiles of no tileset, the first of id {id}"));
    }
    if drawn > 0 {
        warn(format!(
            "has {drawn} tiles that are walls or doors by shapes drawn on them: these hide nothing (give \
             the tile a property \"opaque\", or draw an object)"
        ));
    }
    Ok(())
}

/// Whether a layer is one of objects.
fn is_objects(layer: &Element<'_>) -> bool {
    layer.local_name().as_ref() == b"objectgroup"
}
