//! One side of a shell, walked band by band and tile by tile.

use glam::IVec3;

use crate::grid::side::Side;
use crate::matrix::bits::BitMatrix;
use crate::query::cell::mask::DirectionMask;
use crate::query::cell::matrices::CellMatrices;
use crate::query::cell::shell_scale::ShellScale;
use crate::walk::SideFrustum;

/// The matrices of visited and of hidden cells, if they are recorded.
pub(crate) type Recorded<'a> = Option<(&'a mut BitMatrix, &'a mut BitMatrix)>;

/// The objects or the surfaces of volumes in a tile of cells in sight.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hit {
    pub(super) brick: IVec3,
    pub(super) tile: u64,
    /// Whether objects, not volumes, are in the tile.
    pub(super) objects: bool,
}

/// Cells of a side in the frustum.
#[derive(Default)]
pub(super) struct CellCounts {
    pub(super) total: u64,
    /// Those that are not hidden.
    pub(super) in_sight: u64,
}

/// One side of a shell as it is walked.
pub(super) struct SidePass<'a> {
    pub(super) side: Side,
    pub(super) scale: &'a ShellScale,
    pub(super) frustum: SideFrustum,
    pub(super) mask: &'a DirectionMask,
    /// The viewer's cell V.
    pub(super) cell: IVec3,
    /// Coordinate of its cells along its axis, in the grid.
    pub(super) at: i32,
    /// Words in a row, and the first of them in the grid.
    pub(super) words: usize,
    pub(super) first_word: i32,
    /// The bit of column 0 in a row.
    pub(super) base: i32,
}

impl SidePass<'_> {
    /// Sets the bits of the cells of a band that are in the frustum and not hidden, of which the
    /// columns of `part` contain all. Returns the columns between which some are.
    #[inline(always)]
    pub(super) fn open_rows(
        &self,
        (first, last): (i32, i32),
        part: (i32, i32),
        band: &mut [u64],
        counts: &mut CellCounts,
        record: &mut Recorded,
    ) -> Option<(i32, i32)> {
        let words = self.words;
        let skip = ((self.cell[self.side.axes.row] + first) & 7) as usize;
        let (mut left, mut right) = (i32::MAX, i32::MIN);
        for (row, line) in (first..=last).zip(band[skip * words..].chunks_mut(words)) {
            let Some((lo, hi)) = self.frustum.row(row, part) else { continue };
            let seen = self.mask.open_cells(self.scale, row, (lo, hi), self.base, line);
            if record.is_some() {
                self.record_row(row, (lo, hi), line, record);
            }
            counts.total += (hi - lo + 1) as u64;
            counts.in_sight += seen as u64;
            if seen > 0 {
                (left, right) = (left.min(lo), right.max(hi));
            }
        }
        (left <= right).then_some((left, right))
    }

    /// Records the cells of a row between two columns, hidden where their bits are clear.
    fn record_row(&self, row: i32, (lo, hi): (i32, i32), line: &[u64], record: &mut Recorded) {
        let Some((visited, hidden)) = record else { return };
        let depth = self.at - self.cell[self.side.axes.normal];
        for col in lo..=hi {
            let c = self.cell + self.side.cell(depth, row, col);
            visited.set(c);
            let bit = (self.base + col) as usize;
            if line[bit / 64] >> (bit % 64) & 1 == 0 {
                hidden.set(c);
            }
        }
    }

    /// Looks up the tiles of a band between two columns, and clears the bits of opaque cells.
    /// Returns the rows with such cells, one bit each.
    #[inline(always)]
    pub(super) fn block_tiles(
        &self,
        matrices: &CellMatrices,
        first: i32,
        (left, right): (i32, i32),
        band: &mut [u64],
        hits: &mut Vec<Hit>,
    ) -> u8 {
        let (v, axes) = (self.cell, self.side.axes);
        let mut fresh = 0u8;
        let (mut b, end) = ((v[axes.col] + left) >> 3, (v[axes.col] + right) >> 3);
        while b <= end {
            let mut brick = IVec3::ZERO;
            (brick[axes.normal], brick[axes.row], brick[axes.col]) =
                (self.at >> 3, (v[axes.row] + first) >> 3, b);
            let stop = end.min(b | 7);
            if !matrices.page_is_empty(brick >> 3i32) {
                for b in b..=stop {
                    brick[axes.col] = b;
                    fresh |= self.block_tile(matrices, brick, band, hits);
                }
            }
            b = stop + 1;
        }
        fresh
    }

    /// Looks up the tile of one brick.
    #[inline(always)]
    fn block_tile(&self, matrices: &CellMatrices, brick: IVec3, band: &mut [u64], hits: &mut Vec<Hit>) -> u8 {
        let (axes, at) = (&self.side.axes, self.at);
        let shift = ((brick[axes.col] & 7) * 8) as u32;
        let word = ((brick[axes.col] >> 3) - self.first_word) as usize;
        let mut tile = 0;
        for i in 0..8 {
            tile |= (band[i * self.words + word] >> shift & 0xff) << (8 * i);
        }
        if tile == 0 {
            return 0;
        }
        let opaque = matrices.opaque.iter().fold(0, |all, opaque| all | opaque.tile(brick, axes, at));
        let objects = matrices.lists.tile(brick, axes, at) & tile;
        if objects != 0 {
            hits.push(Hit { brick, tile: objects, objects: true });
        }
        let volumes = matrices.volumes.tile(brick, axes, at) & tile;
        if volumes != 0 {
            hits.push(Hit { brick, tile: volumes, objects: false });
        }
        let blocked = opaque & tile;
        let mut fresh = 0;
        if blocked != 0 {
            for i in 0..8 {
                let byte = blocked >> (8 * i) & 0xff;
                if byte != 0 {
                    band[i * self.words + word] &= !(byte << shift);
                    fresh |= 1 << i;
                }
            }
        }
        fresh
    }
}
