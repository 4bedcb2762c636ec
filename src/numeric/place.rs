//! Margins for places in double precision, and for their coordinates relative to a scene's origin.
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
