//! The sides of opaque tiles that an eye sees, for sweeps over segments.

use glam::UVec2;

use crate::tiles::octant::Octant;
use crate::tiles::opaque::OpaqueTiles;
use crate::tiles::options::FovOptions;
use crate::tiles::point::TilePoint;
use crate::tiles::ray::Sink;
use crate::tiles::sweep::Sweep;

/// A side of a tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// The side of least x.
    West,
    /// The side of greatest x.
    East,
    /// The side of least y.
    South,
    /// The side of greatest y.
    North,
}

impl Side {
    /// Whether the side runs along the y axis.
    pub const fn is_vertical(self) -> bool {
        matches!(self, Self::West | Self::East)
    }
}

/// Sides of opaque tiles in a row: a straight piece of wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TileFace {
    /// Which side of the tiles it is.
    pub side: Side,
    /// The x of a vertical side, or the y of a horizontal one.
    pub line: u32,
    /// The other coordinate, where the face begins.
    pub from: u32,
    /// Where it ends, greater than `from`.
    pub to: u32,
}

impl TileFace {
    /// The two ends, in tiles.
    pub fn ends(self) -> [UVec2; 2] {
        [self.from, self.to].map(|along| match self.side.is_vertical() {
            true => UVec2::new(self.line, along),
            false => UVec2::new(along, self.line),
        })
    }
}

/// Finds the sides of opaque tiles that an eye sees, merged into the longest faces.
///
/// A side is seen if rays in some range of directions end at it; then all of it belongs to a face.
/// These faces block all rays from the eye that the map blocks. Of an opaque tile on whose border
/// the eye lies, all four sides are found.
///
/// Keeps its memory from run to run.
///
/// ```
/// use casca_plane::{BitGrid, FovOptions, OpaqueTiles, Side, TileFace, TilePoint, VisibleFaces};
///
/// let mut walls = BitGrid::new(9, 9);
/// walls.fill(5, 2..7);
/// let mut faces = VisibleFaces::new();
/// let seen = faces.run(&OpaqueTiles::new(walls), TilePoint::center_of(4, 0), &FovOptions::default());
/// assert_eq!(seen, [TileFace { side: Side::South, line: 5, from: 2, to: 7 }]);
/// ```
#[derive(Debug, Clone, Default)]
pub struct VisibleFaces {
    sweep: Sweep,
    faces: Vec<TileFace>,
}

impl VisibleFaces {
    /// No faces yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The faces that are seen from `eye`, by side, line and place; none overlap or touch end to
    /// end on one side of a line.
    ///
    /// Costs as much as [`crate::FieldOfView::run`], and sorts the sides that are seen.
    pub fn run(&mut self, opaque: &OpaqueTiles, eye: TilePoint, options: &FovOptions) -> &[TileFace] {
        self.faces.clear();
        for (tiles, turned) in [(opaque.bits(), false), (opaque.columns(), true)] {
            let size = [tiles.width(), tiles.height()];
            for octant in Octant::four(turned) {
                let mut sink = FaceSink { octant, size, row: 0, faces: &mut self.faces };
                if octant.flip_x {
                    self.sweep.run::<true>(tiles, octant, eye.units(), options, &mut sink);
                } else {
                    self.sweep.run::<false>(tiles, octant, eye.units(), options, &mut sink);
                }
            }
        }
        self.faces.sort_unstable();
        self.faces.dedup_by(|next, face| {
            let joined = (next.side, next.line) == (face.side, face.line) && next.from <= face.to;
            if joined {
                face.to = face.to.max(next.to);
            }
            joined
        });
        &self.faces
    }

    /// The faces that the last run found.
    pub fn faces(&self) -> &[TileFace] {
        &self.faces
    }
}

/// Collects the sides that are seen in an octant.
struct FaceSink<'a> {
    octant: Octant,
    /// The dimensions of the map as the octant sees it.
    size: [u32; 2],
    row: usize,
    faces: &'a mut Vec<TileFace>,
}

/// The sides of a tile whose outside is to the less and to the greater along an axis of the map.
const SIDES: [[Side; 2]; 2] = [[Side::West, Side::East], [Side::South, Side::North]];

impl FaceSink<'_> {
    /// Adds the sides of tiles that face an axis of the octant, against it: at `line` on that axis,
    /// and `from..to` on the other one.
    fn add(&mut self, axis: usize, line: usize, from: usize, to: usize) {
        let flips = [self.octant.flip_x, self.octant.flip_y];
        let place = |axis: usize, at: usize| match flips[axis] {
            true => self.size[axis] - at as u32,
            false => at as u32,
        };
        let (start, end) = (place(1 - axis, from), place(1 - axis, to));
        let side = SIDES[if self.octant.turned { 1 - axis } else { axis }][usize::from(flips[axis])];
        let line = place(axis, line);
        self.faces.push(TileFace { side, line, from: start.min(end), to: start.max(end) });
    }
}

impl Sink for FaceSink<'_> {
    fn begin_row(&mut self, row: usize) {
        self.row = row;
    }

    fn seen(&mut self, _from: usize, _end: usize) {}

    fn near_sides(&mut self, from: usize, end: usize) {
        self.add(1, self.row, from, end);
    }

    fn inner_side(&mut self, at: usize) {
        self.add(0, at, self.row, self.row + 1);
    }

    fn touched(&mut self, at: usize) {
        let [x, y] = [at, self.row].map(|at| at as u32);
        let [width, height] = self.size;
        let x = if self.octant.flip_x { width - 1 - x } else { x };
        let y = if self.octant.flip_y { height - 1 - y } else { y };
        let tile = if self.octant.turned { [y, x] } else { [x, y] };
        for (axis, sides) in SIDES.into_iter().enumerate() {
            for (beyond, side) in (0..).zip(sides) {
                let along = tile[1 - axis];
                self.faces.push(TileFace { side, line: tile[axis] + beyond, from: along, to: along + 1 });
            }
        }
    }
}
