//! All floating-point margins and factors of the crate, each with its reason, and the exact predicates.
//!
//! The predicates are Shewchuk's (1997, "Adaptive Precision Floating-Point Arithmetic and Fast
//! Robust Geometric Predicates"), from the crate `robust`. They are exact as long as nothing over-
//! or underflows; [`normalized`] makes sure of that.

use glam::{DVec3, Vec3};
use robust::{Coord, Coord3D};

/// Coordinates below this fraction of the largest one are rounded to multiples of [`FINEST`].
/// Larger doubles are multiples of it.
const FINE: f64 = FINEST * (1_u64 << 53) as f64;

/// 2^-160. Determinants of three coordinates are then multiples of 2^-480, which a double can hold:
/// the exact predicates need it.
const FINEST: f64 = 1.0 / ((1_u128 << 80) as f64 * (1_u128 << 80) as f64);

/// The rounding error of `normal * p - offset`, for coordinates within ±2, in units of the product of the two
/// edges' largest coordinates. A component of the normal is off by 8 units of 2^-53 (two products of rounded
/// differences, and their difference); the three products and their sum add 18; the offset has the same error
/// again: 84 units for coordinates within ±1, twice as many within ±2, below these 256.
pub(crate) const PLANE_ERROR: f64 = 128.0 * f64::EPSILON;

/// Points nearer to the eye than this fraction of the largest distance count as at the eye: the squares of
/// their coordinates are near the smallest that a double can hold, so they have no direction.
pub(crate) const AT_EYE: f64 = 1e-150;

/// Positions in a picture are whole multiples of 1/256 of a pixel, as in graphics processors: sums
/// of them are exact, so that a square has the same pixels wherever it is computed.
pub(crate) const SUBPIXELS: u32 = 256;

/// A float of at least 2^15 and below 2^16 is a multiple of 1/256, so that adding this one rounds to these.
const ROUNDS_TO_SUBPIXELS: f32 = 49152.0;

/// A position in pixels, rounded to 1/256 of a pixel; those below -1 and above 16383 become these.
/// NaN is far outside.
#[inline(always)]
pub(crate) fn to_subpixels(pixels: f32) -> i32 {
    let rounded = pixels.clamp(-1.0, 16383.0) + ROUNDS_TO_SUBPIXELS;
    (rounded.to_bits() as i32).wrapping_sub(ROUNDS_TO_SUBPIXELS.to_bits() as i32)
}

/// Origins of clouds are multiples of it, in units of the cloud: a small cloud near zero keeps the
/// origin zero, and sums of an origin below 2^39 and a position are exact in double precision.
/// Positions up to it from the origin resolve to 6e-5 units in single precision.
#[cfg(feature = "files")]
const ORIGIN_STEP: f64 = 1024.0;

/// The multiple of 1,024 in each coordinate nearest to a point, or zero: no survey goes beyond 2^39
/// units, so such a point is an error, and positions relative to it would lose all others.
#[cfg(feature = "files")]
pub(crate) fn origin_near(point: DVec3) -> DVec3 {
    let near = (point / ORIGIN_STEP).round() * ORIGIN_STEP;
    if near.abs().max_element() <= 549_755_813_888.0 { near } else { DVec3::ZERO }
}

/// A normal of length 1, in the direction of one of any length; zero for one that is void: of no
/// length, or not finite. In double precision, in which no square of a float over- or underflows.
pub(crate) fn unit(normal: Vec3) -> Vec3 {
    if normal.is_normalized() { normal } else { normal.as_dvec3().normalize_or_zero().as_vec3() }
}

/// The half side of squares over the spacing of points, for points spread at random. Of 0.3, 0.6 and 1 it had
/// the fewest errors in the streets that the viewer of commit 4aa26696 makes, with the thesis' bias of 0.05.
#[cfg(feature = "bricks")]
pub(crate) const SQUARE_OF_SPACING: f32 = 0.6;

/// The least square of the sine between two edges that span a plane: below some 14 degrees the
/// noise of their ends turns it too much.
pub(crate) const THIN: f32 = 0.06;

