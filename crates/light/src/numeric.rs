//! Every margin and constant, with its reason. `kernel` hands those of the shaders to WGSL.

use std::ops::RangeInclusive;

/// Cells along the longest axis.
pub const RESOLUTIONS: RangeInclusive<u32> = 16..=512;
/// Edge of a brick in cells.
pub const BRICK: u32 = 8;
/// Cells of a brick.
pub const BRICK_CELLS: u32 = BRICK * BRICK * BRICK;
/// Directional mips: the coarsest has texels of 32 cells. Wider cones read those.
pub const LEVELS: u32 = 5;
/// Cones at most.
pub const MOST_CONES: usize = 16;
/// The shortest step of a cone, in texels.
pub const LEAST_STEP: f32 = 0.1;

/// Cells grow by this share of their edge before triangles are tested. Coordinates of up to 512 cells have errors of 2^-15 of a cell in single
/// precision, and the products of the test a few times that.
pub const TOUCH: f32 = 1.0 / 2048.0;
/// The normal of a triangle is the cross product of two edges. Its rounding error is at most this share of the product of their lengths:
/// each component has two products and a difference, of edges that are rounded themselves. For a sliver that is more than the
/// normal, so that the test of its plane must allow for it.
pub const NORMAL_ROUNDING: f32 = 8.0 * f32::EPSILON;

/// A ray or cone starts so many cells above a surface, times the sum of the components of its normal. A plane touches
/// cells whose centres are up to half that sum away. From a point, a filter sees centres within one sum, and a voxel's centre may lie
/// half a sum behind its plane: 0.5 + 1 from the surface, and no less from a centre, as the exact walk needs no filter.
pub const PUSH_OFF: f32 = 1.5;

/// Albedo is summed as integers of 10 bits, so that [`MOST_TRIANGLES`] of them fit into 32 bits.
pub const UNIT: f32 = 1023.0;
/// The same for normals, which have a sign.
pub const UNIT_NORMAL: f32 = 511.0;
/// Of the emission of a cell the greatest counts, as a share of the brightest in the scene: as many steps as single precision tells with room.
pub const UNIT_EMISSION: f32 = 1_048_575.0;
/// Triangles of a scene: 2^22 sums of 10 bits fit into 32.
pub const MOST_TRIANGLES: usize = 1 << 22;

/// Voxels of a convex body reach so far beyond it, in cells, on the mean: a cell counts as soon as it is touched. Seen along an axis, the cells
/// that touch a disc of radius r cover 4 r + 1 cells more than the disc, its circumference times this number and a bit.
pub const GROWTH: f32 = std::f32::consts::FRAC_2_PI;
/// Normals whose mean is shorter face so many ways that none stands for the cell: a thin sheet with two sides.
pub const CANCELLED: f32 = 0.2;
/// The greatest number of a half float.
pub const LARGEST_HALF: f32 = 65504.0;
/// Corners further than this many cells from the grid are left out: products of three coordinates stay finite.
pub const FARTHEST: f32 = 1e6;
/// A cell is at least this share of the greatest coordinate: single precision tells 16 places in it.
pub const LEAST_CELL: f32 = 16.0 * f32::EPSILON;
/// Farther than all there is, in cells.
pub const FAR: f32 = 1e9;
/// Instead of zero, where it is divided by.
pub const TINY: f32 = 1e-6;
/// Steps of a cone: the narrowest one has texels of one cell, and the diagonal of the largest grid takes so many of the shortest steps.
/// A walk takes fewer, at most three times the cells along the longest axis.
pub const MOST_STEPS: u32 = 9000;
const _: () = assert!(MOST_STEPS as f32 * LEAST_STEP > 1.7321 * *RESOLUTIONS.end() as f32);
/// Ambient occlusion of something at the reach of the cones counts a hundredth of that nearby.
pub const NEAR_FADE: f32 = 99.0;
/// The tangent of half the angle of the narrowest reflection: one degree, below which it costs only time (digest 2.4).
pub const NARROWEST: f32 = 0.0175;

/// So many pairs of bricks are looked at for shadows that change, a few dozen milliseconds; where there are more, all light is made anew.
pub const MOST_SHADOW_PAIRS: usize = 1 << 22;

/// The tangent of half the angle of the widest reflection, sqrt(5) / 2: that of an exponent of 2.
pub const WIDEST_REFLECTION: f32 = 1.12;
