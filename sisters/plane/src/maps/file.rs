//! Maps from files: drawings and maps of Tiled.

use std::path::Path;

use super::Drawing;
use crate::files::{file, text};

/// Why a file is no map: its path, and the place in it or what to do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {why}")]
pub struct MapError {
    /// The path.
    pub file: String,
    /// The reason.
    pub why: String,
}

/// Of so many letters of a drawing, blanks not counted, at least one is a wall; texts of words and
/// numbers have fewer.
const LETTERS_OF_A_WALL: usize = 50;

/// Tiles that are never too many, and tiles for each letter of a larger drawing: a line that is
/// much longer than the others would take any memory.
const SMALL: usize = 1 << 24;
const TILES_FOR_A_LETTER: usize = 4;

/// What a file is, by its contents.
#[derive(Debug, PartialEq)]
enum Kind {
    Tiled,
    Drawing,
}

impl Drawing {
    /// The map in a file: a map of Tiled (`.tmx`, with the feature `tiled`), or a
    /// drawing with letters. The contents decide, and not the name.
    ///
    /// In maps of Tiled, objects of the class or name `guard` are guards, and one `start`, `player`
    /// or `spawn` is where the walk begins. Walls that are no tiles are left out, with a warning.
    ///
    /// # Errors
    /// A file that cannot be read or is none of these.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, MapError> {
        let path = path.as_ref();
        let failed = |why: String| MapError { file: path.display().to_string(), why };
        let bytes = file(path).map_err(|why| failed(format!("it cannot be read: {why}")))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let found = kind(&bytes).and_then(|(kind, text)| match kind {
            Kind::Tiled => tiled(&bytes, folder),
            Kind::Drawing => drawn(&text),
        });
        found.map_err(failed)
    }
}

/// What bytes are, and their text.
fn kind(bytes: &[u8]) -> Result<(Kind, String), String> {
    const LETTERS: &str = "a map drawn with letters (# is a wall, + a door)";
    let (text, _) = text(bytes);
    let is_control = |c: char| c.is_ascii_control() && !c.is_ascii_whitespace();
    if text.contains(is_control) {
        return Err(format!("it is no text, so it is no map: maps are .tmx, or {LETTERS}"));
    }
    let start = text.trim_start();
    let has = |name: &str| start.contains(&format!("\"{name}\""));
    match start.chars().next() {
        Some('<') => match element(start) {
            Some("map") => Ok((Kind::Tiled, String::new())),
            Some("tileset" | "template") => {
                Err("it is a tileset or a template of Tiled: open the map (.tmx) that names it".into())
            }
            other => {
                Err(format!("it is XML, but no map of Tiled: its element is {:.40}", other.unwrap_or("none")))
            }
        },
        Some('{') if has("tilewidth") || has("tiledversion") => {
            Err("it is a map of Tiled in JSON: save it as .tmx (File, Export As)".into())
        }
        Some('{') if has("layerInstances") => {
            Err("it is a project or a level of LDtk: let LDtk save Tiled files, too, and open these".into())
        }
        Some('{') => Err("it is JSON, but maps are .tmx files or drawn with letters".into()),
        _ => {
            let shown = || start.chars().filter(|c| !c.is_whitespace());
            let (all, walls) = (shown().count(), shown().filter(|&c| c == '#').count());
            let words = shown().filter(|c| c.is_alphanumeric()).count();
            match 2 * words > all && LETTERS_OF_A_WALL * walls < all {
                true => Err(format!("it has words or numbers and hardly a wall, so it is not {LETTERS}")),
                false => Ok((Kind::Drawing, text.into_owned())),
            }
        }
    }
}

/// The name of the outermost element of XML.
fn element(mut text: &str) -> Option<&str> {
    loop {
        let inner = text.trim_start().strip_prefix('<')?;
        let end = match inner.as_bytes().first()? {
            b'?' => "?>",
            b'!' if inner.starts_with("!--") => "-->",
            b'!' => ">",
            _ => return inner.split(|c: char| c.is_whitespace() || matches!(c, '>' | '/')).next(),
        };
        text = inner.split_once(end)?.1;
    }
}

fn drawn(text: &str) -> Result<Drawing, String> {
    // Old files end lines with a carriage return alone.
    let text = &text.replace("\r\n", "\n").replace('\r', "\n");
    let width = text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
    let tiles = width.saturating_mul(text.lines().count());
    if tiles > SMALL.max(TILES_FOR_A_LETTER.saturating_mul(text.len())) {
        return Err(format!(
            "a line of {width} letters is much longer than the others: {tiles} tiles are too many"
        ));
    }
    let mut drawing = Drawing::read(text);
    if drawing.walls.count() == 0 && drawing.doors.is_empty() {
        drawing.warnings.push("nothing blocks sight: no letter is # (a wall) or + (a door)".into());
    }
    Ok(drawing)
}

#[cfg(feature = "tiled")]
impl Drawing {
    /// Takes what stands on a tile that is no wall: a door, or a guard or a start by one of its
    /// names.
    fn place(&mut self, [x, y]: [i64; 2], is_door: bool, names: &[&str]) {
        let [Ok(x), Ok(y)] = [x, y].map(u32::try_from) else { return };
        if x >= self.walls.width() || y >= self.walls.height() || self.walls.get(x, y) {
            return;
        }
        let is =
            |wanted: &[&str]| names.iter().any(|name| wanted.contains(&&*crate::editor::names::plain(name)));
        match () {
            () if is_door => self.doors.push((x, y)),
            () if is(&["guard", "guards"]) => self.guards.push((x, y)),
            () if is(&["start", "player", "spawn", "playerstart"]) => self.start = Some((x, y)),
            () => {}
        }
    }
}

#[cfg(feature = "tiled")]
fn tiled(bytes: &[u8], folder: &Path) -> Result<Drawing, String> {
    use crate::editor::Role;
    use crate::tmx::TmxImport;

    let map = TmxImport::default().parse(bytes, |path| file(&folder.join(path)));
    let map = map.map_err(|why| why.to_string())?;
    let warnings = map.warnings.iter().map(ToString::to_string).collect();
    let mut drawing = Drawing { walls: map.walls, warnings, ..Drawing::default() };
    let origin = map.origin.as_i64vec2();
    let mut others = 0;
    for object in &map.objects {
        let around = object.bounds.block();
        let tile = ((around.min + around.max) / 2.0).floor().as_i64vec2() - origin;
        others += usize::from(object.role == Role::Wall);
        drawing.place(tile.to_array(), object.role == Role::Door, &[&object.class, &object.name]);
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
