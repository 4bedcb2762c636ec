//! Maps that are drawn with letters, and maps from files.

use std::path::Path;

use casca_plane::BitGrid;
use glam::I64Vec2;

use crate::tmx::plain;
use crate::{MapError, Role, SMALL, TmxImport, TmxMap, file, utf8};

/// The drawing of a harbour, 72 by 36 tiles, with a customs house, a tower, warehouses and
/// containers.
pub const HARBOUR: &str = include_str!("../levels/harbour.txt");

/// Of so many letters of a drawing, blanks not counted, at least one is a wall; texts of words and
/// numbers have fewer.
const LETTERS_OF_A_WALL: usize = 50;

/// Tiles for each letter of a large drawing, at most: a line that is much longer than the others would
/// take any memory.
const TILES_FOR_A_LETTER: usize = 4;

/// A map read from a drawing: a letter for each tile, row 0 first.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Drawing {
    /// The tiles `#`. Those of doors are clear.
    pub walls: BitGrid,
    /// The tiles `+`.
    pub doors: Vec<(u32, u32)>,
    /// The tiles `g`, where guards begin.
    pub guards: Vec<(u32, u32)>,
    /// The first tile `@`, where a walk begins.
    pub start: Option<(u32, u32)>,
    /// What was passed over in the file, if it is from one.
    pub warnings: Vec<String>,
}

impl Drawing {
    /// Reads a drawing. All other letters are free ground, and short lines end with it.
    pub fn read(text: &str) -> Self {
        let width = text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
        let height = text.lines().count();
        let mut drawing = Self { walls: BitGrid::new(width as u32, height as u32), ..Self::default() };
        for (line, y) in text.lines().zip(0..) {
            for (letter, x) in line.chars().zip(0..) {
                match letter {
                    '#' => drawing.walls.set(x, y, true),
                    '+' => drawing.doors.push((x, y)),
                    'g' => drawing.guards.push((x, y)),
                    '@' => drawing.start = drawing.start.or(Some((x, y))),
                    _ => {}
                }
            }
        }
        drawing
    }

    /// The map in a file: a map of Tiled (`.tmx`, `.tmj`), or a drawing with letters. The contents decide,
    /// and not the name.
    ///
    /// In maps of Tiled, objects of the class or name `guard` are guards, and one `start`, `player`
    /// or `spawn` is where the walk begins. Walls that are no tiles are left out, with a warning.
    ///
    /// # Errors
    /// A file that cannot be read or is none of these.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, MapError> {
        let path = path.as_ref();
        let name = &path.display().to_string();
        let bytes = file(path).map_err(|why| MapError::File { file: name.clone(), why })?;
        let text = utf8(&bytes, name)?;
        if text.trim_start().starts_with(['<', '{']) {
            return Ok(Self::tiled(TmxImport::default().parse_at(path, &bytes)?));
        }
        let refused = |why: &str| Err(MapError::damaged(name, 1, why));
        let shown = || text.chars().filter(|c| !c.is_whitespace());
        let (all, walls) = (shown().count(), shown().filter(|&c| c == '#').count());
        let words = shown().filter(|c| c.is_alphanumeric()).count();
        let is_prose = 2 * words > all && LETTERS_OF_A_WALL * walls < all;
        if is_prose || shown().any(|c| c.is_ascii_control()) {
            return refused(
                "it is no map: those of Tiled are .tmx or .tmj, those drawn with letters have walls (#)",
            );
        }
        // Old files end lines with a carriage return alone.
        let text = &text.replace("\r\n", "\n").replace('\r', "\n");
        let width = text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
        let tiles = width.saturating_mul(text.lines().count());
        if tiles > (SMALL as usize).max(TILES_FOR_A_LETTER.saturating_mul(text.len())) {
            return refused(&format!(
                "a line of {width} letters is much longer than the others: {tiles} tiles are too many"
            ));
        }
        let mut drawing = Self::read(text);
        if drawing.walls.count() == 0 && drawing.doors.is_empty() {
            drawing.warnings.push("nothing blocks sight: no letter is # (a wall) or + (a door)".into());
        }
        Ok(drawing)
    }

    fn tiled(map: TmxMap) -> Self {
        let mut drawing = Self { walls: map.walls, warnings: map.warnings, ..Self::default() };
        let others = map.objects.iter().filter(|object| object.role == Role::Wall).count();
        if others > 0 {
            drawing.warnings.push(format!("{others} walls are no whole tiles: left out, they hide nothing"));
        }
        for object in &map.objects {
            let around = object.bounds.bounds();
            let middle = around.min.midpoint(around.max).floor();
            let I64Vec2 { x, y } = middle.as_i64vec2() - map.origin.as_i64vec2();
            let [Ok(x), Ok(y)] = [x, y].map(u32::try_from) else { continue };
            if x >= drawing.walls.width() || y >= drawing.walls.height() || drawing.walls.get(x, y) {
                continue;
            }
            let names = [&object.class, &object.name].map(|name| plain(name));
            let is = |wanted: &[&str]| names.iter().any(|name| wanted.contains(&&**name));
            if object.role == Role::Door {
                drawing.doors.push((x, y));
            } else if is(&["guard", "guards"]) {
                drawing.guards.push((x, y));
            } else if is(&["start", "player", "spawn", "playerstart"]) {
                drawing.start = Some((x, y));
            }
        }
        drawing
    }
}
