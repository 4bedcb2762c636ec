//! The rasteriser of outlines: for each pixel whether an edge touches it, and its winding number.
//!
//! Pixels are kept in blocks of 32x8, a word for each row. Winding numbers are known modulo four:
//! two bits for each pixel. A number that is not zero is so modulo four, too, but for outlines that
//! go around a pixel four times: those are taken to leave it open.
//!
//! [`Raster`] is all that the rest of the crate sees: [`Raster::begin`] with an area,
//! [`Raster::edges`] with eight edges at a time, then block by block [`Raster::marks`], to which the
//! sum of the heads up to the block's adds the edges left of it. Edges are drawn in single
//! precision, in eight rows at a time ([`lanes`]). They keep three rules (pixels around a line can
//! be marked with [`Raster::strip`], too):
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
mod edges;
mod lanes;
mod marks;
mod strip;

use std::ops::Range;

use crate::occlusion::surface::raster::marks::from_column;

pub(crate) use crate::occlusion::surface::raster::area::{Area, COLUMNS, TILES};
pub(crate) use crate::occlusion::surface::raster::edges::{EdgeVectors, Edges, LANES, Lanes};
pub(crate) use crate::occlusion::surface::raster::lanes::rows_passed;
pub(crate) use crate::occlusion::surface::raster::marks::{Head, PixelMarks, Windings, tiles};

/// No column of blocks.
const NONE: (u32, u32) = (u32::MAX, 0);

/// The pixels around one patch.
#[derive(Debug, Clone, Default)]
pub(crate) struct Raster {
    area: Area,
    /// The first pixel of the area, counted from the pixel that edges are counted from.
    corner: (i32, i32),
    /// Blocks in a row.
    across: usize,
    /// For each row of blocks, the columns with heads in use, up to before the second number. All
    /// other heads are zero: long, slanted patches leave most blocks of their areas alone.
    rows: Vec<(u32, u32)>,
    heads: Vec<Head>,
    /// Those of blocks without marks hold anything.
    blocks: Vec<PixelMarks>,
}

impl Raster {
    /// Clears the raster, for an area of pixels. The coordinates of edges are counted from the
    /// corner of pixel `first`, the first one of a tile.
    #[inline(always)]
    pub(crate) fn begin(&mut self, area: Area, first: (i64, i64)) {
        for (row, &(from, to)) in self.rows.iter().enumerate().filter(|(_, row)| **row != NONE) {
            let start = row * self.across;
            self.heads[start + from as usize..start + to as usize].fill(Head::default());
        }
        self.area = area;
        self.corner = ((area.x - first.0) as i32, (area.y - first.1) as i32);
        self.across = area.nx as usize;
        self.rows.clear();
        self.rows.resize(area.ny as usize, NONE);
        let count = area.block_count();
        if self.blocks.len() < count {
            self.blocks.resize(count, PixelMarks::NONE);
            self.heads.resize(count, Head::default());
        }
    }

    /// A block, to be marked. The head of the next one is in use then, too.
    #[inline(always)]
    fn block(&mut self, row: usize, column: usize) -> Option<&mut PixelMarks> {
        let at = row * self.across + column;
        let (head, marks) = (self.heads.get_mut(at)?, self.blocks.get_mut(at)?);
        if !head.is_marked() {
            head.mark();
            *marks = PixelMarks::NONE;
            let (from, to) = self.rows.get_mut(row)?;
            *from = (*from).min(column as u32);
            *to = (*to).max((column + 2).min(self.across) as u32);
        }
        Some(marks)
    }

    /// Lets outlines pass rows of blocks left of a block, of which the last one is marked.
    #[inline(always)]
    fn carry(&mut self, row: usize, column: usize, passed: Head) {
        if column < self.across
            && let Some(head) = self.heads.get_mut(row * self.across + column)
        {
            head.add(passed);
        }
    }

    /// Lets outlines pass rows of blocks left of the area.
    #[inline(always)]
    fn pass_beside(&mut self, row: usize, passed: Head) {
        if let Some((from, to)) = self.rows.get_mut(row) {
            (*from, *to) = (0, (*to).max(1));
            self.carry(row, 0, passed);
        }
    }

    /// The borders of the area along both axes, as edges are counted.
    pub(crate) fn borders(&self) -> ((f64, f64), (f64, f64)) {
        let (left, low) = self.corner;
        let along = |first: i32, count: i32| (first.into(), (first + count).into());
        (along(left, self.area.width()), along(low, self.area.height()))
    }

    /// Its area.
    #[inline(always)]
    pub(crate) fn area(&self) -> &Area {
        &self.area
    }

    /// The columns of blocks in a row with anything in their heads.
    #[inline(always)]
    pub(crate) fn columns(&self, row: usize) -> Range<usize> {
        let (from, to) = self.rows[row];
        from as usize..to as usize
    }

    /// What is known of a block, by its place in the area, row by row.
    #[inline(always)]
    pub(crate) fn head(&self, block: usize) -> Head {
        self.heads[block]
    }

    /// The marks of a block, likewise, without the numbers of edges left of it.
    #[inline(always)]
    pub(crate) fn marks(&self, block: usize) -> &PixelMarks {
        if self.heads[block].is_marked() { &self.blocks[block] } else { &PixelMarks::NONE }
    }

    /// The marks of a block with the numbers of edges left of it.
    #[cfg(test)]
    pub(crate) fn whole(&self, block: usize) -> PixelMarks {
        let mut before = Head::default();
        (block / self.across * self.across..=block).for_each(|at| before.add(self.heads[at]));
        self.marks(block).passed(before)
    }

    /// Adds the winding numbers of edges left of the area, which has 32 rows at most: a bit for
    /// each row.
    #[inline(always)]
    pub(crate) fn pass_left(&mut self, passed: &Windings) {
        if !passed.is_zero() {
            (0..self.rows.len().min(4)).for_each(|row| self.pass_beside(row, passed.rows(row * LANES)));
        }
    }

    /// Marks pixels of a row; both ends are included and inside the area.
    fn mark(&mut self, row: i32, first: i32, last: i32, layer: usize) {
        for block in first / COLUMNS as i32..=last / COLUMNS as i32 {
            if let Some(marks) = self.block(row as usize / LANES, block as usize) {
                marks.mark_row(layer, row as usize % LANES, run(first, last + 1, block));
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

    /// Marks all pixels as touched by open edges.
    pub(crate) fn open_all(&mut self) {
        (0..self.area.height()).for_each(|row| self.mark(row, 0, self.area.width() - 1, PixelMarks::OPEN));
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
