//! The eight octants about the eye, each turned and mirrored so that its rays go up and to the
//! right, up faster.

use smallvec::SmallVec;

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
