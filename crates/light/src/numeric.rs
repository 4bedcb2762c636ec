//! Every margin and constant, with its reason. `device` hands those of the shaders to WGSL.

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

/// Cells grow by this share of their edge before triangles are tested. Coordinates of up to 512
/// cells have errors of 2^-15 of a cell in single precision, and the products of the test a few
/// times that.
pub const TOUCH: f32 = 1.0 / 2048.0;
/// The normal of a triangle is the cross product of two edges. Its rounding error is at most this
/// share of the product of their lengths: each component has two products and a difference, of
/// edges that are rounded themselves. For a sliver that is more than the normal, so that the test
/// of its plane must allow for it.
pub const NORMAL_ROUNDING: f32 = 8.0 * f32::EPSILON;

/// A ray or cone starts this many cells above a surface, times the sum s of the absolute components
/// of its normal. Its first samples must not read the surface. A plane touches cells whose centres
/// are up to s / 2 away from it. A linear filter reads centres up to s away, measured along the
/// normal. Together these make 1.5 s.
pub const PUSH_OFF: f32 = 1.5;

/// Albedos from 0 to 1 become integers of 10 bits. The sum of [`MOST_TRIANGLES`] of them fits into
/// 32 bits.
pub const UNIT: f32 = 1023.0;
/// Components of normals become integers of 9 bits and a sign.
pub const UNIT_NORMAL: f32 = 511.0;
/// Emission and the light of lamps are cut here: highlights make 653 times as much of it, and the
/// sum over all lights stays finite.
pub const BRIGHTEST: f32 = 1e30;
/// Triangles of a scene: 2^22 sums of 10 bits fit into 32.
pub const MOST_TRIANGLES: usize = 1 << 22;

/// Voxels of a convex body reach so far beyond it, in cells, on the mean: a cell counts as soon as
/// it is touched. Seen along an axis, the cells that touch a disc of radius r cover 4 r + 1 cells
/// more than the disc, its circumference times this number and a bit.
pub const GROWTH: f32 = std::f32::consts::FRAC_2_PI;
/// Normals whose mean is shorter face so many ways that none stands for the cell: a thin sheet with
/// two sides.
pub const CANCELLED: f32 = 0.2;
/// The greatest number of a half float.
pub const LARGEST_HALF: f32 = 65504.0;
/// Corners further than this many cells from the grid are left out: products of three coordinates
/// stay finite.
pub const FARTHEST: f32 = 1e6;
/// A cell is at least this share of the greatest coordinate: single precision tells 16 places in
/// it.
pub const LEAST_CELL: f32 = 16.0 * f32::EPSILON;
/// Farther than all there is, in cells.
pub const FAR: f32 = 1e9;
/// Instead of zero, where it is divided by.
pub const TINY: f32 = 1e-6;
/// Steps of a cone: the narrowest one has texels of one cell, and the diagonal of the largest grid
/// takes so many of the shortest steps. A walk takes fewer, at most three times the cells along the
/// longest axis.
pub const MOST_STEPS: u32 = 9000;
const _: () = assert!(MOST_STEPS as f32 * LEAST_STEP > 1.7321 * *RESOLUTIONS.end() as f32);
/// Ambient occlusion of something at the reach of the cones counts a hundredth of that nearby.
pub const NEAR_FADE: f32 = 99.0;
/// The tangent of half the angle of the narrowest reflection: one degree, below which it costs only
/// time (digest 2.4).
pub const NARROWEST: f32 = 0.0175;

/// Storage buffers that one shader binds: `merge` has the most.
pub const STORAGE_BUFFERS: u32 = 9;

/// So many pairs of bricks are looked at for shadows that change, a few dozen milliseconds; where
/// there are more, all light is made anew.
pub const MOST_SHADOW_PAIRS: usize = 1 << 22;

/// The tangent of half the angle of the widest reflection, sqrt(5) / 2: that of an exponent of 2.
pub const WIDEST_REFLECTION: f32 = 1.12;
