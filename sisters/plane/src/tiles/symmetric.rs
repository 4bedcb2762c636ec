//! A symmetric field of view: two free tiles see each other or neither does.

use std::cmp::Ordering;

use crate::bits::BitGrid;
use crate::tiles::error::TileError;
use crate::tiles::opaque::OpaqueTiles;

/// Finds the tiles that a tile sees by their centres, as many roguelikes do. **Not exact**: use
/// [`FieldOfView`](crate::FieldOfView) where nothing in sight may be missing.
///
/// A free tile is seen if the line from the centre of the eye's tile to its own is free. An opaque
/// tile counts as the line through its centre, a tile long, across the direction in which the two
/// centres are farther apart. A ray through the end of that is stopped where both tiles beside it
/// are opaque. So a free tile sees another one if and only if that sees it: of two archers either
/// both can shoot or none. Opaque tiles are seen if a part of that line is.
///
/// This is shadow casting as by Ford (2020, "Symmetric shadowcasting"), with closed intervals of
/// directions, in whole numbers. Tiles of which the eye sees a part, but not the centre, are left
/// out: the tables of the README count them.
///
/// ```
/// use casca_plane::{BitGrid, OpaqueTiles, SymmetricFov};
///
/// let mut walls = BitGrid::new(7, 5);
/// walls.set(3, 2, true);
/// let tiles = OpaqueTiles::new(walls);
/// let mut fov = SymmetricFov::new();
/// let there = fov.run(&tiles, 0, 1, None)?.get(6, 3);
/// let back = fov.run(&tiles, 6, 3, None)?.get(0, 1);
/// assert_eq!(there, back);
/// # Ok::<(), casca_plane::TileError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct SymmetricFov {
    seen: BitGrid,
    open: Vec<[Slope; 2]>,
    next: Vec<[Slope; 2]>,
}

/// A quotient of whole numbers: columns for each row. The second is positive.
#[derive(Debug, Clone, Copy)]
struct Slope(i64, i64);

impl Slope {
    fn cmp(self, other: Self) -> Ordering {
        (i128::from(self.0) * i128::from(other.1)).cmp(&(i128::from(other.0) * i128::from(self.1)))
    }

    fn is_before(self, other: Self) -> bool {
        self.cmp(other).is_lt()
    }
}

/// A quarter of the map about the eye: rows of it, counted from the eye, and columns.
#[derive(Debug, Clone, Copy)]
struct Quarter {
    eye: [i64; 2],
    /// Whether rows of the quarter are columns of the map.
    turned: bool,
    /// 1 if they are counted upwards, or else -1.
    sign: i64,
}

impl Quarter {
    /// The tile of the map; `None` outside.
    fn tile(&self, tiles: &OpaqueTiles, row: i64, column: i64) -> Option<(u32, u32)> {
        let off = if self.turned { [self.sign * row, column] } else { [column, self.sign * row] };
        let [x, y] = [0, 1].map(|axis| self.eye[axis] + off[axis]);
        let inside = x >= 0 && y >= 0 && x < tiles.width().into() && y < tiles.height().into();
        inside.then_some((x as u32, y as u32))
    }
}

impl SymmetricFov {
    /// A field of view that sees nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The tiles that the tile `(x, y)` sees, itself included, whose centres are at most `radius`
    /// tiles away, if one is given. The eye's own tile does not block.
    ///
    /// Costs the tiles in sight, and for each row the intervals of directions that are free.
    ///
    /// # Errors
    /// [`TileError::Outside`] for a tile that the map does not have.
    pub fn run(
        &mut self,
        tiles: &OpaqueTiles,
        x: u32,
        y: u32,
        radius: Option<u32>,
    ) -> Result<&BitGrid, TileError> {
        let (width, height) = (tiles.width(), tiles.height());
        if x >= width || y >= height {
            return Err(TileError::Outside { x, y, width, height });
        }
        if (self.seen.width(), self.seen.height()) == (width, height) {
            self.seen.clear();
        } else {
            self.seen = BitGrid::new(width, height);
        }
        self.seen.set(x, y, true);
        for (turned, sign) in [(false, 1), (false, -1), (true, 1), (true, -1)] {
            let quarter = Quarter { eye: [x.into(), y.into()], turned, sign };
            self.run_quarter(tiles, quarter, radius.map(i64::from));
        }
        Ok(&self.seen)
    }

    /// The tiles that the last run found.
    pub fn seen(&self) -> &BitGrid {
        &self.seen
    }

    fn run_quarter(&mut self, tiles: &OpaqueTiles, quarter: Quarter, radius: Option<i64>) {
        self.open.clear();
        self.open.push([Slope(-1, 1), Slope(1, 1)]);
        let mut row = 1;
        while !self.open.is_empty() && radius.is_none_or(|radius| row <= radius) {
            if quarter.tile(tiles, row, 0).is_none() {
                // Beyond the map.
                return;
            }
            self.next.clear();
            for i in 0..self.open.len() {
                self.look(tiles, quarter, row, i, radius);
            }
            std::mem::swap(&mut self.open, &mut self.next);
            row += 1;
        }
    }

