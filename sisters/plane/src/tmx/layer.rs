//! Layers of tiles: which tiles block in their cells, and which bring shapes.

use std::sync::Arc;

use glam::DVec2;

use super::Place;
use super::map::TmxMap;
use super::objects::{DrawnTiles, Roles, Standing, Templates};
use super::parts::{Extent, Frame};
use super::space::Space;
use super::tile::TmxTile;
use super::tileset::{TILE, Tilesets};
use super::warning::TmxWarning;
use crate::editor::Role;

/// Tiles and corners of their shapes that are kept of any map.
const CORNERS_FOR_ALL: u64 = 1 << 20;

/// And for each byte of the map. Else 100 kB of zlib would put a tileset of 10,000 shapes on
/// 10,000,000 tiles.
const CORNERS_FOR_A_BYTE: u64 = 2;

/// The data that all layers of a map share.
pub(super) struct Stock {
    drawn: DrawnTiles,
    /// Tiles and corners that may still be kept.
    left: u64,
}

impl Stock {
    /// For a map of so many bytes.
    pub fn new(space: Space, bytes: usize) -> Self {
        let left = CORNERS_FOR_ALL + CORNERS_FOR_A_BYTE * bytes as u64;
        Self { drawn: DrawnTiles::new(space), left }
    }
}

/// A layer whose tiles are being read.
pub(super) struct TileLayer<'l> {
    name: Arc<str>,
    roles: Roles<'l>,
    tilesets: &'l Tilesets,
    visible: bool,
    /// From the tiles of the layer to those of the map, and to those of the walls; not to these if
    /// it is shifted by a part of a tile.
    shift: DVec2,
    to_walls: Option<[i64; 2]>,
    /// The first tile of no tileset, and how many there are.
    unknown: Option<(u32, u64)>,
    /// The tiles whose shapes are left out.
    many: u64,
}

impl<'l> TileLayer<'l> {
    /// A layer by its name, of a map and a place.
    pub fn new(
        (name, roles): (&str, Roles<'l>),
        (frame, extent, place): (&Frame, &Extent, Place),
        tilesets: &'l Tilesets,
    ) -> Self {
        let offset = frame.offset(place.shift);
        // Whole but for the rounding of decimals is whole.
        let shift = match offset {
            Some([x, y]) => DVec2::new(x as f64, y as f64),
            None => DVec2::from(frame.space.tiles(place.shift)),
        };
        let to_walls = offset.map(|[x, y]| [x - extent.least[0], y - extent.least[1]]);
        let (name, visible) = (name.into(), place.visible);
        Self { name, roles, tilesets, visible, shift, to_walls, unknown: None, many: 0 }
    }

    /// Takes a tile, by its column and row in the layer.
    pub fn take(
        &mut self,
        [x, y]: [i64; 2],
        id: u32,
        (templates, stock): (&mut Templates<'_>, &mut Stock),
        found: &mut TmxMap,
    ) {
        let plain = id & TILE;
        if plain == 0 {
            return;
        }
        let Some((set, number)) = self.tilesets.find(id) else {
            self.unknown.get_or_insert((plain, 0)).1 += 1;
            return;
        };
        let mut blocks = self.roles.layer == Some(Role::Wall) || set.blocks(number);
        if !set.drawn(number).is_empty() {
            let tile = Standing { set, number, id, roles: self.roles };
            let first = plain - number;
            let brought = stock.drawn.at(tile, templates, &mut |object, fault| {
                found.warnings.push(TmxWarning::TileObject { first, tile: number, id: object, fault });
            });
            blocks = blocks && brought.doors.corners == 0 || brought.covers;
            let in_cell = blocks && self.to_walls.is_some() && brought.inside;
            let walls = Some((Role::Wall, &brought.walls)).filter(|_| !in_cell);
            let parts = walls.into_iter().chain([(Role::Door, &brought.doors)]);
            let parts = parts.filter(|(_, shapes)| shapes.corners > 0);
            let cost = parts.clone().map(|(_, shapes)| 1 + shapes.corners).sum();
            match stock.left.checked_sub(cost) {
                None => self.many += 1,
                Some(left) => {
                    stock.left = left;
                    let place = self.shift + DVec2::new(x as f64, y as f64);
                    let (layer, visible) = (&self.name, self.visible);
                    found.tiles.extend(parts.map(|(role, shapes)| TmxTile {
                        place,
                        tile: id,
                        layer: layer.clone(),
                        visible,
                        role,
                        shapes: shapes.all.clone(),
                    }));
                }
            }
        }
        if let (true, Some(to_walls)) = (blocks, self.to_walls) {
            found.walls.set((x + to_walls[0]) as u32, (y + to_walls[1]) as u32, true);
        }
    }

    /// Adds the warnings of the layer.
    pub fn warn(&self, warnings: &mut Vec<TmxWarning>) {
        let name = || self.name.to_string();
        if self.to_walls.is_none() {
            warnings.push(TmxWarning::Offset { layer: name(), x: self.shift.x, y: self.shift.y });
        }
        if let Some((id, count)) = self.unknown {
            warnings.push(TmxWarning::UnknownTiles { layer: name(), id, count });
        }
        if self.many > 0 {
            warnings.push(TmxWarning::ManyShapes { layer: name(), count: self.many });
        }
    }
}
