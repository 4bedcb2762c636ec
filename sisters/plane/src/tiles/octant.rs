//! The eight octants about the eye, each turned and mirrored so that its rays go up and to the
//! right, up faster; and rays in them, which advance row by row without rounding; and
//! rows of bits, read a word at a time from either side.

use smallvec::SmallVec;

use crate::bits::{BitGrid, first_set, last_set};
use crate::numeric::tiles::TILE;
use crate::tiles::options::Sector;

/// An eighth of all directions. In its own coordinates, rays go from the eye with slopes x / y
/// between 0 and 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Octant {
    /// Whether x and y are exchanged: columns of the map are rows of the octant.
    pub turned: bool,
    /// Whether the octant's x goes against the map's, after the exchange.
    pub flip_x: bool,
    /// Whether the octant's y goes against the map's, after the exchange.
    pub flip_y: bool,
}

impl Octant {
    /// The four octants of the rows of the map, or of its columns.
    pub fn four(turned: bool) -> [Self; 4] {
        [(false, false), (true, false), (false, true), (true, true)].map(|(flip_x, flip_y)| Self {
            turned,
            flip_x,
            flip_y,
        })
    }

    /// The eye in the octant's coordinates, which begin at the map's corner. `size` is that of the
    /// map as the octant sees it.
    pub fn eye(self, eye: [i64; 2], size: [u32; 2]) -> [i64; 2] {
        let [x, y] = if self.turned { [eye[1], eye[0]] } else { eye };
        let flipped = |flip, at, size: u32| if flip { i64::from(size) * TILE - at } else { at };
        [flipped(self.flip_x, x, size[0]), flipped(self.flip_y, y, size[1])]
    }

    /// A direction from the map's coordinates to the octant's.
    fn local(self, direction: [i64; 2]) -> [i64; 2] {
        let [x, y] = if self.turned { [direction[1], direction[0]] } else { direction };
        [if self.flip_x { -x } else { x }, if self.flip_y { -y } else { y }]
    }

    /// A direction from the octant's coordinates to the map's.
    fn global(self, [x, y]: [i64; 2]) -> [i64; 2] {
        let (x, y) = (if self.flip_x { -x } else { x }, if self.flip_y { -y } else { y });
        if self.turned { [y, x] } else { [x, y] }
    }

    /// The open intervals of slopes that lie in a sector, from small to great: at most three.
    pub fn slopes(self, sector: Option<Sector>) -> SmallVec<[(Slope, Slope); 3]> {
        let Some(sector) = sector else {
            return SmallVec::from_slice(&[(Slope::ZERO, Slope::ONE)]);
        };
        let inside = |direction| {
            let [x, y] = self.local(direction);
            (0 < x && x < y).then_some(Slope { x, y })
        };
        let mut ends: SmallVec<[Slope; 4]> = SmallVec::from_slice(&[Slope::ZERO, Slope::ONE]);
        ends.extend([sector.from, sector.to].into_iter().filter_map(inside));
        // The numbers have 30 bits: the products are exact.
        ends.sort_unstable_by(|a, b| (a.x * b.y).cmp(&(b.x * a.y)));
        let seen = |a: Slope, b: Slope| sector.holds(self.global([a.x + b.x, a.y + b.y]));
        ends.windows(2)
            .map(|pair| (pair[0], pair[1]))
            .filter(|&(a, b)| a.x * b.y < b.x * a.y && seen(a, b))
            .collect()
    }
}

/// A slope x / y, with y > 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slope {
    pub x: i64,
    pub y: i64,
}

impl Slope {
    const ZERO: Self = Self { x: 0, y: 1 };
    const ONE: Self = Self { x: 1, y: 1 };
}

/// What takes the tiles that a sweep reaches. Rows and columns are those of the octant.
pub(super) trait Sink {
    /// The next calls are about this row.
    fn begin_row(&mut self, row: usize);
    /// The tiles `from..end` are seen. `from < end`.
    fn seen(&mut self, from: usize, end: usize);
}

/// A ray from the eye, where it crosses the lower border of a row: at `column + rest / whole`.
///
/// `0 <= rest < whole`, and `0 <= step <= whole`: slopes are at most 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    pub column: i64,
    rest: i64,
    whole: i64,
    /// How far it goes aside in a row, in parts of `whole`.
    step: i64,
}

impl Ray {
    /// The ray of a slope, `ahead` units before the eye. The slope is at most 1.
    pub fn new(slope: Slope, eye: i64, ahead: i64) -> Self {
        let whole = i128::from(slope.y) * i128::from(TILE);
        let at = i128::from(eye) * i128::from(slope.y) + i128::from(slope.x) * i128::from(ahead);
        Self {
            column: at.div_euclid(whole) as i64,
            rest: at.rem_euclid(whole) as i64,
            whole: whole as i64,
            step: slope.x * TILE,
        }
    }

