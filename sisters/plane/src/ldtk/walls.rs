//! The tiles of a level that block.

use super::error::{LdtkError, LdtkWarning};
use super::import::LdtkImport;
use super::project::{Blocking, Layer, Level};
use crate::bits::BitGrid;
use crate::editor::{MOST_EMPTY, Role, Rule};

/// Bits of all levels that are never too many: 16 MiB.
const SMALL: u64 = 1 << 27;

/// Tiles are at most so many times as wide as the finest: each of them sets the square of that many
/// bits.
const COARSEST: u32 = 64;

/// The bits that levels took so far, and the tiles that files named for them.
#[derive(Debug, Default)]
pub(super) struct Budget {
    bits: u64,
    named: u64,
}

impl Budget {
    /// Whether a grid fits, with the tiles that are named in its level.
    fn take(&mut self, width: u64, height: u64, named: u64) -> bool {
        // Rows are whole words.
        let bits = width.next_multiple_of(64).saturating_mul(height);
        self.bits = self.bits.saturating_add(bits);
        self.named += named;
        self.bits <= SMALL.max(self.named.saturating_mul(MOST_EMPTY))
    }
}

impl LdtkImport {
    /// The tiles that block, with the side of one in pixels; nothing if none blocks.
    pub(super) fn walls(
        &self,
        level: &Level,
        blocking: &Blocking,
        rule: &Rule,
        budget: &mut Budget,
        warnings: &mut Vec<LdtkWarning>,
    ) -> Result<(BitGrid, Option<u32>), LdtkError> {
        let layers = level.layer_instances.as_deref().unwrap_or_default();
        let mut block = Vec::new();
        for layer in layers {
            check(level, layer)?;
            let source = Source { layer, blocking, all: rule.role(&layer.name) == Some(Role::Wall) };
            warnings.extend(source.unknown_values());
            if source.places().next().is_some() {
                block.push(source);
            }
        }
        let Some(finest) = block.iter().map(|source| source.layer.tile).min() else {
            return Ok((BitGrid::default(), None));
        };
        let [width, height] = [level.px_wid, level.px_hei].map(|px| u64::from(px.div_ceil(finest)));
        if !budget.take(width, height, block.iter().map(Source::named).sum()) {
            return Err(LdtkError::Spread { level: level.identifier.clone(), width, height });
        }
        let mut walls = BitGrid::new(width as u32, height as u32);
        for source in &block {
            let Layer { name, tile, shift_x, shift_y, .. } = source.layer;
            if tile / finest > COARSEST {
                warnings.push(LdtkWarning::Coarse { layer: name.clone(), tile: *tile, finest });
                continue;
            }
            let even = |at: i32| at.rem_euclid(finest as i32) == 0;
            if tile % finest != 0 || !even(*shift_x) || !even(*shift_y) {
                let shift = [*shift_x, *shift_y];
                warnings.push(LdtkWarning::Uneven { layer: name.clone(), tile: *tile, shift, finest });
            }
            source.places().for_each(|at| fill(&mut walls, at, *tile, finest));
        }
        Ok((walls, Some(finest)))
    }
}

/// Whether the values of a layer are as many as its tiles, and its tiles have a size that a level
/// may have.
fn check(level: &Level, layer: &Layer) -> Result<(), LdtkError> {
    let Layer { width, height, int_grid_csv: values, .. } = layer;
    let (named, of) = (|| layer.name.clone(), || level.identifier.clone());
    if layer.tile == 0 || i32::try_from(layer.tile).is_err() {
        return Err(LdtkError::NoSize { level: of(), layer: named() });
    }
    if !values.is_empty() && values.len() as u64 != u64::from(*width) * u64::from(*height) {
        let (width, height, found) = (*width, *height, values.len());
        return Err(LdtkError::Values { level: of(), layer: named(), found, width, height });
    }
    Ok(())
}

/// Sets the tiles of the grid that lie wholly in a tile of another size.
fn fill(walls: &mut BitGrid, at: [i64; 2], tile: u32, finest: u32) {
    let (tile, finest) = (i64::from(tile), i64::from(finest));
    let inside = |at: i64, most: u32| {
        let (from, to) = ((at + finest - 1).div_euclid(finest), (at + tile).div_euclid(finest));
        let cut = |v: i64| v.clamp(0, i64::from(most)) as u32;
        cut(from)..cut(to)
    };
    let columns = inside(at[0], walls.width());
    for y in inside(at[1], walls.height()) {
        walls.fill(y, columns.clone());
    }
}

/// A layer, with what is known of its values and tiles.
struct Source<'l> {
    layer: &'l Layer,
    blocking: &'l Blocking,
    /// Whether all that is in it blocks.
    all: bool,
}

impl Source<'_> {
    /// How many values and tiles the file has for it.
    fn named(&self) -> u64 {
        let Layer { int_grid_csv, auto_layer_tiles, grid_tiles, .. } = self.layer;
        (int_grid_csv.len() + auto_layer_tiles.len() + grid_tiles.len()) as u64
    }

    /// The tiles that block: their least corners in pixels of the level.
    fn places(&self) -> impl Iterator<Item = [i64; 2]> {
        let Self { layer, blocking, all } = *self;
        let values = blocking.values.get(&layer.layer_def_uid);
        let blocks = move |value: &i64| {
            *value != 0 && (all || values.and_then(|values| values.get(value)).copied().unwrap_or(false))
        };
        let (width, side) = (i64::from(layer.width), i64::from(layer.tile));
        let of_grid = layer.int_grid_csv.iter().enumerate().filter(move |(_, value)| blocks(value));
        let of_grid = of_grid.map(move |(i, _)| [i as i64 % width * side, i as i64 / width * side]);
        let tagged = layer.tileset().and_then(|tileset| blocking.tiles.get(&tileset));
        let tiles = layer.grid_tiles.iter().chain(&layer.auto_layer_tiles);
        let tiles = tiles.filter(move |tile| all || tagged.is_some_and(|tiles| tiles.contains(&tile.t)));
        let shift = [layer.shift_x, layer.shift_y].map(i64::from);
        let of_tiles = tiles.map(|tile| tile.px.map(i64::from));
        of_grid.chain(of_tiles).map(move |[x, y]| [x + shift[0], y + shift[1]])
    }

    /// Values without a definition say nothing, unless the whole layer blocks.
    fn unknown_values(&self) -> Option<LdtkWarning> {
        let known = self.blocking.values.get(&self.layer.layer_def_uid);
        let is_unknown = |v: &&i64| **v != 0 && !known.is_some_and(|known| known.contains_key(v));
        let mut unknown = self.layer.int_grid_csv.iter().filter(is_unknown);
        let value = *unknown.next().filter(|_| !self.all)?;
        Some(LdtkWarning::UnknownValues { layer: self.layer.name.clone(), value, count: 1 + unknown.count() })
    }
}
