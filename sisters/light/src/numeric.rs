//! Margins and limits: every one of them, with its name and the reason why it suffices.
//!
//! Lengths are in cells of the grid, unless a constant says otherwise. Geometry is computed in
//! double precision: coordinates inside a grid are below 2^10 cells, so that one operation rounds
//! by 2^-43 at most, and the longest chain (a triangle of 2^30 cells, see [`FARTHEST`]) by 2^-18.

/// An axis has one cell more if the box passes its whole number of cells by more than this.
///
/// The quotient of the box and the cell errs by 2^-43 in double precision. A box whose corners were
/// rounded to single precision may get a cell more, which does no harm. The part that is cut off
/// lies in the cells around the box, which the grid has on each side.
pub(crate) const OVER: f64 = 1e-6;

/// A start of rays is so far above its surface, along the normal.
///
/// It is stored in single precision: below 2^10 cells this rounds by 2^-15, a thirty-second of the
/// distance, so that the start stays above its plane. The way up is itself tested for walls, so
/// that no start is beyond a second surface. On the device, the height of a point of a ray over a
/// plane is a sum of four products below 2^9, which single precision rounds by 2^-13 at most.
pub(crate) const LIFT: f64 = 1.0 / 1024.0;

/// The test of the way up to a start begins so far above the surface.
///
/// It must leave the surface's own plane, of which rounding knows the place to 2^-18, and it is a
/// sixteenth of [`LIFT`]. Two surfaces nearer to each other than this count as one.
pub(crate) const TOUCH: f64 = LIFT / 16.0;

/// Triangles catch rays that pass their edges so near.
///
/// Corners come in single precision: in a grid of 512 cells, two walls that should meet may gape by
/// 2 ulp, which is 2^-14 or 6e-5 cells. It is a tenth of [`LIFT`], so that the grown edge of a wall
/// stays below all starts of rays on its neighbour.
pub(crate) const SEAL: f64 = 1e-4;

/// A triangle is listed in all cells that are nearer to it than this.
///
/// More than [`SEAL`], so that the cell of a hit on a sealed edge lists the triangle; a hit itself
/// strays by 2^-40 only.
pub(crate) const GROW: f64 = 2e-4;

/// The box of a triangle in the tree is larger than the triangle by so much on all sides.
///
/// It must hold [`GROW`], and rounding in single precision, which shifts a face of a box by less
/// than 2^-11: the start of a ray by 2^-15, its direction by 2^-24 over 2^10 cells, and the
/// quotient by four roundings of a distance of 2^10 cells, 2^-12. Both are a third of it.
pub(crate) const BOX: f64 = 1.0 / 512.0;

/// Directions have no lesser component in single precision.
///
/// Over 2^10 cells, a ray strays by 2^-56 cells for it; its inverse times 2^10 is finite.
pub(crate) const NO_WAY: f32 = 1e-20;

/// Triangles of a leaf of the tree at most.
///
/// Sponza's rays take the same time with one, two and four; four take least memory.
pub(crate) const LEAF: usize = 4;

/// A leaf on the device is one number: the place of its first triangle times this, and how many
/// there are. 2^29 triangles have room.
#[cfg(feature = "gpu")]
pub(crate) const LEAVES: u32 = 2 * LEAF as u32;

/// Where a part of the tree may be split: the least cost of so many places.
pub(crate) const BINS: usize = 16;

/// Levels of the tree that are split by cost; from there on by halves, of which a tree of 2^32
/// triangles has 32.
pub(crate) const LEVEL: u32 = 40;

/// Triangles of less area, in square cells, are left out.
///
/// They are thinner than a millionth of a cell or smaller than [`SEAL`] in both directions: their
/// neighbours seal the hole.
pub(crate) const LEAST_AREA: f64 = 1e-8;

/// Parts of triangles of less area, in square cells, get no entry.
///
/// A hit on one reads an entry beside it.
pub(crate) const LEAST_PART: f64 = 1e-9;

/// Triangles with a corner that is so far from the grid, in cells, are left out.
///
/// Up to it, clipping in double precision errs by 2^30 · 2^-52 · 4 = 2^-20 cells, far below
/// [`GROW`]. Beyond it, a plane through the grid would be a guess.
pub(crate) const FARTHEST: f64 = (1u64 << 30) as f64;

/// An entry is flat if its triangles leave one plane by no more than this.
///
/// A quarter of [`LIFT`]: a segment between two starts above the entry does not dip into it.
pub(crate) const FLAT: f64 = LIFT / 4.0;