    /// The ray through a corner, at that corner: so far aside of the eye, and so far ahead.
    #[inline(always)]
    pub fn through(column: usize, aside: i64, ahead: i64) -> Self {
        Self { column: column as i64, rest: 0, whole: ahead, step: aside }
    }

    /// The ray a row further.
    #[inline(always)]
    pub fn advanced(self) -> Self {
        let rest = self.rest + self.step;
        let over = rest >= self.whole;
        Self {
            column: self.column + i64::from(over),
            rest: if over { rest - self.whole } else { rest },
            ..self
        }
    }

    /// A ray that is left of two, or on them, from here on.
    pub fn leftmost(self, other: Self) -> Self {
        let flat = if self.is_flatter(other) { other } else { self };
        Self::through(self.column.min(other.column) as usize, flat.step, flat.whole)
    }

    /// A ray that is right of two, or on them, from here on.
    pub fn rightmost(self, other: Self) -> Self {
        let flat = if self.is_flatter(other) { self } else { other };
        Self::through(self.end().max(other.end()) as usize, flat.step, flat.whole)
    }

    /// Whether the slope of a ray is greater than that of another.
    fn is_flatter(self, other: Self) -> bool {
        i128::from(self.step) * i128::from(other.whole) > i128::from(other.step) * i128::from(self.whole)
    }

    /// The column after the last one that begins before the ray.
    #[inline(always)]
    pub fn end(self) -> i64 {
        self.column + i64::from(self.rest != 0)
    }
}

/// The rays of one eye between two, without these.
pub(super) type Beam = (Ray, Ray);

/// A row of bits as an octant sees it: column 0 is the first one, or the last one if `MIRROR`.
#[derive(Clone, Copy)]
pub(super) struct Row<'a, const MIRROR: bool> {
    /// Bits beyond the width are clear.
    words: &'a [u64],
    width: usize,
}

impl<'a, const MIRROR: bool> Row<'a, MIRROR> {
    /// A row of some tiles, counted from the last one if `flip_y`.
    pub fn new(tiles: &'a BitGrid, row: usize, flip_y: bool) -> Self {
        let y = if flip_y { tiles.height() - 1 - row as u32 } else { row as u32 };
        Self { words: tiles.row(y), width: tiles.width() as usize }
    }

    /// The first column in `from..end` whose bit is set; `end` if there is none. `from < end <=
    /// width`.
    #[inline(always)]
    pub fn next_set(self, from: usize, end: usize) -> usize {
        self.next(from, end, |at| self.words[at])
    }

    /// The first column in `from..end` whose bit is clear; `end` if there is none. `from < end <=
    /// width`.
    #[inline(always)]
    pub fn next_clear(self, from: usize, end: usize) -> usize {
        self.next(from, end, |at| !self.words[at])
    }

    /// The first column whose bit is set in the words of a function.
    #[inline(always)]
    fn next(self, from: usize, end: usize, word_at: impl Fn(usize) -> u64) -> usize {
        if MIRROR {
            let found = last_set(self.width - end, self.width - from, word_at);
            found.map_or(end, |found| self.width - 1 - found)
        } else {
            first_set(from, end, word_at)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both directions against single bits.
    #[test]
    fn words_agree_with_single_bits() {
        let words = [0x8000_0000_0000_0001_u64, 0, u64::MAX, 0x0ff0_0000_0000_0180];
        for width in [1, 63, 64, 65, 130, 200, 256_usize] {
            let mut words = words;
            for x in width..256 {
                words[x / 64] &= !(1 << (x % 64));
            }
            let bit = |x: usize| words[x / 64] >> (x % 64) & 1 == 1;
            for from in 0..width {
                for end in from + 1..=width {
                    let plain = Row::<false> { words: &words, width };
                    let turned = Row::<true> { words: &words, width };
                    let first = |wanted: bool, at: &dyn Fn(usize) -> usize| {
                        (from..end).find(|&t| bit(at(t)) == wanted).unwrap_or(end)
                    };
                    let mirror = |t: usize| width - 1 - t;
                    assert_eq!(plain.next_set(from, end), first(true, &|t| t));
                    assert_eq!(plain.next_clear(from, end), first(false, &|t| t));
                    assert_eq!(turned.next_set(from, end), first(true, &mirror));
                    assert_eq!(turned.next_clear(from, end), first(false, &mirror));
                }
            }
        }
    }
}
