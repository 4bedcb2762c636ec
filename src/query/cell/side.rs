//! The walk over one side of a shell, tile by tile.

use glam::IVec3;

use crate::grid::side::Side;
use crate::query::cell::CellWalk;
use crate::query::cell::scratch::Hit;
use crate::query::cell::shell_scale::ShellScale;
use crate::query::cell::spans::{clear_span, set_span};
use crate::walk::SideFrustum;

/// One side of a shell as it is walked.
struct SidePass {
    index: usize,
    side: Side,
    frustum: SideFrustum,
    /// Coordinate of its cells along its axis: relative to V, and in the grid.
    depth: i32,
    at: i32,
    /// Words in a row, and the first of them in the grid.
    words: usize,
    first_word: usize,
    /// The bit of column 0 in a row.
    base: i32,
}

/// Cells of a side in the frustum.
#[derive(Default)]
struct CellCounts {
    total: u64,
    /// Those that are not hidden.
    in_sight: u64,
}

impl CellWalk<'_> {
    /// Walks one side of shell `m`. Returns the number of its cells in the frustum, and how many of
    /// them are not hidden, both without the parts where the grid contains nothing or the masks
    /// hide all: those are passed over.
    pub(super) fn side(&mut self, index: usize, m: i32, scale: &ShellScale) -> (u64, u64) {
        let side = Side::ALL[index];
        let (axes, v, depth) = (side.axes, self.shells.cell, m * side.sign);
        if self.remaining.is_done(index) {
            self.scratch.sides[index].clear();
            return (0, 0);
        }
        let Some(frustum) = self.begin_side(index, m) else { return (0, 0) };
        let record = self.record.is_some();
        let first_page = (v + side.cell(depth, 0, 0)).max(IVec3::ZERO) >> 6i32;
        if !record && self.plane_is_empty(axes.normal, first_page) {
            return (0, 0);
        }
        let mut cells = std::mem::take(&mut self.scratch.sides[index]);
        let mut hits = std::mem::take(&mut self.scratch.hits);
        let (c0, c1) = (cells.col0, cells.col0 + cells.cols - 1);
        let pass = SidePass {
            index,
            side,
            frustum,
            depth,
            at: v[axes.normal] + depth,
            words: cells.words,
            first_word: ((v[axes.col] + c0) >> 6) as usize,
            base: cells.offset as i32 - c0,
        };
        let mut counts = CellCounts::default();
        for number in 0..cells.bands.len() {
            let (first, last) = Self::rows_of_band(&cells, number);
            let page = (v + side.cell(depth, first, c0)) >> 6i32;
            if !record && self.row_is_empty(axes.col, page) {
                continue;
            }
            let part =
                if record { Some((c0, c1)) } else { self.open_part(index, scale, (first, last), (c0, c1)) };
            let Some(part) = part else {
                cells.hide_band(number);
                continue;
            };
            let brick = (v + side.cell(depth, first, part.0)) >> 3i32;
            let columns = (v[axes.col] + part.0, v[axes.col] + part.1);
            if !record && part != (c0, c1) && self.pages_are_empty(axes.col, brick, columns) {
                continue;
            }
            let band = cells.make_band(number);
            if !self.shells.frustum.meets(side.cell(depth, first, c0), side.cell(depth, last, c1)) {
                continue;
            }
            self.remaining.rows += i64::from(last - first + 1);
            let Some(cols) = self.open_rows(&pass, (first, last), part, band, scale, &mut counts) else {
                continue;
            };
            let fresh = self.block_tiles(&pass, first, cols, band, &mut hits);
            if fresh != 0 {
                cells.fresh.resize(cells.rows as usize, false);
                let skip = (v[axes.row] + first) & 7;
                let rows =
                    cells.fresh[(first - cells.row0) as usize..=(last - cells.row0) as usize].iter_mut();
                rows.zip(skip..).for_each(|(row, i)| *row = fresh >> i & 1 != 0);
            }
        }
        self.scratch.sides[index] = cells;
        for Hit { brick, tile, objects } in hits.drain(..) {
            if objects {
                self.find_objects(&side, brick, pass.at, tile, m, scale);
            } else {
                self.find_volumes(&side, brick, pass.at, tile, m);
            }
        }
        self.scratch.hits = hits;
        (counts.total, counts.in_sight)
    }

    /// Sets the bits of the cells of a band that are in the frustum and not hidden, of which the
    /// columns of `part` contain all. Returns the columns between which some are.
    #[inline(always)]
    fn open_rows(
        &mut self,
        pass: &SidePass,
        (first, last): (i32, i32),
        part: (i32, i32),
        band: &mut [u64],
        scale: &ShellScale,
        counts: &mut CellCounts,
    ) -> Option<(i32, i32)> {
        let (base, words) = (pass.base, pass.words);
        let skip = ((self.shells.cell[pass.side.axes.row] + first) & 7) as usize;
        let (mut left, mut right) = (i32::MAX, i32::MIN);
        for (row, line) in (first..=last).zip(band[skip * words..].chunks_mut(words)) {
            let Some((lo, hi)) = pass.frustum.row(row, part) else { continue };
            set_span(line, (base + lo) as usize, (base + hi) as usize + 1);
            counts.total += (hi - lo + 1) as u64;
            let mut seen = hi - lo + 1;
            self.scratch.masks.hidden_runs(pass.index, scale, row, (lo, hi), |a, b| {
                clear_span(line, (base + a) as usize, (base + b) as usize + 1);
                seen -= b - a + 1;
            });
            if self.record.is_some() {
                self.record_row(pass, row, (lo, hi), line);
            }
            counts.in_sight += seen as u64;
            if seen > 0 {
                (left, right) = (left.min(lo), right.max(hi));
            }
        }
        (left <= right).then_some((left, right))
    }

    /// Records the cells of a row between two columns, hidden where their bits are clear.
    fn record_row(&mut self, pass: &SidePass, row: i32, (lo, hi): (i32, i32), line: &[u64]) {
        let Some((visited, hidden)) = &mut self.record else { return };
        for col in lo..=hi {
            let c = self.shells.cell + pass.side.cell(pass.depth, row, col);
            visited.set(c);
            let bit = (pass.base + col) as usize;
            if line[bit / 64] >> (bit % 64) & 1 == 0 {
                hidden.set(c);
            }
        }
    }

    /// Looks up the tiles of a band between two columns, and clears the bits of opaque cells.
    /// Returns the rows with such cells, one bit each.
    #[inline(always)]
    fn block_tiles(
        &self,
        pass: &SidePass,
        first: i32,
        (left, right): (i32, i32),
        band: &mut [u64],
        hits: &mut Vec<Hit>,
    ) -> u8 {
        let (v, axes) = (self.shells.cell, pass.side.axes);
        let mut fresh = 0u8;
        let (mut b, end) = ((v[axes.col] + left) >> 3, (v[axes.col] + right) >> 3);
        while b <= end {
            let mut brick = IVec3::ZERO;
            (brick[axes.normal], brick[axes.row], brick[axes.col]) =
                (pass.at >> 3, (v[axes.row] + first) >> 3, b);
            let stop = end.min(b | 7);
            if self.page_is_empty(brick >> 3i32) {
                b = stop + 1;
                continue;
            }
            while b <= stop {
                brick[axes.col] = b;
                fresh |= self.block_tile(pass, brick, band, hits);
                b += 1;
            }
        }
        fresh
    }

    /// Looks up the tile of one brick.
    #[inline(always)]
    fn block_tile(&self, pass: &SidePass, brick: IVec3, band: &mut [u64], hits: &mut Vec<Hit>) -> u8 {
        let (scene, axes, at) = (self.scene, &pass.side.axes, pass.at);
        let shift = ((brick[axes.col] & 7) * 8) as u32;
        let word = (brick[axes.col] >> 3) as usize - pass.first_word;
        let mut tile = 0;
        for i in 0..8 {
            tile |= (band[i * pass.words + word] >> shift & 0xff) << (8 * i);
        }
        if tile == 0 {
            return 0;
        }
        let opaque = self.opaque.iter().fold(0, |all, opaque| all | opaque.tile(brick, axes, at));
        let objects = self.lists.tile(brick, axes, at) & tile;
        if objects != 0 {
            hits.push(Hit { brick, tile: objects, objects: true });
        }
        let volumes = scene.tbv_matrix().tile(brick, axes, at) & tile;
        if volumes != 0 {
            hits.push(Hit { brick, tile: volumes, objects: false });
        }
        let blocked = opaque & tile;
        let mut fresh = 0;
        if blocked != 0 {
            for i in 0..8 {
                let byte = blocked >> (8 * i) & 0xff;
                if byte != 0 {
                    band[i * pass.words + word] &= !(byte << shift);
                    fresh |= 1 << i;
                }
            }
        }
        fresh
    }
}
