//! Pictures side by side in a grid, each with a caption.

use std::path::Path;

use plotters::style::RGBColor;

use super::PictureError;
use super::palette::{QUIET, TEXT};
use super::raster::Canvas;

/// A picture of a sheet.
#[derive(Debug, Clone)]
pub struct Tile {
    /// The words above it.
    pub caption: String,
    /// Pixels in a row.
    pub width: usize,
    /// Bytes of sRGB, three a pixel, row by row from the top.
    pub rgb: Vec<u8>,
}

const GAP: usize = 12;
const CAPTION: usize = 22;
const HEAD: usize = 64;
/// Pixels of a tile are drawn as squares of this many, so that captions have room.
const ZOOM: usize = 2;

/// Draws rows of tiles of one size as a PNG. The title states the finding, the subtitle says how to
/// read the tiles.
///
/// # Errors
/// If the file cannot be written.
pub fn sheet(path: &Path, title: &str, subtitle: &str, rows: &[Vec<Tile>]) -> Result<(), PictureError> {
    let height_of = |t: &Tile| (t.rgb.len() / 3).div_ceil(t.width.max(1)) * ZOOM;
    let (mut width, mut height) = (0, HEAD + GAP);
    for row in rows {
        width = width.max(row.iter().map(|t| t.width * ZOOM + GAP).sum());
        height += row.iter().map(height_of).max().unwrap_or(0) + CAPTION + GAP;
    }
    let mut canvas = Canvas::new(width + GAP, height, RGBColor(255, 255, 255));
    canvas.text((GAP as f32, 22.0), 22.0, TEXT, title);
    canvas.text((GAP as f32, 48.0), 16.0, QUIET, subtitle);
    let mut top = HEAD;
    for row in rows {
        let mut left = GAP;
        for tile in row {
            canvas.text((left as f32, top as f32 + CAPTION as f32 / 2.0), 16.0, TEXT, &tile.caption);
            for (i, c) in tile.rgb.chunks_exact(3).enumerate() {
                let at = (left + i % tile.width * ZOOM, top + CAPTION + i / tile.width * ZOOM);
                canvas.rect(at, (ZOOM, ZOOM), RGBColor(c[0], c[1], c[2]));
            }
            left += tile.width * ZOOM + GAP;
        }
        top += row.iter().map(height_of).max().unwrap_or(0) + CAPTION + GAP;
    }
    canvas.save(path)
}