/// Triangles whose unit normals have a greater product count as coplanar in direction.
///
/// An angle of 1.4e-4: across a cell, of diagonal 1.74, a plane turned by it leaves the other by
/// less than [`FLAT`].
pub(crate) const SAME_NORMAL: f64 = 1.0 - 1e-8;

/// Parts with one dominant direction become two entries where so much is free between them.
///
/// A wall of 2 cm at 64 cells on 10 m is 0.13 cells thick; steps below a tenth are relief, which
/// would only make more entries. Light does not cross a wall either way.
pub(crate) const GAP: f32 = 0.1;

/// The openness of a candidate is measured by rays of so many cells.
pub(crate) const OPEN_REACH: f64 = 2.0;

/// How many rays measure it.
///
/// Eight tell a point in a fold from one in the open; more change one choice in fifty.
pub(crate) const OPEN_RAYS: u32 = 8;

/// What a distance of one cell to the middle of an entry costs, as a share of openness.
///
/// In the open all candidates are alike, and the one in the middle stands for the entry best.
pub(crate) const OFF_CENTRE: f64 = 0.15;

/// A candidate is given up only if it loses by more than this.
///
/// The sum of eight shares of at most 1 rounds by less than 2^-48.
pub(crate) const DOUBT: f64 = 1e-12;

/// Points of an entry that are tried.
pub(crate) const CANDIDATES: u32 = 8;

/// Points of an entry from which rays start at most.
pub(crate) const STARTS: usize = 4;

/// Unit normals of two entries with a lesser product do not stand in for each other.
pub(crate) const LIKE_NORMAL: f32 = 0.7;

/// An entry stands in for a hit that is at most so high above or below it.
pub(crate) const LIKE_HEIGHT: f64 = 0.5;

/// The same where no such entry is seen, as in folds and leaves: what faces the same half of the
/// space stands in better than darkness. It must be seen all the same.
pub(crate) const LEAST_NORMAL: f32 = 0.1;

/// See [`LEAST_NORMAL`].
pub(crate) const LEAST_HEIGHT: f64 = 2.0;

/// Entries that are tried for one hit, by each of the two rules.
///
/// The 27 cells around a hit on a wall have nine entries of its kind; four times as many in a fold.
pub(crate) const STAND_INS: usize = 32;

/// What has a surface so near above it, in cells of its size, is covered: states and hits of both
/// kinds do not stand for each other.
///
/// Behind a lamp that is flush with a ceiling there is much light, of which next to none comes out.
/// More than [`GAP`], so that other surfaces are entries of their own.
pub(crate) const COVER: f64 = 0.125;

/// Answers are means over starts within so many cells; where there are none, twice as many.
pub(crate) const ANSWER_REACH: f64 = 1.5;

/// Starts are at most so far outside of the cell of their entry: twice [`LIFT`] and its rounding.
pub(crate) const ABOVE: f64 = 2.0 * LIFT;

/// The least product of the normals of an entry and of a question that it answers.
pub(crate) const ANSWER_NORMAL: f64 = 0.6;

/// The share of a start's weight that is lost by each cell of height above the question's plane.
pub(crate) const ANSWER_HEIGHT: f64 = 1.5;

/// The share of its weight that a state has however little surface is in its cell; the rest grows
/// with the area.
///
/// Above 0, so that slivers answer where nothing else does.
pub(crate) const ANSWER_AREA: f64 = 0.2;

/// The share of a lamp in the power of all counts as at least this on the device, where single
/// precision may round it to 0.
#[cfg(feature = "gpu")]
pub(crate) const LEAST_SHARE: f64 = 1e-30;

/// Cosines of rays with surfaces count as at least this on the device, so that quotients of their
/// squares are finite in single precision.
#[cfg(feature = "gpu")]
pub(crate) const LEAST_COSINE: f64 = 1e-6;

/// Directions of a lobe that the device weighs for each pixel at least.
///
/// A mean of few rays by their weights leans towards what weighs little: for a dull surface under a
/// sky that is linear in height by 50% for one direction, 9% for two and 0.3% for eight.
#[cfg(feature = "gpu")]
pub(crate) const LEAST_TRIES: u32 = 8;

/// Rays of a pixel's lobe on the device at most: with more, a frame would take too long for drivers
/// that watch.
#[cfg(feature = "gpu")]
pub(crate) const MOST_MIRRORED: u32 = 64;

/// Farther than any face of a cell that a ray crosses.
#[cfg(feature = "gpu")]
pub(crate) const FAR: f64 = 1e9;