    /// Marks the tiles of a row in an open interval, and keeps what their lines leave of it.
    fn look(&mut self, tiles: &OpaqueTiles, quarter: Quarter, row: i64, i: usize, radius: Option<i64>) {
        let [from, to] = self.open[i];
        // The columns whose lines meet the interval, at their ends at least.
        let first = -columns(Slope(-from.0, from.1), row);
        let last = columns(to, row);
        let eye = quarter.eye[usize::from(quarter.turned)];
        let most = i64::from(if quarter.turned { tiles.height() } else { tiles.width() }) - 1;
        // Where the free part begins that reaches as far as the column at hand.
        let mut start = Some(from);
        for column in first.max(-eye)..=last.min(most - eye) {
            let Some((x, y)) = quarter.tile(tiles, row, column) else { continue };
            let in_range = radius.is_none_or(|radius| square(row) + square(column) <= square(radius));
            let begin = Slope(2 * column - 1, 2 * row);
            let center = Slope(column, row);
            let seen = if tiles.get(x, y) {
                let part = start.take().filter(|start| !begin.is_before(*start));
                self.next.extend(part.map(|start| [start, begin]));
                true
            } else {
                start = start.or(Some(begin));
                !center.is_before(from) && !to.is_before(center)
            };
            if seen && in_range {
                self.seen.set(x, y, true);
            }
        }
        self.next.extend(start.map(|start| [start, to]));
    }
}

fn square(side: i64) -> i128 {
    i128::from(side) * i128::from(side)
}

/// The last column of a row whose line, from half a tile before its centre on, begins at or before
/// a slope.
fn columns(slope: Slope, row: i64) -> i64 {
    let [up, down] = [slope.0, slope.1].map(i128::from);
    (2 * up * i128::from(row) + down).div_euclid(2 * down) as i64
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg32;

    use super::*;

    /// Whether the line from one tile to another is free, by the rule of the type, a row at a time.
    fn sees(tiles: &OpaqueTiles, from: [i64; 2], to: [i64; 2]) -> bool {
        let off = [to[0] - from[0], to[1] - from[1]];
        let main = usize::from(off[1].abs() > off[0].abs());
        let rows = off[main].abs();
        (1..rows).all(|row| {
            // In halves of a tile, times the number of rows.
            let across = 2 * off[1 - main] * row;
            let blocks = |column: i64| {
                let mut tile = from;
                tile[main] += off[main].signum() * row;
                tile[1 - main] += column;
                tiles.get(tile[0] as u32, tile[1] as u32)
            };
            let low = (across - rows).div_euclid(2 * rows);
            let touches = |column: i64| (2 * column * rows - across).abs() <= rows;
            let near: Vec<i64> = (low - 1..=low + 2).filter(|&column| touches(column)).collect();
            assert!((1..=2).contains(&near.len()));
            !near.into_iter().all(blocks)
        })
    }

    #[test]
    fn free_tiles_see_each_other_or_neither_does() {
        let mut random = Pcg32::seed_from_u64(11);
        let (mut seen, mut hidden) = (0, 0);
        for round in 0..24 {
            let (width, height) = ([9, 17, 30][round % 3], [12, 21][round % 2]);
            let mut walls = BitGrid::new(width, height);
            let share = [0.05, 0.2, 0.4][round / 8];
            for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                walls.set(x, y, random.random_bool(share));
            }
            let tiles = OpaqueTiles::new(walls);
            let mut fov = SymmetricFov::new();
            let all = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let sets: Vec<BitGrid> =
                all().map(|(x, y)| fov.run(&tiles, x, y, None).unwrap().clone()).collect();
            for (a, (x, y)) in all().enumerate().filter(|(_, (x, y))| !tiles.get(*x, *y)) {
                for (b, (p, q)) in all().enumerate().filter(|(_, (p, q))| !tiles.get(*p, *q)) {
                    let there = sets[a].get(p, q);
                    assert_eq!(there, sets[b].get(x, y), "({x}, {y}) and ({p}, {q}), round {round}");
                    let line = sees(&tiles, [x.into(), y.into()], [p.into(), q.into()]);
                    assert_eq!(there, line, "({x}, {y}) to ({p}, {q}), round {round}");
                    (seen, hidden) = (seen + u32::from(there), hidden + u32::from(!there));
                }
            }
        }
        assert!(seen > 50_000 && hidden > 50_000, "{seen} {hidden}");
    }

    #[test]
    fn walls_ranges_and_borders() {
        let mut walls = BitGrid::new(11, 11);
        walls.fill(8, 0..11);
        let tiles = OpaqueTiles::new(walls);
        let mut fov = SymmetricFov::new();
        let seen = fov.run(&tiles, 5, 5, None).unwrap();
        assert!((0..11).all(|x| seen.get(x, 8) && seen.get(x, 0) && !seen.get(x, 9)));
        let near = fov.run(&tiles, 5, 5, Some(2)).unwrap().clone();
        assert_eq!(near.count(), 13, "a disc of radius 2");
        assert!(near.get(5, 3) && !near.get(7, 7) && &near == fov.seen());
        assert_eq!(fov.run(&tiles, 5, 5, Some(0)).unwrap().count(), 1);
        let outside = TileError::Outside { x: 11, y: 0, width: 11, height: 11 };
        assert_eq!(fov.run(&tiles, 11, 0, None), Err(outside));
        // A long corridor.
        let corridor = OpaqueTiles::new(BitGrid::new(1_000_000, 1));
        assert_eq!(fov.run(&corridor, 17, 0, Some(u32::MAX)).unwrap().count(), 1_000_000);
    }
}
