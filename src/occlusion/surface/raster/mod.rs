//! The rasteriser of outlines: for each pixel its winding number, and whether an edge touches it.
//!
//! [`Raster`] is all that the rest of the crate sees: [`Raster::begin`] with an area, [`Raster::edge`] for each
//! edge of an outline, [`Raster::finish`], then [`Raster::marks`] tile by tile. This is the scalar
//! implementation; another one has to keep three rules:
//!
//! - every pixel that comes within the edge's width of it is marked as touched;
//! - a pixel that no edge touches has the winding number of the outline around its middle;
//! - an edge gives the same winding numbers in both directions, with opposite signs, in all rasters that contain
//!   it: the seams between two patches rely on it.

mod edge;
mod tiles;
mod winding;

use crate::occlusion::surface::raster::tiles::TileMarks;
use crate::occlusion::surface::raster::winding::Steps;

pub(crate) use crate::occlusion::surface::raster::tiles::{Area, Marks};

/// The pixels around one patch.
#[derive(Debug, Clone, Default)]
pub(crate) struct Raster {
    area: Area,
    /// The first pixel of the area.
    corner: (f64, f64),
    tiles: TileMarks,
    steps: Steps,
}

impl Raster {
    /// Clears the raster, for an area of pixels.
    pub(crate) fn begin(&mut self, area: Area) {
        self.area = area;
        self.corner = (area.x as f64, area.y as f64);
        self.tiles.clear(&area);
        self.steps.clear(area.height());
    }

    /// Its area.
    pub(crate) fn area(&self) -> Area {
        self.area
    }

    /// Turns the steps of all edges into winding numbers.
    pub(crate) fn finish(&mut self) {
        let tiles = &mut self.tiles;
        self.steps.for_spans(self.area.height(), self.area.width(), |row, from, to, winding| {
            if winding != 0 && from < to {
                tiles.mark(row, from, to - 1, if winding > 0 { Marks::PLUS } else { Marks::MINUS });
            }
        });
    }

    /// The pixels of a tile, counted from the first tile of the area, row by row.
    #[inline]
    pub(crate) fn marks(&self, tile: usize) -> Marks {
        self.tiles.get(tile)
    }
}

#[cfg(test)]
mod tests;