/// Beyond the box of what moved by so much, a segment cannot have met it. All margins around what
/// moved are so much larger, in cells of the grid also where cells are finer.
///
/// Ends of rays are stored in single precision, which rounds by 2^-14 cells; starts are up to
/// [`ABOVE`] outside of their cells.
pub(crate) const MOVED: f64 = 0.01;

/// The starts of an entry farther than this from what moved stay as they are.
///
/// In cells of its size. They depend on rays of [`OPEN_REACH`] from points of the cell or just
/// above it, and on segments between these.
pub(crate) const MOVED_STARTS: f64 = OPEN_REACH;

/// Hits farther than this from what moved, and from entries whose starts changed by it, are read as
/// before; so are hits farther than this from where cells have another size now.
///
/// In cells of the size there. Entries that stand in lie in cells next to that of a point just
/// above the hit: they, and the segments to them, are within two cells and [`ABOVE`] of the hit.
pub(crate) const MOVED_HITS: f64 = 2.0;

/// Links of states in cells farther than this from what moved stay.
///
/// They end at starts in the cells around, which are less than two cells away. States whose starts
/// changed are gathered anew, and drop the links around them.
pub(crate) const MOVED_LINKS: f64 = 3.0;

/// The angle from one direction to the next, as a share of the circle: the golden section spreads
/// any number of them evenly (Vogel 1979).
pub(crate) const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Angles between a normal and what may be met count as so much wider, in radians.
///
/// Normals come in single precision, which turns them by 2^-23; an arc cosine in double precision
/// errs by 2^-26 near 1.
pub(crate) const BAND: f64 = 1e-6;

/// Samples of a texture for each texel of a part of a triangle, and for each part at least and at most.
///
/// Four in a texel err by an eighth of it; 64 of a part with black and white texels err by 5%, but other
/// parts by other amounts.
pub(crate) const TEXEL_SAMPLES: f64 = 4.0;
/// See [`TEXEL_SAMPLES`].
pub(crate) const LEAST_SAMPLES: f64 = 4.0;
/// See [`TEXEL_SAMPLES`].
pub(crate) const MOST_SAMPLES: f64 = 64.0;

/// A triangle with a corner so many times as far from the middle as the median corner does not
/// stretch [`crate::Grid::around`].
pub(crate) const OUTLIER: f32 = 1000.0;

/// Triangles with a coordinate beyond this, in metres, never stretch [`crate::Grid::around`].
///
/// Single precision has steps of 8 m there.
pub(crate) const ABSURD: f32 = 1e8;

/// The least product of the unit normals of linked states: an angle of 26 degrees.
pub(crate) const LINK_NORMAL: f64 = 0.9;

/// Linked states are at most so many cells above or below each other: on one surface, also a bent
/// one.
pub(crate) const LINK_HEIGHT: f64 = 0.5;

/// Links of a state: the cells around it on a wall.
pub(crate) const MOST_LINKS: usize = 8;

/// Means over linked states: two take most blotches of 64 rays.
pub(crate) const MEANS: u32 = 2;

/// Less rough surfaces are mirrors: the lobe is narrower than a degree.
pub(crate) const LEAST_ROUGH: f32 = 1e-2;

/// Sizes of cells at most: those of the grid, and of two windows.
pub(crate) const GRIDS: usize = 3;

/// Cells of the finest window along an edge of a cell of the grid at most.
///
/// [`LIFT`] is then 1/64 of the finest cell: surfaces nearer to each other than that share their
/// light.
pub(crate) const FINEST: u32 = 16;

/// Windows stay while the eye is so near to their middle along each axis, as a share of their edge.
///
/// An eye that walks back and forth over a face of cells moves no window.
pub(crate) const WINDOW_REST: f64 = 0.125;

/// Cells along an axis at most.
pub(crate) const MOST_CELLS: u32 = 512;

/// References of cells to triangles at most: 2^25, which take 1.2 GB while the grid is built.
pub(crate) const MOST_REFERENCES: usize = 1 << 25;

/// One part out of so many is of states that rays hit, although questions ask for others: the light
/// of what moves would not come while something new is asked for in each frame.
pub(crate) const HIT_TURN: u32 = 4;

/// Rays of a state at most.
pub(crate) const MOST_RAYS: u32 = 4096;

/// Rays that are stored at most: they are numbered by 32 bits.
pub(crate) const MOST_STORED: usize = u32::MAX as usize;

/// Radiances, intensities and irradiances at most: their squares and sums stay finite in single
/// precision.
pub(crate) const BRIGHTEST: f32 = 1e12;
