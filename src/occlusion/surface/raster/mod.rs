//! The rasteriser of outlines: for each pixel whether an edge touches it, and its winding number.
//!
//! Pixels are kept in blocks of 32x8, a word for each row. Winding numbers are known modulo four:
//! two bits for each pixel. A number that is not zero is so modulo four, too, but for outlines that
//! go around a pixel four times: those are taken to leave it open.
//!
//! [`Raster`] is all that the rest of the crate sees: [`Raster::begin`] with an area,
//! [`Raster::edges`] with eight edges at a time or [`Raster::edge`] with one, [`Raster::finish`],
//! then [`Raster::marks`] block by block. The first is in single precision, eight rows at a time
//! ([`lanes`]), the other, for edges that reach far beyond the view, in double precision
//! ([`edge`]). Both keep three rules (pixels around a line can be marked with [`Raster::strip`],
//! too):
//!
//! - every pixel that comes within the edge's width of it is marked as touched;
//! - a pixel that no edge touches has the winding number of the outline around its middle;
//! - edges that follow each other pass the same rows where they meet, and an edge drawn for two
//!   patches passes the same columns for both, but where the marks say that it is not known: the
//!   seams between two patches rely on it.
//!
//! Edges above, below and right of the area change nothing. Those left of it need not be drawn
//! either: [`Raster::pass_left`] takes the rows whose middles they pass.

mod area;
mod edge;
mod edges;
mod lanes;
mod marks;
mod spans;
mod strip;

use std::ops::Range;

use crate::occlusion::surface::raster::marks::from_column;

pub(crate) use crate::occlusion::surface::raster::area::{Area, COLUMNS, TILES};
pub(crate) use crate::occlusion::surface::raster::edges::{Edges, LANES, Lanes, each};
pub(crate) use crate::occlusion::surface::raster::lanes::rows_passed;
pub(crate) use crate::occlusion::surface::raster::marks::{PixelMarks, Windings, tiles};
pub(crate) use crate::occlusion::surface::raster::spans::{FEW, Spans};

/// The pixels around one patch.
#[derive(Debug, Clone, Default)]
pub(crate) struct Raster {
    area: Area,
    /// The first pixel of the area, counted from the pixel that edges are counted from.
    corner: (i32, i32),
    /// Blocks in a row.
    across: usize,
    /// The blocks in use. Others have no marks, whatever they hold.
    spans: Spans,
    blocks: Vec<PixelMarks>,
    /// For each block, the numbers to add to it and to all blocks right of it; a bit for each row.
    carried: Vec<Windings>,
}

impl Raster {
    /// Clears the raster, for an area of pixels. The coordinates of edges are counted from the
    /// corner of pixel `first`, the first one of a tile.
    #[inline(always)]
    pub(crate) fn begin(&mut self, area: Area, first: (i64, i64)) {
        self.area = area;
        self.corner = ((area.x - first.0) as i32, (area.y - first.1) as i32);
        self.across = area.nx as usize;
        let count = area.block_count();
        if self.blocks.len() < count {
            self.blocks.resize(count, PixelMarks::default());
            self.carried.resize(count, Windings::default());
        }
        let all = self.spans.begin(&area);
        self.clear(all);
    }

    /// Clears blocks.
    #[inline(always)]
    fn clear(&mut self, blocks: Range<usize>) {
        self.blocks[blocks.clone()].fill(PixelMarks::default());
        self.carried[blocks].fill(Windings::default());
    }

    /// Takes blocks of a row into use, from one up to before another.
    #[inline(always)]
    fn take(&mut self, row: usize, from: usize, to: usize) {
        for fresh in self.spans.take(row, from, to) {
            if !fresh.is_empty() {
                self.clear(fresh);
            }
        }
    }

    /// Its area.
    #[inline(always)]
    pub(crate) fn area(&self) -> &Area {
        &self.area
    }

    /// Finds the winding numbers, when all edges are drawn.
    #[inline(always)]
    pub(crate) fn finish(&mut self) {
        for row in 0..self.area.ny as usize {
            let mut before = Windings::default();
            let columns = self.spans.columns(row);
            let end = columns.end;
            self.wind_columns(row, columns, &mut before);
            // An outline that goes around the rest of the row: no edge is there.
            if !before.is_zero() && end < self.across {
                self.take(row, end, self.across);
                self.wind_columns(row, end..self.across, &mut before);
            }
        }
    }

