//! The sweep of an octant for all eyes in a tile: which tiles any of them may see.
//!
//! Rays go up and to the right, up faster. The lines through a tile that are free so far fall into
//! *beams*. A line is in a beam if all *left* points of the beam are left of it or on it, and all
//! *right* points right of it or on it. At first these are the upper left corner of the tile and
//! its lower right one. A run of opaque tiles in a row splits a beam into the lines that pass on
//! its left, before the upper left corner of the run, and those that pass on its right, behind its
//! lower right corner. These are all: so what beams reach is seen by some eye.
//!
//! In the rows to come, the leftmost line of a beam is the least steep to the right. It touches a
//! left point and a right point below that. A new left point moves it: then it goes through that,
//! and touches of the right points the one that makes it flattest. All lines from then on are at
//! least as flat, so that right points below that one count no more; nor do those right of the line
//! between two others. The other side is the same. (This is the funnel of shortest paths in the
//! plane: Guibas et al. 1987.) All numbers are whole, and nothing is rounded.
//!
//! Beams overlap, and may be as many as pairs of gaps. Where they are too many, neighbours become
//! one with the points that they share; where the points of a beam are too many, the oldest goes.
//! That adds lines, and takes none away. Until then what is found is what some eye sees, exactly.

use smallvec::SmallVec;

use crate::bits::BitGrid;
use crate::numeric::tiles::TILE;
use crate::tiles::octant::{Octant, Ray, Row, Sink};
use crate::tiles::options::Range;

/// A corner of a tile: column and row.
type Corner = [i64; 2];

/// The points on a side of a beam that count, by rows.
type Side = SmallVec<[Corner; 3]>;

/// Beams of a row, at most. Open ground of 4096 by 4096 tiles with a rock in every 1000 takes 258;
/// fences behind fences may make any number.
const MOST_BEAMS: usize = 512;

/// Points on a side of a beam, at most. The same ground takes 6.
const MOST_POINTS: usize = 16;

/// Lines through the tile of the eyes.
#[derive(Debug, Clone)]
struct Beam {
    /// The leftmost line and the rightmost one, at the row at hand.
    low: Ray,
    high: Ray,
    left: Side,
    right: Side,
}

/// The memory of sweeps.
#[derive(Debug, Clone)]
pub(super) struct TileSweep {
    /// The beams of the row at hand; those that were one follow each other.
    open: Vec<Beam>,
    /// Those of the next row.
    next: Vec<Beam>,
    /// [`MOST_BEAMS`] and [`MOST_POINTS`]; tests choose less.
    most_beams: usize,
    most_points: usize,
    /// Whether eyes in the corners of the tile look out.
    pub corners: bool,
}

impl Default for TileSweep {
    fn default() -> Self {
        let (most_beams, most_points) = (MOST_BEAMS, MOST_POINTS);
        Self { open: Vec::new(), next: Vec::new(), most_beams, most_points, corners: true }
    }
}

/// What stays the same in the rows of an octant.
struct Frame<'a, const MIRROR: bool> {
    tiles: &'a BitGrid,
    /// The tile of the eyes, in the octant's columns and rows.
    column: i64,
    row: i64,
    flip_y: bool,
    range: Option<Range>,
    most_points: usize,
}

impl TileSweep {
    /// Tells a sink what eyes in a tile of the map may see in an octant. `tiles` are those of the
    /// map, turned if the octant is; `MIRROR` is its `flip_x`. The map has the tile.
    pub fn run<const MIRROR: bool>(
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
        let (flip_y, most_points) = (octant.flip_y, self.most_points);
        let frame = Frame::<MIRROR> { tiles, column, row, flip_y, range, most_points };
        self.open.clear();
        self.open.push(frame.beam([column, row + 1], [column + 1, row], column));
        let mut y = row;
        while let Some(end) = frame.end(y).filter(|_| !self.open.is_empty()) {
            sink.begin_row(y as usize);
            self.next.clear();
            for beam in self.open.drain(..) {
                frame.cross_row(y, end, beam, &mut self.next, sink);
            }
            if self.corners && y == row && frame.is_pinched() {
                let corner = [column + 1, row + 1];
                self.next.push(frame.beam(corner, corner, column + 1));
            }
            std::mem::swap(&mut self.open, &mut self.next);
            while self.open.len() > self.most_beams {
                join(&mut self.open);
            }
            y += 1;
        }
    }
}

