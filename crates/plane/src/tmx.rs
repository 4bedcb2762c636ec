//! Maps of the editor [Tiled](https://www.mapeditor.org) (`.tmx` files): which of their tiles block sight.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use tiled::{FiniteTileLayer, LayerType, Loader, Map, Orientation, PropertyValue, TileLayer};

use crate::bits::BitGrid;

/// Which tiles of a file block sight: those of tilesets that say so, and all tiles of some layers.
///
/// ```no_run
/// use casca_plane::OpaqueTiles;
/// use casca_plane::tmx::TmxImport;
///
/// # fn main() -> Result<(), casca_plane::tmx::TmxError> {
/// let import = TmxImport { layer: "collision".into(), ..TmxImport::default() };
/// let walls = OpaqueTiles::new(import.read("level_1.tmx")?);
/// # let _ = walls;
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TmxImport {
    /// Tiles whose tileset gives them a property of this name block, if it is `true`; at first `opaque`.
    pub property: String,
    /// All tiles in layers of this name block; at first `walls`.
    pub layer: String,
}

impl Default for TmxImport {
    fn default() -> Self {
        Self { property: "opaque".into(), layer: "walls".into() }
    }
}

/// Why a map was not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TmxError {
    /// The file, or one that it names, cannot be read.
    #[error("the map cannot be read: {0}")]
    File(#[from] tiled::Error),
    /// The map has no fixed size.
    #[error("the map is infinite: give it a size in the editor (Map, Map Properties, Infinite)")]
    Infinite,
    /// The map's tiles are no squares in rows and columns.
    #[error("the map is {0}, but only orthogonal and isometric maps have rows and columns of squares")]
    Orientation(Orientation),
    /// The map has no layer of tiles.
    #[error("the map has no layer of tiles")]
    NoTiles,
    /// The dimensions of a layer are not those of the map.
    #[error("the layer {layer:?} has {found_width} by {found_height} tiles, but the map {width} by {height}")]
    Dimensions {
        /// The name of the layer.
        layer: String,
        /// The columns of the layer.
        found_width: u32,
        /// The rows of the layer.
        found_height: u32,
        /// The columns of the map.
        width: u32,
        /// The rows of the map.
        height: u32,
    },
    /// The contents of the file do not fit together; a layer has fewer tiles than its dimensions say, for example.
    #[error("the map is damaged: {0}")]
    Damaged(&'static str),
}

impl TmxImport {
    /// The tiles of a file that block sight, column and row as in the editor.
    ///
    /// # Errors
    /// A file that is missing or damaged, an infinite map, one of hexagons.
    pub fn read(&self, path: impl AsRef<Path>) -> Result<BitGrid, TmxError> {
        let path = path.as_ref();
        let map = unless_panicked("it cannot be parsed", || Loader::new().load_tmx_map(path))??;
        if map.infinite() {
            return Err(TmxError::Infinite);
        }
        if !matches!(map.orientation, Orientation::Orthogonal | Orientation::Isometric) {
            return Err(TmxError::Orientation(map.orientation));
        }
        let mut opaque = None;
        // Groups hold further layers.
        let mut open: Vec<_> = map.layers().collect();
        while let Some(layer) = open.pop() {
            match layer.layer_type() {
                LayerType::Group(group) => open.extend(group.layers()),
                LayerType::Tiles(TileLayer::Finite(tiles)) => {
                    check(&map, &layer.name, &tiles)?;
                    let opaque = opaque.get_or_insert_with(|| BitGrid::new(map.width, map.height));
                    self.add(&tiles, layer.name == self.layer, opaque);
                }
                _ => {}
            }
        }
        opaque.ok_or(TmxError::NoTiles)
    }

    /// Adds the tiles of a layer that block.
    fn add(&self, tiles: &FiniteTileLayer<'_>, all: bool, opaque: &mut BitGrid) {
        for y in 0..opaque.height() {
            for x in 0..opaque.width() {
                let Some(tile) = tiles.get_tile(x as i32, y as i32) else { continue };
                let says_so = || {
                    let tile = tile.get_tile()?;
                    Some(tile.properties.get(&self.property) == Some(&PropertyValue::BoolValue(true)))
                };
                if all || says_so() == Some(true) {
                    opaque.set(x, y, true);
                }
            }
        }
    }
}

/// Whether a layer has the dimensions of its map, and all of its tiles.
fn check(map: &Map, layer: &str, tiles: &FiniteTileLayer<'_>) -> Result<(), TmxError> {
    let (found_width, found_height, width, height) = (tiles.width(), tiles.height(), map.width, map.height);
    if (found_width, found_height) != (width, height) {
        return Err(TmxError::Dimensions { layer: layer.into(), found_width, found_height, width, height });
    }
    let last = |size: u32| i32::try_from(i64::from(size) - 1);
    let (Ok(x), Ok(y)) = (last(width), last(height)) else {
        return Err(TmxError::Damaged("its dimensions are too large"));
    };
    // The reader does not count the tiles of a layer, and panics at those that are missing.
    unless_panicked("a layer has too few tiles", || tiles.get_tile(x, y).is_some())?;
    Ok(())
}

/// The result of a call into the reader, which panics on some damaged files.
fn unless_panicked<T>(damage: &'static str, call: impl FnOnce() -> T) -> Result<T, TmxError> {
    catch_unwind(AssertUnwindSafe(call)).map_err(|_| TmxError::Damaged(damage))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example(name: &str) -> std::path::PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("maps").join(name)
    }

    /// The file, changed.
    fn read_changed(name: &str, change: impl Fn(String) -> String) -> Result<BitGrid, TmxError> {
        let text = std::fs::read_to_string(example("harbour.tmx")).unwrap();
        let folder = std::env::temp_dir().join(format!("casca-plane-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("map.tmx");
        std::fs::write(&file, change(text)).unwrap();
        let result = TmxImport::default().read(&file);
        std::fs::remove_dir_all(folder).unwrap();
        result
    }

    #[test]
    fn properties_and_layers_block() {
        let drawing = include_str!("../maps/harbour.txt");
        let walls = TmxImport::default().read(example("harbour.tmx")).unwrap();
        for (y, line) in (0..).zip(drawing.lines()) {
            for (x, letter) in (0..).zip(line.bytes()) {
                assert_eq!(walls.get(x, y), letter == b'#', "tile ({x}, {y})");
            }
        }
        let no_layer = TmxImport { layer: "none".into(), ..TmxImport::default() };
        let no_property = TmxImport { property: "none".into(), ..TmxImport::default() };
        let count = |import: TmxImport| import.read(example("harbour.tmx")).unwrap().count();
        let (by_property, by_layer) = (count(no_layer), count(no_property));
        assert_eq!(by_property + by_layer, walls.count());
        assert!(by_property > 0 && by_layer > 0);
    }

    #[test]
    fn damaged_files_are_refused() {
        assert!(matches!(TmxImport::default().read(example("none.tmx")), Err(TmxError::File(_))));
        let whole = |text: String| text;
        assert!(read_changed("whole", whole).is_ok());
        let infinite = |text: String| text.replace("infinite=\"0\"", "infinite=\"1\"");
        assert!(read_changed("infinite", infinite).is_err());
        let hexagons = |text: String| text.replace("orthogonal", "hexagonal");
        assert!(matches!(read_changed("hexagons", hexagons), Err(TmxError::Orientation(_))));
        let short = |text: String| text.replace("height=\"36\"", "height=\"37\"");
        assert!(matches!(read_changed("short", short), Err(TmxError::Damaged(_))));
        let huge = |text: String| text.replace("height=\"36\"", "height=\"2000000000\"");
        assert!(matches!(read_changed("huge", huge), Err(TmxError::Damaged(_))));
        let narrow = |text: String| text.replacen("width=\"72\"", "width=\"71\"", 1);
        assert!(matches!(read_changed("narrow", narrow), Err(TmxError::Dimensions { .. })));
        let cut = |text: String| text[..text.len() / 2].to_string();
        assert!(matches!(read_changed("cut", cut), Err(TmxError::File(_))));
    }
}
