//! Where eyes and entities get to on a map.

use std::ops::Range;

use casca::glam::Vec2;
use casca_plane::OpaqueTiles;

/// Reaches are longer by this, in tiles: sums of double precision on the widest map are off by
/// less than 2^-30, and positions of casca-plane are rounded to 2^-28.
pub(super) const MARGIN: f64 = 1e-6;

/// A tile, its column first.
pub type Tile = (u32, u32);

/// Tiles of a row or column of `size` that touch what lies from `low` to `high`.
fn touched(low: f64, high: f64, size: u32) -> Range<u32> {
    // Both are numbers of tiles of the map, and the cast ends at 0.
    (low.ceil() - 1.0) as u32..((high.floor() + 1.0) as u32).min(size)
}

/// A map, and whether opaque tiles stop those who are not in one.
#[derive(Clone, Copy)]
pub(crate) struct Ground<'a> {
    pub(crate) opaque: &'a OpaqueTiles,
    pub(crate) walls_stop: bool,
}

impl Ground<'_> {
    /// The columns and rows of tiles that a square touches.
    fn around(self, center: [f64; 2], half: f64) -> (Range<u32>, Range<u32>) {
        let part = |at: f64, size| touched(at - half, at + half, size);
        (part(center[0], self.opaque.width()), part(center[1], self.opaque.height()))
    }

    /// The tiles that one who is at a place may be in after a way of at most `reach`, in order of
    /// rows; and whether they are free ones only. `None` if they are more than `most`.
    pub(crate) fn reached(self, place: Vec2, reach: f64, most: usize) -> Option<(Vec<Tile>, bool)> {
        let center = [place.x, place.y].map(f64::from);
        let near = |&(x, y): &Tile| {
            let apart = [x, y].map(f64::from);
            let apart = [0, 1].map(|i| (apart[i] - center[i]).max(center[i] - apart[i] - 1.0).max(0.0));
            apart[0] * apart[0] + apart[1] * apart[1] <= reach * reach
        };
        let start: Vec<Tile> = tiles(self.around(center, MARGIN)).collect();
        let free = |&(x, y): &Tile| !self.opaque.get(x, y);
        if !(self.walls_stop && start.iter().any(free)) {
            let all = tiles(self.around(center, reach)).filter(near);
            let found: Vec<Tile> = all.take(most.saturating_add(1)).collect();
            return (found.len() <= most).then_some((found, false));
        }
        let mut found: std::collections::BTreeSet<(u32, u32)> = Default::default();
        let mut open: Vec<Tile> = start.into_iter().filter(free).collect();
        while let Some((x, y)) = open.pop() {
            if !found.insert((y, x)) {
                continue;
            }
            if found.len() > most {
                return None;
            }
            // Tiles that touch at a corner too: a point gets through there.
            let beside = |at: u32, size: u32| at.saturating_sub(1)..(at + 2).min(size);
            let next = tiles((beside(x, self.opaque.width()), beside(y, self.opaque.height())));
            open.extend(next.filter(|tile| free(tile) && near(tile) && !found.contains(&(tile.1, tile.0))));
        }
        Some((found.into_iter().map(|(y, x)| (x, y)).collect(), true))
    }

    /// The tiles in which one may see a body that is at a place, after a way of at most `reach`, in
    /// order of rows. `None` if they may be more than `most`.
    pub(crate) fn taken(self, place: Vec2, half: f32, reach: f64, most: usize) -> Option<Vec<Tile>> {
        let (centers, only_free) = self.reached(place, reach, most)?;
        let half = f64::from(half) + MARGIN;
        let center = [place.x, place.y].map(f64::from);
        let mut found = std::collections::BTreeSet::new();
        for (x, y) in centers {
            let part = |at: f64, center: f64, size| {
                let (low, high) = (at.max(center - reach), (at + 1.0).min(center + reach));
                touched(low - half, high + half, size)
            };
            let columns = part(f64::from(x), center[0], self.opaque.width());
            let rows = part(f64::from(y), center[1], self.opaque.height());
            if columns.len().saturating_mul(rows.len()) > most {
                return None;
            }
            let seen = tiles((columns, rows)).filter(|&(x, y)| !(only_free && self.opaque.get(x, y)));
            found.extend(seen.map(|(x, y)| (y, x)));
        }
        Some(found.into_iter().map(|(y, x)| (x, y)).collect())
    }
}

/// All tiles of some columns and rows, in order of rows.
fn tiles((columns, rows): (Range<u32>, Range<u32>)) -> impl Iterator<Item = Tile> {
    rows.flat_map(move |y| columns.clone().map(move |x| (x, y)))
}

#[cfg(test)]
mod tests {
    use casca_plane::BitGrid;

    use super::*;

    fn map(rows: &[&str]) -> OpaqueTiles {
        let mut bits = BitGrid::new(rows[0].len() as u32, rows.len() as u32);
        for (y, row) in rows.iter().enumerate() {
            row.bytes().enumerate().for_each(|(x, tile)| bits.set(x as u32, y as u32, tile == b'#'));
        }
        OpaqueTiles::new(bits)
    }

    #[test]
    fn tiles_that_touch_count() {
        assert_eq!(touched(1.5, 2.5, 9), 1..3);
        assert_eq!(touched(1.0, 2.0, 9), 0..3);
        assert_eq!(touched(-3.0, 99.0, 9), 0..9);
        assert_eq!(touched(0.0, 0.0, 9), 0..1);
        assert_eq!(touched(9.0, 9.0, 9), 8..9);
    }

    #[test]
    fn walls_stop_those_who_are_not_in_one() {
        let map = map(&["...#...", "...#...", "...#..."]);
        let count = |walls_stop, x, reach| {
            let ground = Ground { opaque: &map, walls_stop };
            ground.reached(Vec2::new(x, 1.5), reach, 99).unwrap().0.len()
        };
        assert_eq!((count(true, 1.5, 0.0), count(true, 1.5, 0.5), count(true, 1.5, 9.0)), (1, 5, 9));
        assert_eq!((count(false, 1.5, 9.0), count(true, 3.5, 9.0)), (21, 21));
        // On the border of the wall, it does not get through.
        assert_eq!(count(true, 3.0, 9.0), 9);
        let ground = Ground { opaque: &map, walls_stop: true };
        assert_eq!(ground.reached(Vec2::new(1.5, 1.5), 9.0, 8), None);
        assert_eq!(ground.taken(Vec2::new(1.5, 1.5), 0.2, 9.0, 99).unwrap().len(), 9);
        assert_eq!(ground.taken(Vec2::new(1.5, 1.5), 0.5, 0.0, 99).unwrap().len(), 9);
        assert_eq!(ground.taken(Vec2::new(3.5, 1.5), 0.2, 0.0, 99).unwrap(), [(3, 1)]);
        // The square of a body reaches as far as its centre goes and its half side more.
        assert_eq!(ground.taken(Vec2::new(0.5, 1.5), 0.2, 0.2, 99).unwrap(), [(0, 1)]);
        assert_eq!(ground.taken(Vec2::new(0.5, 1.5), 0.3, 0.3, 99).unwrap().len(), 6);
    }
}
