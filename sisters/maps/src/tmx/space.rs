//! Where layers and tiles lie: the pixels of maps, groups, and the chunks of layers.

use std::fmt;
use std::sync::Arc;

use glam::{DMat2, DVec2, I64Vec2, UVec2};

use super::element::Element;
use super::names::{Role, Rule};
use crate::MapError;

/// Coordinates in tiles, at most: single precision, which scenes have, holds whole numbers up to it.
pub const FARTHEST: f64 = (1u64 << 24) as f64;

/// Tiles along a side of a map, at most: the editor makes no larger ones.
const LONGEST_SIDE: i64 = 1 << 20;

/// Shifts of layers in tiles that differ by less than this from whole numbers are whole: the editor
/// writes offsets in decimals.
const WHOLE: f64 = 1e-6;

/// How a map shows its tiles.
#[derive(Debug, Clone, Copy)]
pub struct Space {
    /// Whether objects count along columns and rows that go down to both sides.
    isometric: bool,
    /// Whether every other column or row is shifted by half a tile.
    stagger: Option<Stagger>,
    /// The width and the height of a tile in pixels.
    tile: DVec2,
    /// Columns and rows; `None` for infinite maps.
    size: Option<I64Vec2>,
}

/// Which columns or rows are shifted by half a tile.
#[derive(Debug, Clone, Copy)]
struct Stagger {
    columns: bool,
    even: bool,
    /// The sides of hexagons along columns or rows, in pixels; `None` for diamonds.
    side: Option<DVec2>,
}

impl Stagger {
    /// A tile's place in steps, of which two are the width or height of a diamond.
    fn steps(self, tile: I64Vec2) -> I64Vec2 {
        let shift = |index: i64| i64::from((index & 1 == 0) == self.even);
        match self.columns {
            true => I64Vec2::new(tile.x, 2 * tile.y + shift(tile.x)),
            false => I64Vec2::new(2 * tile.x + shift(tile.y), tile.y),
        }
    }
}

impl Space {
    pub fn read(map: Element<'_>) -> Result<Self, MapError> {
        let orientation = map.required("orientation")?;
        let is_staggered = match orientation {
            "orthogonal" | "isometric" => false,
            "staggered" | "hexagonal" => true,
            _ => return Err(map.damaged(format!("the orientation {orientation:.40} is not known"))),
        };
        let size = if map.attribute("infinite") == Some("1") { None } else { Some(size_of(map)?) };
        let [width, height] = [map.number::<u32>("tilewidth")?, map.number("tileheight")?];
        let mut tile = UVec2::new(width, height);
        let stagger = is_staggered.then(|| {
            // The editor halves these numbers as whole ones.
            tile &= !1;
            let columns = map.attribute("staggeraxis") == Some("x");
            let most = if columns { tile * UVec2::X } else { tile * UVec2::Y }.as_dvec2();
            let side = DVec2::splat(map.decimal("hexsidelength")?).clamp(DVec2::ZERO, most);
            let even = map.attribute("staggerindex") == Some("even");
            Ok(Stagger { columns, even, side: (orientation == "hexagonal").then_some(side) })
        });
        let stagger = stagger.transpose()?;
        if tile.min_element() == 0 {
            return Err(map.damaged("tiles of no size"));
        }
        Ok(Self { isometric: orientation == "isometric", stagger, tile: tile.as_dvec2(), size })
    }

    pub fn is_hexagonal(self) -> bool {
        self.stagger.is_some_and(|stagger| stagger.side.is_some())
    }

    /// A way on the screen in pixels as one in tiles, column and row.
    pub fn tiles(self, way: DVec2) -> DVec2 {
        let DVec2 { x, y } = way / self.tile;
        // Rows of diamonds go down to the left, columns down to the right.
        let is_diamond = self.isometric || self.stagger.is_some() && !self.is_hexagonal();
        if is_diamond { DVec2::new(y + x, y - x) } else { DVec2::new(x, y) }
    }

    /// A place on the screen in pixels as one in tiles.
    pub fn place(self, place: DVec2) -> DVec2 {
        match self.stagger {
            // The uppermost point of the first tile is the origin.
            Some(stagger @ Stagger { side: None, .. }) => {
                let first = stagger.steps(I64Vec2::ZERO) + I64Vec2::X;
                self.tiles(place - first.as_dvec2() * self.tile / 2.0)
            }
            _ => self.tiles(place),
        }
    }

    /// The column and the row of a tile of a layer: of staggered maps, those of an isometric map that
    /// has the same diamonds.
    pub fn cell(self, tile: I64Vec2) -> I64Vec2 {
        let Some(stagger) = self.stagger else { return tile };
        let I64Vec2 { x, y } = stagger.steps(tile) - stagger.steps(I64Vec2::ZERO);
        I64Vec2::new(y + x, y - x) / 2
    }

