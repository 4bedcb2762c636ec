//! A square of 32x32 pixels, a word for each row: the rasteriser of edges that were chosen for it.
//!
//! The rules of [`Raster`](crate::occlusion::surface::raster::Raster) hold here, too. Edges are drawn
//! in eight rows at a time. Those that pass left of the square are not drawn, but counted by the
//! rows whose middles they pass ([`Passed`]); those on its other sides are left out.

use crate::numeric::{greater, lesser};
use crate::occlusion::surface::raster::lanes::{Edges, LANES, Lanes, Line, Lines, each, nearest};
use crate::occlusion::surface::raster::{Marks, Raster};
use crate::occlusion::tiles::TILE;

/// Pixels along each side of the square.
pub(crate) const SQUARE: i32 = 32;

/// Tiles along each side of the square.
const TILES: usize = SQUARE as usize / TILE as usize;

/// Blocks of eight rows.
const BLOCKS: usize = SQUARE as usize / LANES;

/// Eight rows of the square; bit i of a word is column i.
type Block = [u32; LANES];

/// The pixels of a layer of marks in eight rows.
type Layers = [Block; 4];

/// The pixels of a word from a column on: none from column 32 on.
#[inline(always)]
fn from_column(column: i32) -> u32 {
    // Shifts by 32 are two of half as much.
    (u32::MAX << (column >> 1)) << ((column + 1) >> 1)
}

/// Adds winding numbers modulo four, given by their two digits, to others.
#[inline(always)]
fn wind((ones, twos): (&mut u32, &mut u32), (one, two): (u32, u32)) {
    *twos ^= two ^ (*ones & one);
    *ones ^= one;
}

/// For each row of the square, the winding number of the edges left of it: the two digits of it, as
/// bits of two words.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Passed {
    ones: u32,
    twos: u32,
}

impl Passed {
    /// Whether no row has a winding number.
    pub(crate) fn is_zero(&self) -> bool {
        self.ones | self.twos == 0
    }

    /// Lets the edges `lanes` pass on the left of a square, whose corner is given.
    #[inline(always)]
    pub(crate) fn add(&mut self, edges: &Edges, mut lanes: u8, corner: (i32, i32), fall: bool) {
        let row = |y: f32| (nearest(y) - corner.1).clamp(0, SQUARE);
        while lanes != 0 {
            let i = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            let (a, b) = (row(edges.y0[i]), row(edges.y1[i]));
            let falls = (edges.y0[i] > edges.y1[i]) != fall;
            let rows = from_column(a.min(b)) & !from_column(a.max(b));
            wind((&mut self.ones, &mut self.twos), (rows, if falls { rows } else { 0 }));
        }
    }
}

/// The marks of a square's pixels.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SquareMarks {
    blocks: [Layers; BLOCKS],
}

/// One row of tiles of a layer.
pub(crate) type TileWords = [u64; TILES];

impl SquareMarks {
    /// Draws edges, in pixels that are counted as those of `corner`, the square's first one. Going up,
    /// they make the winding numbers to their right grow by one, or fall.
    #[inline(never)]
    pub(crate) fn edges(&mut self, edges: &Edges, corner: (i32, i32), fall: bool) {
        let l = Lines::new(edges);
        let mut lanes = edges.plain;
        while lanes != 0 {
            let i = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            let (first, last) = l.rows(i);
            let (first, last) = ((first - corner.1).max(0), (last - corner.1).min(SQUARE - 1));
            if first <= last {
                let line = Line::new(&l, i, edges.seams >> i & 1 == 1, fall, corner);
                self.line(&line, (first, last), corner);
            }
        }
    }

    /// Draws one edge in the rows that it touches.
    #[inline(always)]
    fn line(&mut self, line: &Line, (first, last): (i32, i32), corner: (i32, i32)) {
        for block in first as usize / LANES..=last as usize / LANES {
            self.line_in_block(line, (first, last), block, corner);
        }
    }

