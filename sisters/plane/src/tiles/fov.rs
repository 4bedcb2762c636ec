//! The field of view of an eye: a bit for each tile.

use std::ops::Range;

use glam::UVec2;

use crate::bits::{BitGrid, fill};
use crate::error::Error;
use crate::tiles::octant::{Octant, Sink};
use crate::tiles::opaque::{OpaqueTiles, add_transposed};
use crate::tiles::options::{FovOptions, TilePoint};
use crate::tiles::sweep::Sweep;
use crate::tiles::tile_sweep::TileSweep;

type Found<'a> = Result<&'a BitGrid, Error>;

/// Finds the tiles that an eye sees, exactly.
///
/// A tile is seen if rays from the eye reach it in some range of directions, however narrow: a part
/// of its inside if it is free, a part of its border if it is opaque. So walls are seen, rays that
/// only graze do not count, and two opaque tiles that touch at a corner let nothing through. Tiles
/// beyond the range or outside of the sector of [`FovOptions`] are not seen.
///
/// An opaque tile that has the eye inside does not block. An eye on the border of an opaque tile
/// does not see through it.
///
/// Keeps its memory from run to run: have one for each thread. Takes two bits a tile of the map.
///
/// ```
/// use casca_plane::{BitGrid, FieldOfView, FovOptions, OpaqueTiles, TilePoint};
///
/// let mut walls = BitGrid::new(7, 3);
/// walls.set(3, 1, true);
/// let mut fov = FieldOfView::new();
/// let seen = fov.run(&OpaqueTiles::new(walls), TilePoint::center_of(0, 1), &FovOptions::default());
/// assert!(seen.get(3, 1) && !seen.get(4, 1) && seen.get(6, 0));
/// ```
#[derive(Debug, Clone, Default)]
pub struct FieldOfView {
    sweep: Sweep,
    tile_sweep: TileSweep,
    rows: Marks,
    columns: Marks,
}

impl FieldOfView {
    /// A field of view that sees nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The tiles that are seen from `eye`.
    ///
    /// Costs the rows in sight, the words of 64 tiles that are seen in them, and the free intervals
    /// of directions in each row: 1 to 4 microseconds in rooms and caves that the cache holds, less
    /// than 200 on a field of 1024 by 1024 tiles with rocks. A map of other dimensions than that of
    /// the last run costs new memory.
    pub fn run(&mut self, opaque: &OpaqueTiles, eye: TilePoint, options: &FovOptions) -> &BitGrid {
        self.sweep_all(opaque, Eyes::At(eye.units()), options)
    }

    /// The tiles that are seen from anywhere in a tile of the map, its border included: a result
    /// for all viewers in the tile, or for one that moves in it. Exact: each tile that [`Self::run`]
    /// finds for one of these eyes, and no others.
    ///
    /// Only where more than 512 groups of lines cross a row in an eighth of all directions, tiles
    /// that no eye sees may be among them: open ground of 4096 by 4096 tiles with a rock in every
    /// 1000 has 258, other maps a few. The range of the options is counted from the nearest eye.
    /// Their sector is not regarded: its apex could be anywhere in the tile.
    ///
    /// Costs the tiles in sight in all groups of lines: two to three times [`Self::run`] in rooms.
    ///
    /// # Errors
    /// A tile that the map does not have.
    pub fn run_from_tile(&mut self, opaque: &OpaqueTiles, x: u32, y: u32, options: &FovOptions) -> Found<'_> {
        let (tile, size) = (UVec2::new(x, y), UVec2::new(opaque.width(), opaque.height()));
        if tile.cmpge(size).any() {
            return Err(Error::Outside { tile, size });
        }
        Ok(self.sweep_all(opaque, Eyes::In([x, y]), options))
    }

    /// As [`Self::run_from_tile`], but not from the corners of the tile, which look out between two
    /// opaque tiles where no line passes: of two free tiles, each sees the other or neither does.
    ///
    /// # Errors
    /// As [`Self::run_from_tile`].
    pub fn run_symmetric(&mut self, opaque: &OpaqueTiles, x: u32, y: u32, options: &FovOptions) -> Found<'_> {
        self.tile_sweep.corners = false;
        let found = self.run_from_tile(opaque, x, y, options).map(drop);
        self.tile_sweep.corners = true;
        found.map(|()| self.seen())
    }

    fn sweep_all(&mut self, opaque: &OpaqueTiles, eyes: Eyes, options: &FovOptions) -> &BitGrid {
        self.rows.clear(opaque.bits());
        self.columns.clear(opaque.columns());
        let mut sweeps = (&mut self.sweep, &mut self.tile_sweep);
        for (marks, tiles, turned) in
            [(&mut self.rows, opaque.bits(), false), (&mut self.columns, opaque.columns(), true)]
        {
            for octant in Octant::four(turned) {
                match octant.flip_x {
                    true => mark_octant::<true>(marks, &mut sweeps, tiles, octant, eyes, options),
                    false => mark_octant::<false>(marks, &mut sweeps, tiles, octant, eyes, options),
                }
            }
        }
        let turned = &self.columns;
        add_transposed(&turned.bits, &mut self.rows.bits, turned.columns.clone(), turned.rows.clone());
        self.rows.widen(turned.rows.clone(), turned.columns.clone());
        &self.rows.bits
    }

    /// The tiles that the last run found.
    pub fn seen(&self) -> &BitGrid {
        &self.rows.bits
    }

    /// Columns and rows that hold all tiles that the last run found.
    pub fn bounds(&self) -> (Range<u32>, Range<u32>) {
        (self.rows.columns.clone(), self.rows.rows.clone())
    }
}

