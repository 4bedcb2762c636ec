//! Where tiles lie: the pixels of maps, and the chunks of layers, with the rectangle around them.

use std::fmt;

use glam::{DMat2, DVec2};

use super::data::Data;
use super::error::{FARTHEST, TmxError};
use super::xml::{Element, Xml};

/// Tiles along a side of a map, at most: the editor makes no larger ones.
const LONGEST_SIDE: u32 = 1 << 20;

/// Shifts of layers in tiles that differ by less than this from whole numbers are whole: the editor
/// writes offsets in decimals.
const WHOLE: f64 = 1e-6;

/// How a map shows its tiles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Space {
    pub isometric: bool,
    /// The width and the height of a tile in pixels.
    pub tile: [f64; 2],
}

impl Space {
    /// A place on the screen in pixels as one in tiles, column and row.
    pub fn tiles(&self, shift: [f64; 2]) -> [f64; 2] {
        let [x, y] = [shift[0] / self.tile[0], shift[1] / self.tile[1]];
        // Rows of isometric maps go down to the left, columns down to the right.
        if self.isometric { [y + x, y - x] } else { [x, y] }
    }

    /// A shift in whole tiles; `None` if it is none.
    pub fn whole_tiles(&self, shift: [f64; 2]) -> Option<[i64; 2]> {
        let tiles = self.tiles(shift);
        let whole = |v: f64| (v - v.round()).abs() < WHOLE && v.abs() <= FARTHEST as f64;
        tiles.iter().all(|&v| whole(v)).then(|| tiles.map(|v| v.round() as i64))
    }

    /// From coordinates of objects to the screen. Those of isometric maps count along columns and
    /// rows, with the height of a tile for each.
    pub fn screen(&self) -> DMat2 {
        let [width, height] = self.tile;
        if self.isometric {
            let right = width / height / 2.0;
            DMat2::from_cols(DVec2::new(right, 0.5), DVec2::new(-right, 0.5))
        } else {
            DMat2::IDENTITY
        }
    }
}

/// Tiles from `x` and `y` on: a part of an infinite layer, or all of another one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chunk {
    pub x: i64,
    pub y: i64,
    pub width: u32,
    pub height: u32,
}

impl Chunk {
    pub fn tiles(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

/// The attributes of the map that hold for all layers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    /// Columns and rows; `None` for infinite maps.
    size: Option<(u32, u32)>,
    pub space: Space,
}

/// The rectangle around all chunks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    pub least: [i64; 2],
    pub most: [i64; 2],
    /// How many tiles the chunks have.
    pub tiles: u64,
    pub any: bool,
}

impl Extent {
    pub const NONE: Self = Self { least: [i64::MAX; 2], most: [i64::MIN; 2], tiles: 0, any: false };

    pub fn add(&mut self, chunk: &Chunk) {
        self.any = true;
        self.tiles += chunk.tiles();
        if chunk.tiles() > 0 {
            self.least = [self.least[0].min(chunk.x), self.least[1].min(chunk.y)];
            let end = [chunk.x + i64::from(chunk.width), chunk.y + i64::from(chunk.height)];
            self.most = [self.most[0].max(end[0]), self.most[1].max(end[1])];
        }
    }
}

pub(super) fn layer_name(xml: &Xml<'_>, layer: &Element<'_>) -> Result<String, TmxError> {
    Ok(xml.attribute(layer, "name")?.unwrap_or_default().into_owned())
}

pub(super) fn damaged(xml: &Xml<'_>, layer: &str, why: impl fmt::Display) -> TmxError {
    xml.damaged(format!("the layer {layer:?}: {why}"))
}

/// Takes a chunk of a layer, how its tiles are stored, and their text.
pub(super) type Take<'t> = &'t mut dyn FnMut(&Xml<'_>, Chunk, Data, &str) -> Result<(), TmxError>;

impl Frame {
    /// Reads the start of a map.
    pub fn read(xml: &mut Xml<'_>) -> Result<Self, TmxError> {
        let root = xml.root("map")?;
        let orientation = xml.required(&root, "orientation")?;
        if !["orthogonal", "isometric"].contains(&&*orientation) {
            return Err(xml.damaged(format!(
                "the map is {orientation}, but only orthogonal and isometric maps have rows and columns of \
                 squares"
            )));
        }
        let infinite = xml.attribute(&root, "infinite")?.is_some_and(|infinite| infinite == "1");
        let size = if infinite { None } else { Some(size(xml, &root)?) };
        let tile = [xml.number::<u32>(&root, "tilewidth")?, xml.number(&root, "tileheight")?].map(f64::from);
        if tile.contains(&0.0) {
            return Err(xml.damaged("tiles of no size"));
        }
        Ok(Self { size, space: Space { isometric: orientation == "isometric", tile } })
    }

    /// Hands out the chunks of a layer, from behind its start.
    pub fn chunks(&self, xml: &mut Xml<'_>, layer: &Element<'_>, take: Take<'_>) -> Result<(), TmxError> {
        let name = layer_name(xml, layer)?;
        let mut has_data = self.size.is_none_or(|(width, height)| width == 0 || height == 0);
        if let Some((width, height)) = self.size {
            let found: (u32, u32) = (xml.number(layer, "width")?, xml.number(layer, "height")?);
            if found != (width, height) {
                let why = format!("{} by {} tiles, but the map has {width} by {height}", found.0, found.1);
                return Err(damaged(xml, &name, why));
            }
        }
        while let Some(child) = xml.child()? {
            if child.local_name().as_ref() != b"data" {
                xml.skip(&child)?;
                continue;
            }
            let data = Data::new(xml, &child)?;
            has_data = true;
            if let Some((width, height)) = self.size {
                let text = xml.text()?;
                take(xml, Chunk { x: 0, y: 0, width, height }, data, &text)?;
                continue;
            }
            while let Some(chunk) = xml.child()? {
                if chunk.local_name().as_ref() != b"chunk" {
                    xml.skip(&chunk)?;
                    continue;
                }
                let [x, y] = [xml.number::<i32>(&chunk, "x")?, xml.number(&chunk, "y")?].map(i64::from);
                let (width, height) = size(xml, &chunk)?;
                let text = xml.text()?;
                take(xml, Chunk { x, y, width, height }, data, &text)?;
            }
        }
        if has_data { Ok(()) } else { Err(damaged(xml, &name, "it has no tiles")) }
    }
}

/// The columns and rows of a map or a chunk.
fn size(xml: &Xml<'_>, element: &Element<'_>) -> Result<(u32, u32), TmxError> {
    let (width, height): (u32, u32) = (xml.number(element, "width")?, xml.number(element, "height")?);
    if width.max(height) <= LONGEST_SIDE {
        return Ok((width, height));
    }
    let why = format!("{width} by {height} tiles: at most {LONGEST_SIDE} along a side are read");
    Err(xml.damaged(why))
}
