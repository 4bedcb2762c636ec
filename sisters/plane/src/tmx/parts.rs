//! Where tiles lie: the pixels of maps, and the parts of layers, which are chunks or all of a layer,
//! with the rectangle around them.

use std::fmt;

use glam::{DMat2, DVec2};

use super::TmxError;
use super::data::Data;
use super::xml::{Element, Xml};
use crate::editor::FARTHEST;

/// Tiles along a side of a map, at most: the editor makes no larger ones.
pub(super) const LONGEST_SIDE: u32 = 1 << 20;

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

/// Tiles from `x` and `y` on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    pub x: i64,
    pub y: i64,
    pub width: u32,
    pub height: u32,
}

impl Part {
    pub fn tiles(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

/// The attributes of the map that hold for all layers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub size: (u32, u32),
    pub infinite: bool,
    pub space: Space,
}

/// The rectangle around all parts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    pub least: [i64; 2],
    pub most: [i64; 2],
    /// How many tiles the parts have.
    pub tiles: u64,
    pub any: bool,
}

impl Extent {
    pub const NONE: Self = Self { least: [i64::MAX; 2], most: [i64::MIN; 2], tiles: 0, any: false };

    pub fn add(&mut self, part: &Part) {
        self.any = true;
        self.tiles += part.tiles();
        if part.tiles() > 0 {
            self.least = [self.least[0].min(part.x), self.least[1].min(part.y)];
            let end = [part.x + i64::from(part.width), part.y + i64::from(part.height)];
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

/// Takes a part of a layer, how its tiles are stored, and their text.
pub(super) type Take<'t> = &'t mut dyn FnMut(&Xml<'_>, Part, Data, &str) -> Result<(), TmxError>;

impl Frame {
    /// A shift in whole tiles; `None` if it is none.
    pub fn offset(&self, shift: [f64; 2]) -> Option<[i64; 2]> {
        let tiles = self.space.tiles(shift);
        let whole = |v: f64| (v - v.round()).abs() < WHOLE && v.abs() <= FARTHEST as f64;
        tiles.iter().all(|&v| whole(v)).then(|| tiles.map(|v| v.round() as i64))
    }

    /// Hands out the parts of a layer, from behind its start: its chunks, or all of it.
    pub fn parts(&self, xml: &mut Xml<'_>, layer: &Element<'_>, take: Take<'_>) -> Result<(), TmxError> {
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
        if size.0.max(size.1) <= LONGEST_SIDE {
            return Ok(size);
        }
        let most = LONGEST_SIDE;
        Err(xml.damaged(format!(
            "a chunk of {} by {} tiles: at most {most} along a side are read",
            size.0, size.1
        )))
    }
}
