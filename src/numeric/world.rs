//! Margins of worlds: places in double precision, and what becomes of them near the origin of a
//! scene.
//!
//! Sums of a place and a coordinate need no margin: [`crate::geometry::offset`] knows their
//! rounding exactly. The eye needs none of its own: its place is rounded once, by 2^-53 of its
//! coordinates, and [`crate::numeric::shape::DISTANCE`] covers 32 such roundings, of which
//! distances need fewer than 8.

/// One rounding of double precision to nearest, as a share of the result.
pub(crate) const ONE_ROUNDING: f64 = f64::EPSILON / 2.0;

/// Planes of a view that is carried elsewhere are moved outwards by this share of the distance.
///
/// The offset of such a plane is the old one less a sum of three products with the distance, whose
/// components are rounded once: fewer than 8 roundings of 2^-53, so that 8 of 2^-52 leave a factor
/// of two. The margins of a view's planes are shares of the coordinates, too, but the eye must not
/// lie outside of a plane that went through it.
pub(crate) const CARRIED: f64 = 8.0 * f64::EPSILON;

/// No place of a world lies farther from its origin along an axis, in world units: 2^60.
///
/// Coordinates of shapes and sums of two places stay far below the greatest number in single
/// precision (2^128), also after transforms that scale.
pub(crate) const FARTHEST: f64 = (1u64 << 60) as f64;

/// No page is farther than this many pages from the first one.
///
/// The corner of a page is its number times 512 times the size of a cell, which has 24 digits: 28 +
/// 24 of them are an exact double.
pub(crate) const FARTHEST_PAGE: i32 = 1 << 28;

/// The cells of a world are no larger than this, so that no page lies beyond [`FARTHEST`]: 2^28
/// pages of 2^9 cells of 2^20.
pub(crate) const LARGEST_CELL: f32 = (1u32 << 20) as f32;

/// The cells of a world are no smaller than this: their last digits stay normal numbers.
pub(crate) const SMALLEST_CELL: f32 = 1.0 / (1u32 << 30) as f32;