/// Tiles that are marked, and the columns and rows that hold them.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Marks {
    pub bits: BitGrid,
    pub columns: Range<u32>,
    pub rows: Range<u32>,
}

impl Marks {
    /// Clears all marks. There is one for each bit of `like` then.
    pub fn clear(&mut self, like: &BitGrid) {
        if (self.bits.width(), self.bits.height()) != (like.width(), like.height()) {
            self.bits = BitGrid::new(like.width(), like.height());
        } else if !self.columns.is_empty() {
            let words = self.columns.start as usize / 64..(self.columns.end as usize).div_ceil(64);
            for y in self.rows.clone() {
                self.bits.row_mut(y)[words.clone()].fill(0);
            }
        }
        (self.columns, self.rows) = (0..0, 0..0);
    }

    /// Marks lie in these columns and rows, too.
    pub fn widen(&mut self, columns: Range<u32>, rows: Range<u32>) {
        let union = |a: &Range<u32>, b: Range<u32>| match a.is_empty() {
            true => b,
            false => a.start.min(b.start)..a.end.max(b.end),
        };
        if !columns.is_empty() && !rows.is_empty() {
            self.columns = union(&self.columns, columns);
            self.rows = union(&self.rows, rows);
        }
    }
}

/// Who looks.
#[derive(Clone, Copy)]
enum Eyes {
    /// One eye, in units of positions.
    At([i64; 2]),
    /// All eyes in a tile.
    In([u32; 2]),
}

/// Marks the tiles that are seen in an octant. `MIRROR` is its `flip_x`.
fn mark_octant<const MIRROR: bool>(
    marks: &mut Marks,
    (sweep, tile_sweep): &mut (&mut Sweep, &mut TileSweep),
    tiles: &BitGrid,
    octant: Octant,
    eyes: Eyes,
    options: &FovOptions,
) {
    let none = Range { start: usize::MAX, end: 0 };
    let (bits, flip_y) = (&mut marks.bits, octant.flip_y);
    let mut marker = Marker::<MIRROR> { bits, flip_y, y: 0, columns: none.clone(), rows: none };
    match eyes {
        Eyes::At(eye) => sweep.run::<MIRROR>(tiles, octant, eye, options, &mut marker),
        Eyes::In(tile) => tile_sweep.run::<MIRROR>(tiles, octant, tile, options.range, &mut marker),
    }
    let (columns, rows) = marker.bounds();
    marks.widen(columns, rows);
}

/// Marks the tiles of an octant.
struct Marker<'a, const MIRROR: bool> {
    bits: &'a mut BitGrid,
    flip_y: bool,
    /// The row at hand, of the map.
    y: u32,
    columns: Range<usize>,
    /// Rows of the octant.
    rows: Range<usize>,
}

impl<const MIRROR: bool> Marker<'_, MIRROR> {
    /// The columns and rows of the map that hold the marks.
    fn bounds(&self) -> (Range<u32>, Range<u32>) {
        let part = |range: &Range<usize>, size: u32, flip: bool| {
            let (start, end) = (range.start as u32, range.end as u32);
            match (range.is_empty(), flip) {
                (true, _) => 0..0,
                (false, false) => start..end,
                (false, true) => size - end..size - start,
            }
        };
        (part(&self.columns, self.bits.width(), MIRROR), part(&self.rows, self.bits.height(), self.flip_y))
    }
}

impl<const MIRROR: bool> Sink for Marker<'_, MIRROR> {
    #[inline]
    fn begin_row(&mut self, row: usize) {
        self.y = if self.flip_y { self.bits.height() - 1 - row as u32 } else { row as u32 };
        self.rows = self.rows.start.min(row)..row + 1;
    }

    #[inline(always)]
    fn seen(&mut self, from: usize, end: usize) {
        self.columns = self.columns.start.min(from)..self.columns.end.max(end);
        let width = self.bits.width() as usize;
        let (first, end) = if MIRROR { (width - end, width - from) } else { (from, end) };
        fill(self.bits.row_mut(self.y), first, end);
    }
}
