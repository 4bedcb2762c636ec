//! Every margin of rounding, with its name and the reason for its size. One section for each part
//! of the crate.

// Objects and their cells.

/// An occluder may stick out of its bounds by this share of their diagonal: roundings of the
/// application's own arithmetic.
pub(crate) const OCCLUDER_SHARE: f64 = 1e-3;

/// An occluder may also stick out by this share of the greatest coordinate: two roundings to single
/// precision.
pub(crate) const OCCLUDER_ROUNDING: f64 = 1.0 / (1u64 << 22) as f64;

/// Shapes touch the cells within this share of a cell around them. Grid lines are at most 2^29
/// cells from the origin, so that coordinates inside a grid, and points where sides cross its
/// lines, err by less than 2^-22 of a cell. A margin above zero also makes shapes touch both cells
/// beside a line that they end on.
pub(crate) const TOUCH: f64 = 1.0 / (1u64 << 20) as f64;

/// Corners of the polygon that stands for a disc lie inside of it by this share of the radius: far
/// more than the error of a sine.
pub(crate) const INSIDE_DISC: f64 = 1e-9;

/// A point counts as inside a disc up to this share of its distance from the centre: four roundings
/// of the squared distance.
pub(crate) const ON_DISC: f64 = 8.0 * f64::EPSILON;

// Views.

/// Directions of a view's sides are rounded to multiples of this: by 2^-41 an axis.
pub(crate) const DIRECTION: f64 = 1.0 / (1u64 << 40) as f64;

/// The sides of a view or of a disc are tilted outwards by this, in radians: more than the rounding
/// to multiples of [`DIRECTION`] and the errors of sines together.
pub(crate) const TILT: f64 = 4.0 * DIRECTION;

/// A sector whose half angle is less than this below half a turn is a whole turn: its two sides,
/// each tilted by [`TILT`], would meet or cross.
pub(crate) const WHOLE: f64 = 5.0 * DIRECTION;

// Exact visibility from a point.

/// Filters of the exact predicates allow for this share of each product: a difference, a product
/// and a sum are off by 2^-53 each, products of two differences and their sum by five times that.
/// Twice as much is used.
pub(crate) const ROUNDINGS: f64 = 5.0 * f64::EPSILON;

/// The point where a ray hits a wall is known to this many times its relative error: the
/// first-order error of a quotient (the share itself), what is left of higher orders for shares
/// below [`HIT_SHARE`], and the roundings of the product.
pub(crate) const HIT_ROOM: f64 = 4.0;

/// With a greater relative error, the point where a ray hits a wall may be anywhere on it.
pub(crate) const HIT_SHARE: f64 = 0.1;

/// Directions whose keys, from 0 to 4, are farther apart than this are in the order of their keys.
/// Two differences, a sum and a quotient are rounded, which makes 2.5 times 2^-53, and the sum with
/// the number of a quarter, which makes 2^-52: two keys are off by 2^-49.8 at most.
pub(crate) const KEY: f64 = 1.0 / (1u64 << 49) as f64;

/// The key of the direction in which two walls cross is known to this many times the relative error
/// of its vector, for shares below [`HIT_SHARE`]: to once of it to the first order, and to 1.3
/// times with the others.
pub(crate) const CROSSING_KEY: f64 = 2.0;

/// Distances are compared with ranges and radii that are larger by this share: twenty roundings, of
/// differences, products and roots.
pub(crate) const DISTANCE: f64 = 20.0 * f64::EPSILON;

/// Walls are clipped to squares of cells that are smaller by this share of a cell. A ray to a
/// clipped end may hit the wall as far as that from it; flatter rays are not used.
pub(crate) const CLIPPED: f64 = 1.0 / 8.0;

/// A clipped end is off by less than this many times the rounding of a coordinate: by the diagonal
/// of both axes, the square root of two.
pub(crate) const BOTH_AXES: f64 = 2.0;

/// The cells of a shell are found with this margin, in cells: slopes err by 2^-51 and are
/// multiplied by 2^25 at most.
pub(crate) const SHELL: f64 = 1.0 / (1u64 << 18) as f64;

// Tiles.

/// Field of view on tiles.
///
/// Positions are whole numbers of `2^-TILE_BITS` of a tile, and the sweep only adds and compares
/// them: it rounds nothing.
pub(crate) mod tiles {
    /// Bits of a tile: a position is a multiple of `2^-28` of a tile.
    ///
    /// That holds single precision (24 bits) exactly from 1/16 of a tile on.
    pub(crate) const TILE_BITS: u32 = 28;

    /// A tile, in units of positions.
    pub(crate) const TILE: i64 = 1 << TILE_BITS;

    /// Positions have no coordinate beyond this many tiles. Grids have at most `2^32` rows or
    /// columns, so that differences stay below `2^61` units, and sums of two of them fit into 64
    /// bits.
    pub(crate) const FARTHEST: f64 = (1u64 << 32) as f64;

    /// The length of the whole numbers that the two directions of a sector are rounded to.
    /// Denominators of slopes are this times [`TILE`], at most `2^58`.
    pub(crate) const DIRECTION: f64 = (1u64 << 30) as f64;

    /// A sector is wider than asked for by this angle at each side, in radians. Rounding to whole
    /// numbers turns its directions by up to `2^-30.5`; angles in double precision err by far less.
    pub(crate) const SECTOR: f64 = 1.0 / (1u64 << 29) as f64;
}