    /// Adds the numbers carried into blocks of a row, and those of blocks left of them.
    #[inline(always)]
    fn wind_columns(&mut self, row: usize, columns: Range<usize>, before: &mut Windings) {
        let blocks = row * self.across + columns.start.min(columns.end)..row * self.across + columns.end;
        for (block, carried) in self.blocks[blocks.clone()].iter_mut().zip(&self.carried[blocks]) {
            before.add(*carried);
            if !before.is_zero() {
                block.wind_all(*before, 0);
            }
        }
    }

    /// The marks of a block, by its place in the area, row by row.
    #[inline(always)]
    pub(crate) fn marks(&self, block: usize) -> &PixelMarks {
        if self.spans.has(block) { &self.blocks[block] } else { &PixelMarks::NONE }
    }

    /// The blocks in use, row by row, as columns: all others have no marks.
    #[inline(always)]
    pub(crate) fn spans(&self) -> &Spans {
        &self.spans
    }

    /// The marks of a block in use.
    #[inline(always)]
    pub(crate) fn marks_in_use(&self, row: usize, column: usize) -> &PixelMarks {
        &self.blocks[row * self.across + column]
    }

    /// Adds the winding numbers of edges left of the area, which has 32 rows at most: a bit for
    /// each row.
    #[inline(always)]
    pub(crate) fn pass_left(&mut self, passed: &Windings) {
        if passed.is_zero() {
            return;
        }
        for row in 0..(self.area.ny as usize).min(4) {
            self.take(row, 0, 1);
            let rows = |word: u32| word >> (row * LANES) & 0xff;
            let carried = &mut self.carried[row * self.across];
            carried.add(Windings { ones: rows(passed.ones), twos: rows(passed.twos) });
        }
    }

    /// Marks pixels of a row; both ends are included and inside the area.
    fn mark(&mut self, row: i32, first: i32, last: i32, layer: usize) {
        let (from, to) = (first / COLUMNS as i32, last / COLUMNS as i32);
        self.take(row as usize / LANES, from as usize, to as usize + 1);
        let start = row as usize / LANES * self.across;
        for block in from..=to {
            let pixels = run(first, last + 1, block);
            if let Some(marks) = self.blocks.get_mut(start + block as usize) {
                marks.mark_row(layer, row as usize % LANES, pixels);
            }
        }
    }

    /// Whether all pixels of some rows and columns are touched by open edges, ends included and
    /// inside the area.
    fn are_open(&self, rows: (i32, i32), columns: (i32, i32)) -> bool {
        (rows.0..=rows.1).all(|row| {
            (columns.0 / COLUMNS as i32..=columns.1 / COLUMNS as i32).all(|block| {
                let marks = self.marks(row as usize / LANES * self.across + block as usize);
                run(columns.0, columns.1 + 1, block) & !marks.open()[row as usize % LANES] == 0
            })
        })
    }

    /// Lets an outline pass the middle of a row left of the middle of a column of the area: the
    /// winding numbers from there on grow by one, or fall.
    fn pass(&mut self, row: i32, column: i32, falls: bool) {
        let from = (column / COLUMNS as i32) as usize;
        self.take(row as usize / LANES, from, from + 2);
        let block = row as usize / LANES * self.across + from;
        let row = row as usize % LANES;
        if let Some(marks) = self.blocks.get_mut(block) {
            marks.wind_row(row, from_column(column % COLUMNS as i32), falls);
        }
        if !(block + 1).is_multiple_of(self.across) {
            self.carried[block + 1].step(1 << row, falls);
        }
    }
}

/// The pixels of a block's row from a column of the area up to before another one.
#[inline(always)]
fn run(begin: i32, end: i32, block: i32) -> u32 {
    let left = block * COLUMNS as i32;
    let within = |column: i32| (column - left).clamp(0, COLUMNS as i32);
    from_column(within(begin)) & !from_column(within(end))
}

#[cfg(test)]
mod tests;
