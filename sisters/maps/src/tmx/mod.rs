//! Levels of the editor Tiled (`.tmx`): which of their tiles block sight, and the objects that are
//! drawn over them.

// The trees are made by `roxmltree` and `serde_json`, and not all by the crate `tiled` (0.16), which
// some files end, and which takes any memory: groups in each other, a template that names itself,
// `tilecount="4294967295"`, layers that inflate without a limit. `tests/damaged.rs` has such files.

mod data;
mod element;
mod json;
mod names;
mod object;
mod space;
mod tileset;

use std::io;
use std::path::Path;

use casca_plane::{BitGrid, Error, TileLayer};
use glam::{I64Vec2, IVec2};

use crate::{MapError, SMALL, file};
use data::decode;
use element::{Element, tree};
use names::{Rule, WALLS};
use space::{Chunk, FARTHEST, Layer, Space};
use tileset::{TILE, Tilesets};

pub use names::Role;
pub(crate) use names::plain;
pub use object::TmxObject;

/// Tiles that layers may have together, whatever their files hold: what takes a second to inflate.
const PLENTY: u64 = 1 << 26;

/// Tiles for each byte of a larger map: deflate makes at most 1032 bytes of one.
const TILES_FOR_A_BYTE: u64 = 258;

/// Tiles of a rectangle around all layers, for each tile that a file names, at most. Else two tiles
/// far apart would take any memory.
const MOST_EMPTY: u64 = 4;

/// Hexagons that hide, at most: each is an object of some hundred bytes.
const MOST_HEXAGONS: usize = 1 << 16;

/// What of a map blocks sight, its objects, and warnings: see [`TmxImport::read`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TmxMap {
    /// The tiles that block.
    pub walls: BitGrid,
    /// The column and the row, as the editor counts them, of the tile `(0, 0)` of `walls`. Those of
    /// staggered maps are of an isometric map with the same diamonds, from their first tile on.
    pub origin: IVec2,
    /// The objects of all layers, in the order of the file, in tiles as the editor counts them.
    /// Texts, pictures and objects of templates are left out. Before them come the hexagons that
    /// hide, with the number 0; their unit is the width of a tile along x, and its height along y.
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