/// The least determinant of a fit of a plane, as a part of the product of its two squares: below it
/// points are nearly on a line.
pub(crate) const FLAT: f32 = 1e-3;

/// Neighbours whose directions differ by less than this sine are in one direction: some ten
/// roundings of single precision.
pub(crate) const SAME_DIRECTION: f32 = 1e-6;

/// A ray whose cosine with the normal of a disc is smaller does not hit it: the place where it
/// would is off by a thousand roundings.
pub(crate) const ALONG: f32 = 1e-3;

/// Eyes farther than this from a cloud of about unit size are taken to be as far: their rays are
/// parallel in double precision, and squares of such a distance are finite.
pub(crate) const FARTHEST_EYE: f64 = 1e100;

/// How much larger boxes of discs are, as a part of their size and place: some hundred roundings of
/// single precision, so that no ray that meets a disc misses its box.
pub(crate) const BOX: f32 = 1e-5;

/// A power of two that brings the largest coordinate `largest` into `[0.5, 2)`; those below 2^-1000
/// stay smaller.
pub(crate) fn power_of_two_for(largest: f64) -> f64 {
    let exponent = largest.log2().floor().clamp(-1000.0, 1023.0);
    (-exponent).exp2()
}

/// A point multiplied by a power of two, with tiny coordinates rounded so that the predicates are exact.
pub(crate) fn normalized(point: DVec3, scale: f64) -> DVec3 {
    let fine = |x: f64| if x.abs() < FINE { (x / FINEST).round_ties_even() * FINEST } else { x };
    DVec3::from((point * scale).to_array().map(fine))
}

/// Positive if `p` lies above the plane of `a`, `b`, `c`, on the side from which they go
/// counterclockwise; 0 exactly on it.
pub(crate) fn above(a: DVec3, b: DVec3, c: DVec3, p: DVec3) -> f64 {
    let coord = |v: DVec3| Coord3D { x: v.x, y: v.y, z: v.z };
    -robust::orient3d(coord(a), coord(b), coord(c), coord(p))
}

/// Positive if the points go counterclockwise in the plane without the coordinate `axis`; 0 exactly
/// on a line.
pub(crate) fn turn(axis: usize, a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let coord = |v: DVec3| Coord { x: v[(axis + 1) % 3], y: v[(axis + 2) % 3] };
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// The order of cells along a curve (Morton 1966): the code of a cell has the lower 21 bits of three
/// numbers in turns, that of the first number foremost. Codes of near cells are often near.
pub(crate) fn morton(at: [u32; 3]) -> u64 {
    // Each step moves the upper half of every group of bits away from the lower.
    let spread = |x: u32| {
        let x = u64::from(x) & 0x1f_ffff;
        let x = (x | x << 32) & 0x001f_0000_0000_ffff;
        let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
        let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
        let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
        (x | x << 2) & 0x1249_2492_4924_9249
    };
    at.into_iter().fold(0, |key, x| key << 1 | spread(x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_coordinate_comes_near_one() {
        for largest in [f64::MIN_POSITIVE, 1e-200, 0.3, 1.0, 7.0, 1e300, f64::MAX] {
            let scaled = largest * power_of_two_for(largest);
            assert!((0.5..2.0).contains(&scaled) || largest < 1e-290, "{largest} {scaled}");
        }
    }

    #[test]
    fn pixels_are_rounded_to_subpixels() {
        for x in [-1.0, -0.3, 0.0, 1.0 / 512.1, 0.37, 640.4999, 8191.999, 16383.0] {
            assert_eq!(to_subpixels(x), (f64::from(x) * 256.0).round() as i32, "{x}");
        }
        assert_eq!([f32::NEG_INFINITY, f32::INFINITY].map(to_subpixels), [-256, 16383 * 256]);
        assert!(![f32::NAN, -f32::NAN].map(to_subpixels).iter().any(|x| (0..1 << 22).contains(x)));
    }
}