impl<const MIRROR: bool> Frame<'_, MIRROR> {
    fn bits(&self, row: i64) -> Row<'_, MIRROR> {
        Row::new(self.tiles, row as usize, self.flip_y)
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

    /// All lines between a left point and a right one; the first of them begins in a column.
    fn beam(&self, left: Corner, right: Corner, column: i64) -> Beam {
        let [low, high] = [Ray::through(column as usize, 0, 1), Ray::through(right[0] as usize, 1, 1)];
        Beam { low, high, left: SmallVec::from_slice(&[left]), right: SmallVec::from_slice(&[right]) }
    }

    /// Whether the tiles above the eyes and on their right are opaque. No line passes between, but
    /// an eye in the corner sees the tile beyond it.
    fn is_pinched(&self) -> bool {
        let blocks = |column: i64, row: i64| {
            let inside = column < i64::from(self.tiles.width()) && row < i64::from(self.tiles.height());
            inside && self.bits(row).next_set(column as usize, column as usize + 1) == column as usize
        };
        blocks(self.column + 1, self.row) && blocks(self.column, self.row + 1)
    }

    /// Finds the tiles that a beam reaches in a row, and the beams that leave it. Columns from
    /// `end` on are out of range.
    fn cross_row(&self, y: i64, end: i64, mut beam: Beam, next: &mut Vec<Beam>, sink: &mut impl Sink) {
        if beam.low.column >= end {
            return;
        }
        let bits = self.bits(y);
        let beyond = beam.high.advanced();
        let (reach, near_end) = (beyond.end().min(end) as usize, beam.high.end() as usize);
        loop {
            let first = beam.low.column as usize;
            // The tile of the eyes blocks nothing.
            let from = if y == self.row { self.column as usize + 1 } else { first };
            let run = if from < reach { bits.next_set(from, reach) } else { reach };
            let low = beam.low.advanced();
            if run == reach {
                sink.seen(first, reach);
                next.push(Beam { low, high: beyond, ..beam });
                return;
            }
            let run_end = bits.next_clear(run, reach);
            // Lines enter the run from below, and its first tile also from the side.
            sink.seen(first, near_end.clamp(run + 1, run_end));
            if low.column < run as i64 {
                let (corner, mut passed) = ([run as i64, y + 1], beam.clone());
                (passed.low, passed.high) = (low, through(corner, &mut passed.left, Way::Right));
                add(&mut passed.right, corner, Way::Right, self.most_points);
                next.push(passed);
            }
            if run_end >= reach || run_end >= near_end {
                return;
            }
            let corner = [run_end as i64, y];
            beam.low = through(corner, &mut beam.right, Way::Left);
            add(&mut beam.left, corner, Way::Left, self.most_points);
        }
    }
}

/// Of which side of a beam a point is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    Left,
    Right,
}

/// Twice the area of three corners: positive if the last is left of the way between the others.
fn area(a: Corner, b: Corner, c: Corner) -> i128 {
    let [ab, ac] = [b, c].map(|p| [0, 1].map(|axis| i128::from(p[axis]) - i128::from(a[axis])));
    ab[0] * ac[1] - ab[1] * ac[0]
}

/// The last line through a new point of a side, of those on the right side of all points of the
/// other one; drops those that count no more.
fn through(corner: Corner, other: &mut Side, way: Way) -> Ray {
    let mut best: Option<usize> = None;
    for (i, &point) in other.iter().enumerate().filter(|(_, point)| point[1] < corner[1]) {
        // Left points bound how steep a line is, right points how flat.
        let is_nearer = |best: usize| match way {
            Way::Left => area(other[best], corner, point) >= 0,
            Way::Right => area(other[best], corner, point) <= 0,
        };
        if best.is_none_or(is_nearer) {
            best = Some(i);
        }
    }
    let [least, most] = [(0, 1), (1, 1)];
    let slope = best.map(|i| (corner[0] - other[i][0], corner[1] - other[i][1]));
    let slope = match (way, slope) {
        (Way::Left, Some((aside, ahead))) if aside > 0 => Some((aside.min(ahead), ahead)),
        (Way::Right, Some((aside, ahead))) if aside < ahead => Some((aside.max(0), ahead)),
        _ => None,
    };
    let Some((aside, ahead)) = slope else {
        let (aside, ahead) = if way == Way::Left { least } else { most };
        return Ray::through(corner[0] as usize, aside, ahead);
    };
    other.drain(..best.unwrap_or(0));
    Ray::through(corner[0] as usize, aside, ahead)
}