/// Reads levels of Tiled. What blocks sight in them is said by [names](crate#what-hides-in-a-level).
///
/// Shapes that tilesets draw on their tiles ("Tile Collision Editor") are not read. As they may be
/// smaller than the tile, the class of such a tile does not make it hide, and nothing does if one
/// of the shapes is a door; there is a warning.
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
    /// above the map. Tiles may be stored as text (CSV) or in base64, compressed by zlib, gzip,
    /// Zstandard or not at all. Tiles that no tileset has, and layers that are shifted by parts of a
    /// tile, block nothing, and there is a warning for them. Objects are read from all layers; the
    /// shifts of layers and groups count, by parts of tiles, too. Costs the bytes of the files and
    /// the tiles.
    ///
    /// # Errors
    /// A file that is missing or damaged, one with more than 65,536 hexagons that hide, one whose tiles are
    /// stored in another way, and one whose rectangle would have more than 2^24 tiles and four times
    /// as many as all layers together; more than 2^26 tiles, and 258 for each byte of the file.
    pub fn read(&self, path: impl AsRef<Path>) -> Result<TmxMap, MapError> {
        let path = path.as_ref();
        let name = path.display().to_string();
        let map = file(path).map_err(|why| MapError::File { file: name, why })?;
        self.parse_at(path, &map)
    }

    /// The bytes of the file at a path.
    pub(crate) fn parse_at(&self, path: &Path, map: &[u8]) -> Result<TmxMap, MapError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        self.parse_named(&path.display().to_string(), map, &mut |source| file(&folder.join(source)))
    }

    /// As [`Self::read`], from the bytes of a map. `open` gives the bytes of a tileset in a file of
    /// its own, by the path that the map has for it; it is called once for each path.
    ///
    /// # Errors
    /// As [`Self::read`]; those of `open` become [`MapError::File`].
    pub fn parse(
        &self,
        map: &[u8],
        mut open: impl FnMut(&str) -> io::Result<Vec<u8>>,
    ) -> Result<TmxMap, MapError> {
        self.parse_named("the map", map, &mut open)
    }

    fn parse_named(
        &self,
        name: &str,
        bytes: &[u8],
        open: &mut dyn FnMut(&str) -> io::Result<Vec<u8>>,
    ) -> Result<TmxMap, MapError> {
        let tree = tree(bytes, name)?;
        let map = Element::root(&tree, name, "map")?;
        let (space, rule) = (Space::read(map)?, Rule::new(&self.walls, &self.doors));
        let tilesets = Tilesets::read(map, &rule, open)?;
        let (objects, tiles): (Vec<_>, Vec<_>) =
            Layer::all(map, &rule)?.into_iter().partition(|layer| layer.element.name == "objectgroup");
        let tiles = tiles.into_iter().map(|layer| Ok((space.chunks(&layer)?, layer)));
        let tiles = tiles.collect::<Result<Vec<_>, MapError>>()?;

        // The rectangle around all chunks whose tiles are read.
        let (mut least, mut most, mut count) = (I64Vec2::MAX, I64Vec2::MIN, 0);
        for (chunks, layer) in &tiles {
            for chunk in chunks.iter().filter(|chunk| chunk.size.min_element() > 0) {
                count += chunk.size.element_product() as u64;
                let Some(shift) = space.whole_tiles(layer.shift).filter(|_| !space.is_hexagonal()) else {
                    continue;
                };
                let last = chunk.size - 1;
                for corner in [I64Vec2::ZERO, last, last * I64Vec2::X, last * I64Vec2::Y] {
                    let cell = space.cell(chunk.at + corner) + shift;
                    (least, most) = (least.min(cell), most.max(cell + 1));
                }
            }
        }
        if count > PLENTY.max(TILES_FOR_A_BYTE * bytes.len() as u64) {
            return Err(
                map.damaged(format!("too few tiles for its dimensions: {count} fit into no file so small"))
            );
        }
        let mut found = TmxMap::default();
        if least.cmplt(most).all() {
            let size = most - least;
            let far = least.abs().max(most.abs()).max_element() > FARTHEST as i64;
            if far || size.element_product() as u64 > SMALL.max(MOST_EMPTY * count) {
                let why = format!(
                    "its layers are spread over {} by {} tiles, but have {count} only",
                    size.x, size.y
                );
                return Err(map.damaged(why));
            }
            found.walls = BitGrid::new(size.x as u32, size.y as u32);
            found.origin = least.as_ivec2();
        }
        for (chunks, layer) in &tiles {
            read_tiles(layer, chunks, space, &tilesets, &mut found)?;
        }
        for layer in &objects {
            object::read(layer, space, &rule, &mut found.objects, &mut found.warnings);
        }
        if found.walls.count() == 0 && found.objects.iter().all(|object| object.role == Role::Plain) {
            found.warnings.push(
                "nothing blocks sight: what hides are layers named \"walls\", and what has the class \"wall\" \
                 or a property \"opaque\" that is true (TmxImport::walls takes other names)"
                    .into(),
            );
        }
        Ok(found)
    }
}

/// Reads the tiles of a layer.
fn read_tiles(
    layer: &Layer<'_>,
    chunks: &[Chunk<'_>],
    space: Space,
    tilesets: &Tilesets,
    found: &mut TmxMap,
) -> Result<(), MapError> {
    let shift = space.whole_tiles(layer.shift).map(|shift| shift - found.origin.as_i64vec2());
    let (mut drawn, mut unknown) = (0, None);
    for chunk in chunks {
        let (width, count) = (chunk.size.x as u64, chunk.size.element_product() as u64);
        let take = &mut |index: u64, id: u32| {
            if id & TILE == 0 {
                return Ok(());
            }
            let Some(tile) = tilesets.find(id) else {
                unknown.get_or_insert((id & TILE, 0)).1 += 1;
                return Ok(());
            };
            drawn += u64::from(tile.has_shapes());
            if !tile.blocks(layer.role == Some(Role::Wall)) {
                return Ok(());
            }
            let at = chunk.at + I64Vec2::new((index % width) as i64, (index / width) as i64);
            if let Some(corners) = space.hexagon(at, layer.shift) {
                found.objects.push(TmxObject::hexagon(&corners, layer)?);
                let few = found.objects.len() <= MOST_HEXAGONS;
                return few.then_some(()).ok_or_else(|| format!("more than {MOST_HEXAGONS} hexagons hide"));
            }
            if let Some(shift) = shift {
                let at = space.cell(at) + shift;
                found.walls.set(at.x as u32, at.y as u32, true);
            }
            Ok(())
        };
        let (text, stored) = chunk.element.tiles(chunk.data)?;
        decode(&text, stored, count, take).map_err(|why| layer.damaged(why))?;
    }
    let mut warn = |what: String| found.warnings.push(format!("the layer {:?} {what}", layer.short_name()));
    if shift.is_none() && !space.is_hexagonal() {
        let by = space.tiles(layer.shift);
        warn(format!("is shifted by {} and {} tiles: only whole tiles are read", by.x, by.y));
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
