//! Maps with all that may be amiss with them: infinite ones, layers beside the map, tiles that no
//! tileset has.

use std::path::Path;
use std::sync::Arc;
use std::{fmt, io};

use glam::IVec2;

use super::data::Data;
use super::files::Files;
use super::objects::{ObjectLayer, Templates, TmxFault, TmxObject};
use super::space::Space;
use super::tileset::Tilesets;
use super::xml::{Element, Xml};
use super::{Place, TmxError, TmxImport, is_objects, orientation};
use crate::bits::BitGrid;
use crate::editor::{FARTHEST, MOST_EMPTY, file};

/// Shifts of layers in tiles that differ by less than this from whole numbers are whole: the editor
/// writes offsets in decimals.
const WHOLE: f64 = 1e-6;

/// Tiles of a rectangle around all layers that is never too large: 2 MiB.
const SMALL: u64 = 1 << 24;

/// The tiles of a map that block sight, its objects, and warnings about the map: see
/// [`TmxImport::read_map`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TmxMap {
    /// The tiles that block.
    pub walls: BitGrid,
    /// The column and the row, as the editor counts them, of the tile `(0, 0)` of `walls`.
    pub origin: IVec2,
    /// The objects of all layers, in the order of the file. Texts are left out.
    pub objects: Vec<TmxObject>,
    /// What was passed over. Nothing of it blocks sight, but objects as their fault says.
    pub warnings: Vec<TmxWarning>,
}

/// What was passed over in a map, so that it blocks no sight, or is amiss with an object.
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
    /// A layer is shifted by a part of a tile: its tiles lie on no others.
    Offset {
        /// The name of the layer.
        layer: String,
        /// By how many tiles to the right.
        x: f64,
        /// By how many tiles down.
        y: f64,
    },
    /// Something is amiss with an object.
    Object {
        /// Its number in the map; 0 if the file gives none.
        id: u32,
        /// The name of its layer.
        layer: Arc<str>,
        /// What is amiss.
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
            Self::Object { id, layer, fault } => write!(f, "the object {id} of the layer {layer:?}: {fault}"),
        }
    }
}

/// Tiles from `x` and `y` on.
#[derive(Debug, Clone, Copy)]
struct Part {
    x: i64,
    y: i64,
    width: u32,
    height: u32,
}