    /// The corners of a hexagon in tiles. Neighbours share them, or overlap: the editor drops half pixels.
    pub fn hexagon(self, tile: I64Vec2, shift: DVec2) -> Option<[DVec2; 8]> {
        let stagger = self.stagger?;
        let (side, size) = (stagger.side?, 2.0 * self.tile);
        let near = 2.0 * ((self.tile - side) / 2.0).floor();
        let (DVec2 { x: a, y: b }, DVec2 { x: c, y: d }, DVec2 { x, y }) = (near, size - near, size);
        let corners = [(a, 0.0), (c, 0.0), (x, b), (x, d), (c, y), (a, y), (0.0, d), (0.0, b)];
        let at = stagger.steps(tile).as_dvec2() * (near + 2.0 * side) + 2.0 * shift;
        Some(corners.map(|corner| (at + DVec2::from(corner)) / size))
    }

    /// A shift in whole tiles; `None` if it is none.
    pub fn whole_tiles(self, shift: DVec2) -> Option<I64Vec2> {
        let tiles = self.tiles(shift);
        let whole = (tiles - tiles.round()).abs().max_element() < WHOLE;
        (whole && tiles.abs().max_element() <= FARTHEST).then(|| tiles.round().as_i64vec2())
    }

    /// From coordinates of objects to the screen. Those of isometric maps count along columns and
    /// rows, with the height of a tile for each.
    pub fn screen(self) -> DMat2 {
        if !self.isometric {
            return DMat2::IDENTITY;
        }
        let right = self.tile.x / self.tile.y / 2.0;
        DMat2::from_cols(DVec2::new(right, 0.5), DVec2::new(-right, 0.5))
    }

    /// The chunks of a layer of tiles.
    pub fn chunks<'x>(self, layer: &Layer<'x>) -> Result<Vec<Chunk<'x>>, MapError> {
        let mut chunks = Vec::new();
        for data in layer.element.all("data") {
            if let Some(size) = self.size {
                chunks.push(Chunk { element: data, data, at: I64Vec2::ZERO, size });
                continue;
            }
            for element in data.all("chunk") {
                let [x, y] = [element.number::<i32>("x")?, element.number("y")?].map(i64::from);
                chunks.push(Chunk { element, data, at: I64Vec2::new(x, y), size: size_of(element)? });
            }
        }
        if let Some(size) = self.size {
            let I64Vec2 { x, y } = size_of(layer.element)?;
            if I64Vec2::new(x, y) != size {
                let [columns, rows] = size.to_array();
                return Err(layer.damaged(format!("{x} by {y} tiles, but the map has {columns} by {rows}")));
            }
            if chunks.is_empty() && size.min_element() > 0 {
                return Err(layer.damaged("it has no tiles"));
            }
        }
        Ok(chunks)
    }
}

/// The columns and rows of a map, a layer or a chunk.
fn size_of(element: Element<'_>) -> Result<I64Vec2, MapError> {
    let [width, height] = [element.number::<u32>("width")?, element.number("height")?].map(i64::from);
    if width.max(height) > LONGEST_SIDE {
        let why = format!("{width} by {height} tiles: at most {LONGEST_SIDE} along a side are read");
        return Err(element.damaged(why));
    }
    Ok(I64Vec2::new(width, height))
}

/// Tiles from a place on: a part of an infinite layer, or all of another one.
#[derive(Clone, Copy)]
pub struct Chunk<'x> {
    pub element: Element<'x>,
    /// Says how its text is stored.
    pub data: Element<'x>,
    pub at: I64Vec2,
    pub size: I64Vec2,
}

/// A layer, with what its groups and it itself say of all that is in it.
pub struct Layer<'x> {
    pub element: Element<'x>,
    pub name: Arc<str>,
    /// In pixels.
    pub shift: DVec2,
    pub role: Option<Role>,
}

impl<'x> Layer<'x> {
    /// The layers of tiles and of objects, also those in groups.
    pub fn all(map: Element<'x>, rule: &Rule) -> Result<Vec<Self>, MapError> {
        let mut found = Vec::new();
        let mut open = vec![(map.children(), DVec2::ZERO, None)];
        while let Some((children, shift, role)) = open.last_mut() {
            let Some(child) = children.next() else {
                // The end of a group, or of the map.
                open.pop();
                continue;
            };
            if !["group", "layer", "objectgroup"].contains(&child.name) {
                continue;
            }
            let shift = *shift + DVec2::new(child.decimal("offsetx")?, child.decimal("offsety")?);
            let named = || ["class", "name"].into_iter().find_map(|name| rule.role(child.attribute(name)?));
            let role = rule.properties(child).role().or_else(named).or(*role);
            if child.name == "group" {
                open.push((child.children(), shift, role));
            } else {
                let name = child.attribute("name").unwrap_or_default().into();
                found.push(Self { element: child, name, shift, role });
            }
        }
        Ok(found)
    }

    /// Its name as warnings show it.
    pub fn short_name(&self) -> String {
        const MOST_LETTERS: usize = 40;
        self.name.chars().take(MOST_LETTERS).collect()
    }

    /// What is wrong with it.
    pub fn damaged(&self, why: impl fmt::Display) -> MapError {
        self.element.damaged(format!("the layer {:?}: {why}", self.short_name()))
    }
}
