//! The sweep of an octant: which tiles the rays from the eye reach, row by row outwards.
//!
//! The rays that are still free are open intervals of slopes. In each row, the runs of opaque tiles
//! cut them at the exact slopes of their corners, as in recursive shadowcasting (Bergström 2001),
//! but with all intervals of a row at once and without rounding: the bounds advance like
//! Bresenham's lines, by a whole number of columns and a remainder. Intervals without width are
//! dropped, so that tiles that touch at a corner let nothing through.

use crate::bits::BitGrid;
use crate::numeric::tiles::TILE;
use crate::tiles::octant::{Beam, Octant, Ray, Row, Sink};
use crate::tiles::options::{FovOptions, Range};

/// The memory of sweeps.
#[derive(Debug, Clone, Default)]
pub(super) struct Sweep {
    /// The free rays of the row at hand, in the order of slopes.
    open: Vec<Beam>,
    /// Those of the next row.
    next: Vec<Beam>,
}

/// What stays the same in the rows of an octant.
struct Frame<'a, const MIRROR: bool> {
    tiles: &'a BitGrid,
    eye: [i64; 2],
    flip_y: bool,
    range: Option<Range>,
}

impl<const MIRROR: bool> Frame<'_, MIRROR> {
    fn row(&self, row: usize) -> Row<'_, MIRROR> {
        Row::new(self.tiles, row, self.flip_y)
    }

    /// The column after the last one of a row that may be seen. `None` if the row and all that
    /// follow are out of range.
    fn end(&self, ahead: i64) -> Option<i64> {
        let width = i64::from(self.tiles.width());
        match self.range {
            None => Some(width),
            Some(range) => range.end(self.eye[0], ahead).map(|end| end.min(width)),
        }
    }

    /// How far a border of columns lies aside of the eye.
    #[inline(always)]
    fn aside(&self, column: usize) -> i64 {
        column as i64 * TILE - self.eye[0]
    }
}

impl Sweep {
    /// Tells a sink what the eye sees in an octant. `tiles` are those of the map, turned if the
    /// octant is; `MIRROR` is its `flip_x`.
    pub fn run<const MIRROR: bool>(
        &mut self,
        tiles: &BitGrid,
        octant: Octant,
        eye: [i64; 2],
        options: &FovOptions,
        sink: &mut impl Sink,
    ) {
        let eye = octant.eye(eye, [tiles.width(), tiles.height()]);
        let height = i64::from(tiles.height());
        let frame = Frame::<MIRROR> { tiles, eye, flip_y: octant.flip_y, range: options.range };
        // A map below the eye's first row, or left of its rays, has nothing to see.
        let mut row = eye[1].div_euclid(TILE);
        if row >= height || tiles.width() == 0 || eye[0] >= i64::from(tiles.width()) * TILE {
            return;
        }
        let slopes = octant.slopes(options.sector);
        self.open.clear();
        if row >= 0 {
            let border = (row + 1) * TILE - eye[1];
            self.open.extend(slopes.iter().filter_map(|&(low, high)| {
                let rays = [low, high].map(|slope| Ray::new(slope, eye[0], border));
                frame.first_row(row as usize, rays, border, sink)
            }));
            row += 1;
        } else {
            row = 0;
            let rays = |slope| Ray::new(slope, eye[0], -eye[1]);
            self.open.extend(slopes.iter().map(|&(low, high)| (rays(low), rays(high))));
        }
        while row < height && !self.open.is_empty() {
            let ahead = row * TILE - eye[1];
            let Some(end) = frame.end(ahead) else { break };
            self.next.clear();
            frame.row_of_beams(row as usize, ahead, end, &self.open, &mut self.next, sink);
            std::mem::swap(&mut self.open, &mut self.next);
            row += 1;
        }
    }
}

impl<const MIRROR: bool> Frame<'_, MIRROR> {
    /// The rays that leave the eye's own row, of those between two. These are given where they
    /// cross its upper border, which lies `border` units ahead of the eye.
    fn first_row(
        &self,
        row: usize,
        [low, high]: [Ray; 2],
        border: i64,
        sink: &mut impl Sink,
    ) -> Option<Beam> {
        let start = self.eye[0].div_euclid(TILE);
        let end = high.end().max(start + 1).min(self.end(0)?);
        if end <= 0 {
            return Some((low, high));
        }
        sink.begin_row(row);
        let mut from = start.max(0) as usize;
        let end = end as usize;
        if from >= end {
            return None;
        }
        let bits = self.row(row);
        let first = from;
        if start >= 0 {
            // The tile that the rays start in. If the eye is inside, it blocks nothing.
            let inside = self.eye.iter().all(|at| at.rem_euclid(TILE) != 0);
            if !inside && bits.next_set(from, from + 1) == from {
                sink.seen(from, from + 1);
                return None;
            }
            from += 1;
        }
        let blocked = if from < end { bits.next_set(from, end) } else { end };
        if blocked == end {
            sink.seen(first, end);
            return Some((low, high));
        }
        sink.seen(first, blocked + 1);
        (low.column < blocked as i64).then(|| (low, Ray::through(blocked, self.aside(blocked), border)))
    }

    /// Finds the tiles that beams reach in a row, and the beams that leave it. The row begins
    /// `ahead` units before the eye, and its columns from `end` on are out of range.
    #[inline]
    fn row_of_beams(
        &self,
        row: usize,
        ahead: i64,
        end: i64,
        open: &[Beam],
        next: &mut Vec<Beam>,
        sink: &mut impl Sink,
    ) {
        sink.begin_row(row);
        let bits = self.row(row);
        for &(low, high) in open {
            if low.column >= end {
                // Rays never come back, and those that follow lie farther out.
                break;
            }
            let beyond = high.advanced();
            let reach = beyond.end().min(end);
            if reach <= 0 {
                next.push((low.advanced(), beyond));
                continue;
            }
            let (reach, near_end) = (reach as usize, high.end().max(0) as usize);
            let mut left = low;
            loop {
                let from = left.column.max(0) as usize;
                let run = bits.next_set(from, reach);
                let left_beyond = left.advanced();
                if run == reach {
                    sink.seen(from, reach);
                    next.push((left_beyond, beyond));
                    break;
                }
                let run_end = bits.next_clear(run, reach);
                // Rays enter the run from below, and its first tile also from the side.
                sink.seen(from, near_end.clamp(run + 1, run_end));
                if left_beyond.column < run as i64 {
                    next.push((left_beyond, Ray::through(run, self.aside(run), ahead + TILE)));
                }
                if run_end >= reach || near_end <= run_end {
                    break;
                }
                left = Ray::through(run_end, self.aside(run_end), ahead);
            }
        }
    }
}
