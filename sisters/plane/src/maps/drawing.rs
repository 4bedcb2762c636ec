//! Maps that are drawn with letters, and maps from files.

use std::path::Path;

use crate::bits::BitGrid;
use crate::file;

/// The drawing of a harbour, 72 by 36 tiles, with a customs house, a tower, warehouses and
/// containers.
pub const HARBOUR: &str = include_str!("../../maps/harbour.txt");

/// Of so many letters of a drawing, blanks not counted, at least one is a wall; texts of words and
/// numbers have fewer.
const LETTERS_OF_A_WALL: usize = 50;

/// Tiles that are never too many, and tiles for each letter of a larger drawing: a line that is
/// much longer than the others would take any memory.
const SMALL: usize = 1 << 24;
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

/// Why a file is no map: its path, and the place in it or what to do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {why}")]
pub struct MapError {
    /// The path.
    pub file: String,
    /// The reason.
    pub why: String,
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

    /// The map in a file: a map of Tiled (`.tmx`, with the feature `tiled`), or a drawing with
    /// letters. The contents decide, and not the name.
    ///
    /// In maps of Tiled, objects of the class or name `guard` are guards, and one `start`, `player`
    /// or `spawn` is where the walk begins. Walls that are no tiles are left out, with a warning.
    ///
    /// # Errors
    /// A file that cannot be read or is none of these.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, MapError> {
        let path = path.as_ref();
        let read = || {
            let bytes = file(path).map_err(|why| format!("it cannot be read: {why}"))?;
            let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
            let text = str::from_utf8(text).map_err(|_| "it is no text in UTF-8")?;
            match text.trim_start().starts_with('<') {
                true => tiled(&bytes, path),
                false => Self::drawn(text),
            }
        };
        read().map_err(|why| MapError { file: path.display().to_string(), why })
    }

    /// As [`Self::read`], of a text that may be something else.
    fn drawn(text: &str) -> Result<Self, String> {
        let shown = || text.chars().filter(|c| !c.is_whitespace());
        let (all, walls) = (shown().count(), shown().filter(|&c| c == '#').count());
        let words = shown().filter(|c| c.is_alphanumeric()).count();
        let is_prose = 2 * words > all && LETTERS_OF_A_WALL * walls < all;
        if is_prose || text.trim_start().starts_with('{') || shown().any(|c| c.is_ascii_control()) {
            let why = "it is no map: those of Tiled are saved as .tmx (not as JSON), and those drawn with \
                       letters have walls (#)";
            return Err(why.into());
        }
        // Old files end lines with a carriage return alone.
        let text = &text.replace("\r\n", "\n").replace('\r', "\n");
        let width = text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
        let tiles = width.saturating_mul(text.lines().count());
        if tiles > SMALL.max(TILES_FOR_A_LETTER.saturating_mul(text.len())) {
            return Err(format!(
                "a line of {width} letters is much longer than the others: {tiles} tiles are too many"
            ));
        }
        let mut drawing = Self::read(text);
        if drawing.walls.count() == 0 && drawing.doors.is_empty() {
            drawing.warnings.push("nothing blocks sight: no letter is # (a wall) or + (a door)".into());
        }
        Ok(drawing)
    }
}

#[cfg(feature = "tiled")]
fn tiled(bytes: &[u8], path: &Path) -> Result<Drawing, String> {
    use crate::tmx::{Role, TmxImport, plain};

    let folder = path.parent().unwrap_or(Path::new(""));
    let map = TmxImport::default().parse(bytes, |path| file(&folder.join(path)));
    let map = map.map_err(|why| why.to_string())?;
    let mut drawing = Drawing { walls: map.walls, warnings: map.warnings, ..Drawing::default() };
    let origin = map.origin.as_i64vec2();
    let mut others = 0;
    for object in &map.objects {
        others += usize::from(object.role == Role::Wall);
        let around = object.bounds.block();
        let tile = ((around.min + around.max) / 2.0).floor().as_i64vec2() - origin;
        let [Ok(x), Ok(y)] = tile.to_array().map(u32::try_from) else { continue };
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
    if others > 0 {
        let warning = format!("{others} walls are no whole tiles: they are left out here, and hide nothing");
        drawing.warnings.push(warning);
    }
    Ok(drawing)
}

#[cfg(not(feature = "tiled"))]
fn tiled(_: &[u8], _: &Path) -> Result<Drawing, String> {
    Err("it is a map of Tiled: build casca-plane with the feature tiled".into())
}
