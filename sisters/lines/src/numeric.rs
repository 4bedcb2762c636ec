//! All margins and constants of the estimate, each with its reason. A twin on another processor
//! reads them here.

/// A tangent this close to the direction of view (the sine of the angle) leaves no direction
/// towards the eye that is normal to it: single precision would give noise.
pub const ALONG_VIEW: f32 = 1e-4;

/// The room, as a share of the greatest coordinate, that a view gives to a set whose vertices are
/// all one point.
pub const DOT_ROOM: f64 = 1e-3;

/// A view around a set shows a ball so many times as wide as the set: nothing touches the border of
/// the picture.
pub const AROUND: f64 = 1.02;

/// The least near depth of a view around a set, as a share of the radius of what it shows: in
/// perspective the near depth must be above 0.
pub const LEAST_NEAR: f64 = 1e-3;

/// A view whose direction has a vertical component of this or more has no y axis that points up in
/// the picture: the z axis does, then.
pub const UPRIGHT: f64 = 0.99;

/// Segments of lines for each cell of a grid for rays, if they were spread evenly and short. Fewer
/// make rays cross more cells, more make them test more segments.
pub const SEGMENTS_IN_CELL: f64 = 0.5;

/// The side of a cell in margins, at least. A cell names each segment within a margin of it, so
/// that smaller cells would name too many.
pub const CELL_IN_MARGINS: f64 = 1.5;

/// The mean length of a segment in sides of a cell, at most (the sum of the ways along x, y and z):
/// it bounds the cells that long segments cross.
pub const LENGTH_IN_CELLS: f64 = 4.0;

/// The greatest number of cells in a row of a grid for rays: coordinates have 10 bits before the
/// point then, and 14 behind it.
pub const MOST_IN_ROW: f64 = 1024.0;

/// The part of a cell's side by which single precision may move a ray: some units of 2^-14.
pub const CELL_ROUNDING: f32 = 1.0 / 1024.0;

/// The margin of cells in radii of the hemisphere. Rays are no wider than it: wider ones have less
/// noise, but test more segments. With this share a large picture, whose tubes are thin, has the
/// rays of one of 480 x 360 pixels.
pub const MARGIN_IN_RADII: f32 = 0.05;

/// The least margin of cells in radii of the tubes that rays meet: rays are up to two tubes wide,
/// then.
pub const MARGIN_IN_TUBES: f32 = 3.0;

/// The greatest, for hemispheres of many tubes: it bounds the segments that a ray tests.
pub const MOST_MARGIN_IN_TUBES: f32 = 9.0;

/// Rays of a receiver, unless it is told another number: a quarter more noise than 32 in three
/// quarters of their time.
pub const USUAL_RAYS: u32 = 24;

/// The way along a line, as a share of the radius, from one set of rays to the next: noise moves
/// with the line, and has as many sets as there are in a hemisphere.
pub const SET_STEP: f32 = 1.0 / 8.0;

/// The way from place to place along a line, as a share of the radius: fine enough for threads that
/// go over and under each other.
pub const PLACE_STEP: f32 = 1.0 / 32.0;

/// Sides of a place. Half as many are too few for lines that touch each other: there a little turn
/// of the hemisphere frees it from a neighbour.
pub const SIDES: u32 = 16;

/// Rays of a side of a place. A pixel takes four sides, which are worth two and a quarter times as
/// many rays.
pub const USUAL_SIDE_RAYS: u32 = 12;

/// The width of a ray from a place, in those of a ray that is one of as many: a pixel has those of
/// four sides.
pub const SIDE_SPREAD: f32 = 0.7;

/// The greatest number of places along the lines of a set: a buffer of 16 bytes each has 128 MiB,
/// which all adapters bind.
pub const MOST_PLACES: u32 = 1 << 23;

/// A ray has at least this part of its length in each direction: no border of cells is crossed at a
/// place that is no number.
pub const LEAST_WAY: f32 = 1e-9;

/// Rays start this many radii of a tube above the middle of the receiver's own one, so that
/// rounding does not put them into it.
pub const RAY_LIFT: f32 = 1.01;

/// A line whose angle to a ray has a square of its sine below this is parallel to it: single
/// precision does not say where they are nearest, so that the ray meets the end of the tube that
/// it comes to first.
pub const RAY_PARALLEL: f32 = 1e-8;

/// A ray that lets less than this through is stopped.
pub const STOPPED: f32 = 1.0 / 256.0;

/// A pseudo-random number from two (the permutation RXS-M-XS of O'Neill 2014, "PCG", once for
/// each). It needs 32 bits only, so that shaders can compute it.
pub fn hash(a: u32, b: u32) -> u32 {
    let permuted = |value: u32| {
        let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
        (word >> 22) ^ word
    };
    permuted(a ^ permuted(b))
}
