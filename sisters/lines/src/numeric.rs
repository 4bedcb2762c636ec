//! All margins and constants of the estimate, each with its reason. A twin on another processor
//! reads them here.

/// The matrix of a view may differ from a rotation by this much in each entry of its product with
/// its transpose: matrices built in single precision do, by some roundings.
pub const NOT_RIGID: f64 = 1e-4;

/// The least sine of an angle to the tangent that the thesis' ratio of sines divides by: it keeps a
/// single prism, whose far end lies on the line's own direction, from outweighing all others.
pub const LEAST_SINE: f32 = 1e-3;

/// A base plane whose normal has a component along the column below this is parallel to it: the
/// crossing would lie thousands of radii away, so that the column is wholly above the plane or
/// wholly below.
pub const PARALLEL: f32 = 1e-6;

/// A tangent this close to the direction of view (the sine of the angle) leaves no direction
/// towards the eye that is normal to it: single precision would give noise.
pub const ALONG_VIEW: f32 = 1e-4;

/// The share of a solid angle that must be known for an estimate: below it one column would speak
/// for a whole hemisphere.
pub const LEAST_KNOWN: f32 = 1e-3;

/// The mean sine of the angle between a line and a ray, if all directions are alike: pi / 4.
pub const MEAN_SINE: f32 = std::f32::consts::FRAC_PI_4;

/// Parts of the disc of samples, see [`crate::occlusion::sector_of`]. Lines on one side do not hide
/// light from the other: each part is a medium of its own. More parts would hold too few samples
/// each.
pub const SECTORS: usize = 8;

/// The slices that share one sum of lengths in a column: with one sum for a whole column, what lies
/// far off blurs what is near; one for each slice would take four times the memory of this.
pub const GROUP: u32 = 16;

/// The room, as a share of the greatest coordinate, that a view gives to a set whose vertices are
/// all one point.
pub const DOT_ROOM: f64 = 1e-3;

/// The part of the greatest coordinate by which rounding may add to the error of simplified lines:
/// distances are some roundings of 2^-53. It is 2^24 times finer than coordinates are, so that a
/// tolerance of 0 still drops vertices of straight lines.
pub const SIMPLIFY_ROUNDING: f64 = 1.0 / (1u64 << 48) as f64;

/// The share of the range of numbers and colours by which simplified lines may be wrong, unless
/// they are told another: 4 of 255, hardly to be seen.
pub const VALUE_TOLERANCE: f32 = 1.0 / 64.0;

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

/// The names in the lists of cells after lines moved, in those of a grid that was made for lines:
/// of more, the grid no longer suits the lines, and rays test too many segments.
pub const MOST_NAMES: usize = 2;

/// The share of the vertices that may move before all is made anew: of 10% that lie together in
/// dense sets an update and its frame take 0.1 to 0.9 of the time of that, of 10% that are spread
/// 0.7 to 1.4, as few values of places stay; of 25% in one set, 1.3 and 1.7.
pub const MOST_MOVED: f64 = 0.1;

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

#[cfg(test)]
mod tests {
    use super::hash;

    #[test]
    fn hashes_of_neighbours_are_spread_evenly() {
        let mut counts = [0; 16];
        let pairs = (0..64).flat_map(|y| (0..64).map(move |x| (x, y)));
        pairs.for_each(|(x, y)| counts[(hash(x, y) % 16) as usize] += 1);
        // 256 in each on average; the root of the variance is 16.
        assert!(counts.iter().all(|n| (192..320).contains(n)), "{counts:?}");
        let same = (0..4096).filter(|&i| hash(i, 7) % 16 == hash(i + 1, 7) % 16).count();
        assert!((160..360).contains(&same), "{same}");
    }
}