/// Adds a point to a side, and drops those that count no more.
fn add(side: &mut Side, corner: Corner, way: Way, most: usize) {
    while let [.., last] = side[..]
        && last[1] >= corner[1]
    {
        side.pop();
    }
    let is_passed = |a: Corner, b: Corner| match way {
        Way::Left => area(a, corner, b) >= 0,
        Way::Right => area(a, corner, b) <= 0,
    };
    while let [.., a, b] = side[..]
        && is_passed(a, b)
    {
        side.pop();
    }
    if side.len() >= most {
        side.remove(0);
    }
    side.push(corner);
}

/// Makes every two beams that follow each other one, which has all lines of both.
fn join(beams: &mut Vec<Beam>) {
    let common = |a: &Side, b: &Side| a.iter().filter(|point| b.contains(point)).copied().collect();
    for pair in 0..beams.len() / 2 {
        let [a, b] = [&beams[2 * pair], &beams[2 * pair + 1]];
        let [low, high] = [a.low.leftmost(b.low), a.high.rightmost(b.high)];
        beams[pair] = Beam { low, high, left: common(&a.left, &b.left), right: common(&a.right, &b.right) };
    }
    let (half, odd) = (beams.len() / 2, beams.len() % 2);
    if odd == 1 {
        beams.swap_remove(half);
    }
    beams.truncate(half + odd);
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg32;

    use super::*;

    /// The columns and rows of an octant that a sweep marks.
    #[derive(Default)]
    struct Marked(Tiles, usize);

    impl Sink for Marked {
        fn begin_row(&mut self, row: usize) {
            self.1 = row;
        }

        fn seen(&mut self, from: usize, end: usize) {
            self.0.extend((from..end).map(|x| (x, self.1)));
        }
    }

    type Tiles = BTreeSet<(usize, usize)>;

    fn seen(tiles: &BitGrid, tile: [u32; 2], most_beams: usize, most_points: usize) -> Tiles {
        let mut sweep = TileSweep { most_beams, most_points, ..TileSweep::default() };
        let mut marked = Marked::default();
        let [octant, ..] = Octant::four(false);
        sweep.run::<false>(tiles, octant, tile, None, &mut marked);
        assert!(sweep.open.len() <= most_beams.max(1));
        marked.0
    }

    #[test]
    fn limits_add_tiles_and_take_none_away() {
        let mut random = Pcg32::seed_from_u64(7);
        let mut more = [0, 0];
        for round in 0..300 {
            let size = 20 + round % 50;
            let mut tiles = BitGrid::new(size, size);
            for _ in 0..size * size / [4, 12, 40][round as usize % 3] {
                tiles.set(random.random_range(0..size), random.random_range(0..size), true);
            }
            let tile = [random.random_range(0..size / 2), random.random_range(0..size / 2)];
            let all = seen(&tiles, tile, usize::MAX, usize::MAX);
            assert_eq!(all, seen(&tiles, tile, MOST_BEAMS, MOST_POINTS));
            for (i, (beams, points)) in [(3, usize::MAX), (usize::MAX, 1)].into_iter().enumerate() {
                let limited = seen(&tiles, tile, beams, points);
                assert!(all.is_subset(&limited), "{beams} beams, {points} points");
                more[i] += limited.len() - all.len();
            }
            assert!(all.is_subset(&seen(&tiles, tile, 2, 2)));
        }
        assert!(more.iter().all(|&more| more > 0), "{more:?}");
    }
}