impl Part {
    fn tiles(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

/// What the map says of all layers.
#[derive(Debug, Clone, Copy)]
struct Frame {
    size: (u32, u32),
    infinite: bool,
    space: Space,
}

/// The rectangle around all parts.
#[derive(Debug, Clone, Copy)]
struct Extent {
    least: [i64; 2],
    most: [i64; 2],
    /// How many tiles the parts have.
    tiles: u64,
    any: bool,
}

impl Extent {
    const NONE: Self = Self { least: [i64::MAX; 2], most: [i64::MIN; 2], tiles: 0, any: false };

    fn add(&mut self, part: &Part) {
        self.any = true;
        self.tiles += part.tiles();
        if part.tiles() > 0 {
            self.least = [self.least[0].min(part.x), self.least[1].min(part.y)];
            let end = [part.x + i64::from(part.width), part.y + i64::from(part.height)];
            self.most = [self.most[0].max(end[0]), self.most[1].max(end[1])];
        }
    }
}

impl TmxImport {
    /// As [`Self::read`], also for infinite maps, with the shifts of layers, with objects, and with
    /// warnings.
    ///
    /// The walls are those of a rectangle around all layers of tiles, which may begin left of or
    /// above the map. Tiles that no tileset has, and layers that are shifted by parts of a tile,
    /// block nothing, and there is a warning for them; also for properties of the right name that
    /// are no `bool`. Objects are read from all layers, in tiles; the shifts of layers and groups
    /// count, by parts of tiles, too. [`TmxObject::insert`] puts them into scenes. Objects that are
    /// made of templates take over what they do not say themselves; templates are looked for from
    /// the folder of the map, and their tilesets from that of the template. Not read are texts, and
    /// the objects that tilesets draw on their tiles.
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
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`Self::read`], but infinite maps are read. [`TmxError::Spread`] if the rectangle would
    /// have more than 2^24 tiles and four times as many as all layers together.
    pub fn read_map(&self, path: impl AsRef<Path>) -> Result<TmxMap, TmxError> {
        let path = path.as_ref();
        let map = file(path).map_err(|why| TmxError::File { file: path.display().to_string(), why })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        self.parse_map(&map, |source| file(&folder.join(source)))
    }

    /// As [`Self::read_map`], from the bytes of a map: see [`Self::parse`].
    ///
    /// # Errors
    /// As [`Self::read_map`].
    pub fn parse_map(
        &self,
        map: &[u8],
        mut open: impl FnMut(&str) -> io::Result<Vec<u8>>,
    ) -> Result<TmxMap, TmxError> {
        let (mut files, mut left) = (Files::new(&mut open, self.names()), Templates::most(map));
        let mut extent = Extent::NONE;
        let frame = self.frame(map)?;
        // First the parts, whose texts are long enough for them; then their tiles.
        let tilesets = self.walk(map, &mut files, &mut |xml, layer, _, _, place| {
            if is_objects(layer) {
                return xml.skip(layer);
            }
            let (name, offset) = (layer_name(xml, layer)?, frame.offset(place.shift));
            frame.parts(xml, layer, &mut |xml, part, data, text| {
                data.check(text, part.tiles()).map_err(|why| damaged(xml, &name, why))?;
                if let Some(offset) = offset {
                    extent.add(&Part { x: part.x + offset[0], y: part.y + offset[1], ..part });
                }
                Ok(())
            })
        })?;
        let mut found = TmxMap::default();
        for (first, tile, which, kind) in tilesets.wrong_types() {
            let property = self.names()[which].to_owned();
            found.warnings.push(TmxWarning::PropertyType { first, tile, property, kind });
        }
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
        self.walk(map, &mut files, &mut |xml, layer, files, tilesets, place| {
            if !is_objects(layer) {
                return self.mark(xml, layer, (&frame, &extent), tilesets, place.shift, &mut found);
            }
            let mut open = |path: &str| files.template(path);
            let templates = &mut Templates::new(&mut open, &mut left);
            self.objects(xml, layer, (&frame.space, tilesets, place), templates, &mut found)
        })?;
        if extent.any || !found.warnings.is_empty() || !found.objects.is_empty() {
            Ok(found)
        } else {
            Err(TmxError::NoTiles)
        }
    }

    fn frame(&self, map: &[u8]) -> Result<Frame, TmxError> {
        let mut xml = Xml::new(map, "the map")?;
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
        (space, tilesets, place): (&Space, &Tilesets, Place),
        templates: &mut Templates<'_>,
        found: &mut TmxMap,
    ) -> Result<(), TmxError> {
        let name: Arc<str> = layer_name(xml, layer)?.into();
        let layer = ObjectLayer {
            space,
            tilesets,
            shift: place.shift,
            visible: place.visible,
            names: self.names(),
            walls: *name == *self.layer,
            name: name.clone(),
        };
        layer.read(xml, templates, &mut found.objects, &mut |id, fault| {
            found.warnings.push(TmxWarning::Object { id, layer: name.clone(), fault });
        })
    }

    /// Marks the tiles of a layer that block.
    fn mark(
        &self,
        xml: &mut Xml<'_>,
        layer: &Element<'_>,
        (frame, extent): (&Frame, &Extent),
        tilesets: &Tilesets,
        shift: [f64; 2],
        found: &mut TmxMap,
    ) -> Result<(), TmxError> {
        let name = layer_name(xml, layer)?;
        let all = name == self.layer;
        let Some(offset) = frame.offset(shift) else {
            let [x, y] = frame.space.tiles(shift);
            found.warnings.push(TmxWarning::Offset { layer: name, x, y });
            return frame.parts(xml, layer, &mut |_, _, _, _| Ok(()));
        };
        let mut unknown: Option<(u32, u64)> = None;
        frame.parts(xml, layer, &mut |xml, part, data, text| {
            let [x, y] = [part.x + offset[0] - extent.least[0], part.y + offset[1] - extent.least[1]];
            let take = &mut |index: u64, id: u32| {
                let at = [index % u64::from(part.width), index / u64::from(part.width)];
                if !tilesets.has(id) {
                    unknown.get_or_insert((id & 0x1fff_ffff, 0)).1 += 1;
                } else if tilesets.blocks(id, all) {
                    found.walls.set((x as u64 + at[0]) as u32, (y as u64 + at[1]) as u32, true);
                }
            };
            data.decode(text, part.tiles(), take).map_err(|why| damaged(xml, &name, why))
        })?;
        found.warnings.extend(unknown.map(|(id, count)| TmxWarning::UnknownTiles { layer: name, id, count }));
        Ok(())
    }
}

fn layer_name(xml: &Xml<'_>, layer: &Element<'_>) -> Result<String, TmxError> {
    Ok(xml.attribute(layer, "name")?.unwrap_or_default().into_owned())
}

fn damaged(xml: &Xml<'_>, layer: &str, why: impl fmt::Display) -> TmxError {
    xml.damaged(format!("the layer {layer:?}: {why}"))
}

/// Takes a part of a layer, how its tiles are stored, and their text.
type Take<'t> = &'t mut dyn FnMut(&Xml<'_>, Part, Data, &str) -> Result<(), TmxError>;

impl Frame {
    /// A shift in whole tiles; `None` if it is none.
    fn offset(&self, shift: [f64; 2]) -> Option<[i64; 2]> {
        let tiles = self.space.tiles(shift);
        let whole = |v: f64| (v - v.round()).abs() < WHOLE && v.abs() <= FARTHEST as f64;
        tiles.iter().all(|&v| whole(v)).then(|| tiles.map(|v| v.round() as i64))
    }

    /// Hands out the parts of a layer, from behind its start: its chunks, or all of it.
    fn parts(&self, xml: &mut Xml<'_>, layer: &Element<'_>, take: Take<'_>) -> Result<(), TmxError> {
        let name = layer_name(xml, layer)?;
        let (width, height) = self.size;
        let mut has_data = self.infinite || width == 0 || height == 0;
        if !self.infinite {
            let (found_width, found_height) = (xml.number(layer, "width")?, xml.number(layer, "height")?);
            if (found_width, found_height) != self.size {
                return Err(TmxError::Dimensions { layer: name, found_width, found_height, width, height });
            }
        }
        while let Some(child) = xml.child()? {
            if child.local_name().as_ref() != b"data" {
                xml.skip(&child)?;
                continue;
            }
            let data = Data::new(xml, &child)?;
            has_data = true;
            if !self.infinite {
                let text = xml.text()?;
                take(xml, Part { x: 0, y: 0, width, height }, data, &text)?;
                continue;
            }
            while let Some(chunk) = xml.child()? {
                if chunk.local_name().as_ref() != b"chunk" {
                    xml.skip(&chunk)?;
                    continue;
                }
                let [x, y] = [xml.integer(&chunk, "x")?, xml.integer(&chunk, "y")?].map(i64::from);
                let (width, height) = self.chunk_size(xml, &chunk)?;
                let text = xml.text()?;
                take(xml, Part { x, y, width, height }, data, &text)?;
            }
        }
        if has_data { Ok(()) } else { Err(xml.damaged(format!("the layer {name:?} has no tiles"))) }
    }

    fn chunk_size(&self, xml: &Xml<'_>, chunk: &Element<'_>) -> Result<(u32, u32), TmxError> {
        let size = (xml.number(chunk, "width")?, xml.number(chunk, "height")?);
        if size.0.max(size.1) <= super::LONGEST_SIDE {
            return Ok(size);
        }
        let most = super::LONGEST_SIDE;
        Err(xml.damaged(format!(
            "a chunk of {} by {} tiles: at most {most} along a side are read",
            size.0, size.1
        )))
    }
}
