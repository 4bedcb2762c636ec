//! The sweep of an octant for all eyes in a tile: which tiles any of them may see.
//!
//! What hides a point from the centre of the tile, after the opaque tiles have shrunk by half a
//! tile on every side, hides it from all of the tile: for a point of the shrunk solid on the ray
//! from the centre, the point at the same share of any other ray lies in the solid (Wonka, Wimmer
//! and Schmalstieg 2000). Opaque tiles shrink to the segments between the centres of neighbours
//! that are both opaque. The area between four of them need not be known: rays end at the segments
//! around it.
//!
//! Lengths are in halves of a tile from the centre of the eyes' tile. Rows are half as high as
//! tiles, so that rays cross the segments along a row at even rows, and the borders of tiles at odd
//! ones.

use crate::bits::BitGrid;
use crate::numeric::tiles::TILE;
use crate::tiles::octant::Octant;
use crate::tiles::options::Range;
use crate::tiles::ray::{Beam, Ray, Sink};
use crate::tiles::scan::Row;
use crate::tiles::sweep::Sweep;

/// What stays the same in the rows of an octant.
struct Frame<'a, const MIRROR: bool> {
    tiles: &'a BitGrid,
    /// The tile of the eyes, in the octant's columns and rows.
    column: i64,
    row: i64,
    flip_y: bool,
    range: Option<Range>,
}

impl Sweep {
    /// Tells a sink what eyes in a tile of the map may see in an octant. `tiles` are those of the
    /// map, turned if the octant is; `MIRROR` is its `flip_x`. The map has the tile.
    pub fn run_from_tile<const MIRROR: bool>(
        &mut self,
        tiles: &BitGrid,
        octant: Octant,
        tile: [u32; 2],
        range: Option<Range>,
        sink: &mut impl Sink,
    ) {
        // The centre, as the octant sees it.
        let center = tile.map(|at| i64::from(at) * TILE + TILE / 2);
        let [column, row] = octant.eye(center, [tiles.width(), tiles.height()]).map(|at| at.div_euclid(TILE));
        let frame = Frame::<MIRROR> { tiles, column, row, flip_y: octant.flip_y, range };
        let steep = Ray::through(0, 0, 1);
        let flat = Ray::through(0, 1, 1);
        self.open.clear();
        self.open.push((steep, flat));
        for half in 0.. {
            let row = row + (half + 1) / 2;
            let Some(end) = frame.end(row).filter(|_| !self.open.is_empty()) else { break };
            if half > 0 && half % 2 == 0 {
                self.next.clear();
                frame.cross_line(half, end, &self.open, &mut self.next);
                std::mem::swap(&mut self.open, &mut self.next);
            }
            self.next.clear();
            sink.begin_row(row as usize);
            frame.cross_row(half, end, &self.open, &mut self.next, sink);
            std::mem::swap(&mut self.open, &mut self.next);
        }
    }
}

impl<const MIRROR: bool> Frame<'_, MIRROR> {
    fn bits(&self, row: i64) -> Row<'_, MIRROR> {
        let height = self.tiles.height();
        let y = if self.flip_y { height - 1 - row as u32 } else { row as u32 };
        Row { words: self.tiles.row(y), width: self.tiles.width() as usize }
    }

    /// The column after the last one of a row that may be seen. `None` if the row and all that
    /// follow are out of range or outside.
    fn end(&self, row: i64) -> Option<i64> {
        let (width, height) = (i64::from(self.tiles.width()), i64::from(self.tiles.height()));
        if row >= height {
            return None;
        }
        // From the nearest eyes: those on the border of the tile.
        let (aside, ahead) = ((self.column + 1) * TILE, (row - self.row - 1).max(0) * TILE);
        self.range.map_or(Some(width), |range| range.end(aside, ahead).map(|end| end.min(width)))
    }

    /// The column of the tile that holds the half tile right of a line, and begins at it or half a
    /// tile before.
    fn tile_at(&self, line: i64) -> i64 {
        self.column + (line + 1).div_euclid(2)
    }

    /// The line through the centres of a column.
    fn center(&self, column: usize) -> i64 {
        2 * (column as i64 - self.column)
    }

    /// Cuts beams by the segments along a row, at the centres of its tiles.
    fn cross_line(&self, half: i64, end: i64, open: &[Beam], next: &mut Vec<Beam>) {
        let bits = self.bits(self.row + half / 2);
        for &(low, high) in open {
            let mut left = low;
            // Segments begin at the last centre before the beam, or later.
            let mut from = (self.column + left.column.div_euclid(2)) as usize;
            let limit =
                (self.column + high.end().div_euclid(2) + 2).min(i64::from(self.tiles.width())) as usize;
            if from as i64 >= end {
                break;
            }
            loop {
                let run = if from < limit { bits.next_set(from, limit) } else { limit };
                if run == limit || self.center(run) >= high.end() {
                    next.push((left, high));
                    break;
                }
                let run_end = bits.next_clear(run, limit);
                let (first, last) = (self.center(run), self.center(run_end - 1));
                from = run_end;
                if first == last || last <= left.column {
                    continue;
                }
                if left.column < first {
                    next.push((left, Ray::through(first as usize, first, half)));
                }
                if high.end() <= last {
                    break;
                }
                left = Ray::through(last as usize, last, half);
            }
        }
    }

    /// Finds the tiles that beams reach in half of a row, and cuts the beams by the segments along
    /// columns.
    fn cross_row(&self, half: i64, end: i64, open: &[Beam], next: &mut Vec<Beam>, sink: &mut impl Sink) {
        let row = self.row + half / 2;
        let above = (row + 1 < i64::from(self.tiles.height())).then(|| self.bits(row + 1));
        let bits = self.bits(row);
        for &(low, high) in open {
            if self.tile_at(low.column) >= end {
                break;
            }
            let beyond = high.advanced();
            let mut left = low;
            loop {
                // The first segment that begins beyond the left bound, and before the right one.
                let from = self.column + (left.column + 2).div_euclid(2);
                let limit = (self.column + (beyond.end() + 1).div_euclid(2)).min(end);
                let wall = above.filter(|_| from < limit).and_then(|above| {
                    let wall = bits.next_in_both(above, from as usize, limit as usize);
                    (wall < limit as usize).then(|| self.center(wall))
                });
                let reach = wall.unwrap_or(beyond.end());
                let last = self.tile_at(reach - 1).min(end - 1);
                sink.seen(self.tile_at(left.column) as usize, last as usize + 1);
                let Some(wall) = wall else {
                    next.push((left.advanced(), beyond));
                    break;
                };
                if left.advanced().column < wall {
                    next.push((left.advanced(), Ray::through(wall as usize, wall, half + 1)));
                }
                if high.end() <= wall {
                    break;
                }
                left = Ray::through(wall as usize, wall, half);
            }
        }
    }
}
