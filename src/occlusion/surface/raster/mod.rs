//! The rasteriser of outlines: for each pixel whether an edge touches it, and its winding number.
//!
//! Winding numbers are known modulo four: two bits for each pixel, which are added for 64 pixels at
//! a time. A number that is not zero is so modulo four, too, but for outlines that go around a
//! pixel four times: those are taken to leave it open.
//!
//! [`Raster`] is all that the rest of the crate sees: [`Raster::begin`] with an area,
//! [`Raster::edges`] with eight edges at a time or [`Raster::edge`] with one, [`Raster::finish`],
//! then [`Raster::marks`] tile by tile. The first is in single precision ([`lanes`]), the other,
//! for edges that reach far beyond the view, in double precision ([`edge`]). Both keep three rules
//! (pixels around a line can be marked with [`Raster::strip`], too):
//!
//! - every pixel that comes within the edge's width of it is marked as touched;
//! - a pixel that no edge touches has the winding number of the outline around its middle;
//! - edges that follow each other pass the same rows where they meet, and an edge drawn for two
//!   patches passes the same columns for both, but where the marks say that it is not known: the
//!   seams between two patches rely on it.

mod edge;
mod lanes;
mod square;
mod strip;
mod tiles;

use crate::occlusion::surface::raster::tiles::TileMarks;

pub(crate) use crate::occlusion::surface::raster::lanes::{Edges, LANES, Lanes, each};
pub(crate) use crate::occlusion::surface::raster::square::{Passed, SQUARE, SquareMarks, TileWords};
pub(crate) use crate::occlusion::surface::raster::tiles::{Area, Marks};

/// The pixels around one patch.
#[derive(Debug, Clone, Default)]
pub(crate) struct Raster {
    area: Area,
    /// The first pixel of the area, counted from the pixel that edges are counted from.
    corner: (i32, i32),
    tiles: TileMarks,
}

impl Raster {
    /// Clears the raster, for an area of pixels. The coordinates of edges are counted from the
    /// corner of pixel `first`, the first one of a tile.
    pub(crate) fn begin(&mut self, area: Area, first: (i64, i64)) {
        self.area = area;
        self.corner = ((area.x - first.0) as i32, (area.y - first.1) as i32);
        self.tiles.clear(&area);
    }

    /// Its area.
    pub(crate) fn area(&self) -> Area {
        self.area
    }

    /// Finds the winding numbers, when all edges are drawn.
    pub(crate) fn finish(&mut self) {
        self.tiles.finish();
    }

    /// The pixels of a tile, counted from the first tile of the area, row by row.
    #[inline]
    pub(crate) fn marks(&self, tile: usize) -> Marks {
        self.tiles.get(tile)
    }
}

#[cfg(test)]
mod tests;