    /// Draws one edge in those of eight rows that it touches.
    #[inline(always)]
    fn line_in_block(&mut self, line: &Line, (first, last): (i32, i32), block: usize, corner: (i32, i32)) {
        let row = (block * LANES) as i32;
        let (left, right) = (corner.0 as f32, (corner.0 + SQUARE) as f32);
        let rows: [i32; LANES] = each(|k| row + k as i32);
        let at: Lanes = each(|k| line.at((rows[k] + corner.1) as f32 + 0.5));
        let spans: [(f32, f32); LANES] = each(|k| line.span(at[k]));
        // One beyond the last column, and the first column; the same where there are none.
        let end: [i32; LANES] = each(|k| {
            let is_touched = (rows[k] >= first) & (rows[k] <= last);
            let end = nearest(lesser(greater(spans[k].1, left - 1.0), right - 1.0)) + 1 - corner.0;
            if is_touched { end } else { 0 }
        });
        let begin: [i32; LANES] = each(|k| {
            let begin = nearest(lesser(greater(spans[k].0, left), right)) - corner.0;
            if begin < end[k] { begin } else { end[k] }
        });
        let column: [i32; LANES] = each(|k| {
            let is_passed = (rows[k] >= line.from) & (rows[k] < line.to);
            let column = nearest(lesser(greater(line.passes(at[k]), left), right)) - corner.0;
            if is_passed { column } else { SQUARE }
        });
        let layers = &mut self.blocks[block];
        let touched: Block = each(|k| from_column(begin[k]) & !from_column(end[k]));
        let layer = &mut layers[line.layer & 1];
        *layer = each(|k| layer[k] | touched[k]);
        let passed: Block = each(|k| from_column(column[k]));
        let [open, _, ones, twos] = layers;
        let carried: Block = each(|k| if line.falls { passed[k] } else { 0 } ^ (ones[k] & passed[k]));
        *twos = each(|k| twos[k] ^ carried[k]);
        *ones = each(|k| ones[k] ^ passed[k]);
        for k in (0..LANES).filter(|&k| !line.is_sure(at[k]) && line.from <= rows[k] && rows[k] < line.to) {
            let (lo, hi) = line.doubted(at[k]);
            let column = |c: i32| (c - corner.0).clamp(0, SQUARE);
            open[k] |= from_column(column(lo)) & !from_column(column(hi + 1));
        }
    }

    /// Adds the winding numbers of the edges left of the square.
    #[inline]
    pub(crate) fn pass(&mut self, passed: &Passed) {
        if passed.is_zero() {
            return;
        }
        for (b, [_, _, ones, twos]) in self.blocks.iter_mut().enumerate() {
            for k in 0..LANES {
                let digit = |word: u32| if word >> (b * LANES + k) & 1 == 1 { u32::MAX } else { 0 };
                wind((&mut ones[k], &mut twos[k]), (digit(passed.ones), digit(passed.twos)));
            }
        }
    }

    /// Adds the marks of another patch.
    #[inline]
    pub(crate) fn add(&mut self, other: &Self) {
        for (own, other) in self.blocks.iter_mut().zip(&other.blocks) {
            let ([open, seam, ones, twos], [other_open, other_seam, one, two]) = (own, other);
            for k in 0..LANES {
                open[k] |= other_open[k];
                seam[k] |= other_seam[k];
                wind((&mut ones[k], &mut twos[k]), (one[k], two[k]));
            }
        }
    }

    /// Adds the marks of a raster whose area is the square.
    pub(crate) fn add_raster(&mut self, raster: &Raster) {
        for tile in 0..TILES * TILES {
            let layers = raster.marks(tile).layers();
            let shift = (tile % TILES) as i64 * TILE;
            let own = &mut self.blocks[tile / TILES];
            for k in 0..LANES {
                let word = |layer: u64| ((layer >> (TILE as usize * k) & 0xff) as u32) << shift;
                own[Marks::OPEN][k] |= word(layers[0]);
                own[Marks::SEAM][k] |= word(layers[1]);
                let [_, _, ones, twos] = own;
                wind((&mut ones[k], &mut twos[k]), (word(layers[2]), word(layers[3])));
            }
        }
    }

    /// The pixels that the outline covers as a whole, tile by tile in a row of them.
    #[inline]
    pub(crate) fn covered(&self, row: usize) -> TileWords {
        let [open, seam, ones, twos] = &self.blocks[row];
        tiles(&each(|k| (ones[k] | twos[k]) & !(open[k] | seam[k])))
    }

    /// Of the marks of several patches: the pixels touched by seams only that the patches cover
    /// together.
    #[inline]
    pub(crate) fn covered_seams(&self, row: usize) -> TileWords {
        let [open, seam, ones, twos] = &self.blocks[row];
        tiles(&each(|k| seam[k] & (ones[k] | twos[k]) & !open[k]))
    }

    /// The tiles of a row of them with any marks, one bit each.
    #[inline]
    pub(crate) fn marked(&self, row: usize) -> u8 {
        let any = self.blocks[row].iter().flatten().fold(0, |any, word| any | word);
        (0..TILES).fold(0, |bits, tile| bits | u8::from(any >> (TILE as usize * tile) & 0xff != 0) << tile)
    }
}

/// The tiles of eight rows of words.
#[inline]
fn tiles(rows: &Block) -> TileWords {
    if rows.iter().fold(0, |any, row| any | row) == 0 {
        return [0; TILES];
    }
    let bytes = rows.map(u32::to_le_bytes);
    std::array::from_fn(|tile| u64::from_le_bytes(std::array::from_fn(|row| bytes[row][tile])))
}
