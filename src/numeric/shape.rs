//! Margins of shapes and plain geometry.
//!
//! "A share of the coordinates" is a factor for the greatest absolute coordinate (or plane offset)
//! that takes part. `f64::EPSILON` is 2^-52, two roundings to nearest.

/// Distances of points from planes, spheres and boxes, as a share of the coordinates.
///
/// Covers a sum of three products and an offset, and the difference of two points before it: fewer
/// than 8 roundings of 2^-53 each, so that 16 units of 2^-52 leave a factor of four.
pub(crate) const DISTANCE: f64 = 16.0 * f64::EPSILON;

/// Whole boxes against a sphere, in units of the sphere's own margin ([`DISTANCE`]).
///
/// The rows of a sphere apply the margin to the radius and once more after the square root. Tests
/// of boxes stay outside of both, so that no box contradicts the rows.
pub(crate) const SPHERE_BOX: f64 = 4.0;

/// Corners that were computed in double precision, as a share of the coordinates.
///
/// Covers one rounding for each of three coordinates, and as much again for the numbers they come
/// from.
pub(crate) const CORNER: f64 = 4.0 * f64::EPSILON;

/// Points this close to the plane of a face lie on it, as a share of the solid's size.
///
/// Far above the rounding of double precision (1e-16), far below the steps of single precision
/// (6e-8).
pub(crate) const FLAT: f64 = 1e-9;

/// Points this close to the hull of the others are left out of it, as a share of the hull's size.
///
/// Copies of one corner in single precision differ by a few steps of 6e-8.
pub(crate) const KEPT: f64 = 1e-6;

/// A solid that must be pulled towards its middle by more than this share of itself is refused: it
/// is so thin that little of it is left between roundings.
pub(crate) const MAX_PULL: f64 = 1e-3;

/// The side of a plane through three points that a fourth one lies on, as a share of the sum of the
/// magnitudes of all products.
///
/// The determinant of three differences errs by (7 + 56 2^-53) 2^-53 of it (Shewchuk 1997); twice
/// as much leaves room for the rounding of that sum. Closer points are decided exactly.
pub(crate) const ORIENTATION: f64 = 8.0 * f64::EPSILON;

/// The same where products leave the range of normal numbers: 2^-1074 for each, times coordinates
/// up to 2^129.
pub(crate) const ORIENTATION_LEAST: f64 = 1e-270;

/// Sums of four products by error-free transformations err by less than this share of the sum of
/// their magnitudes, beyond one rounding (Ogita, Rump and Oishi 2005: (4 * 2^-53)^2 = 2^-102).
pub(crate) const TWICE: f64 = 1.0 / (1u128 << 100) as f64;

/// Three planes whose unit normals span a smaller volume do not help to find the middle of a solid.
/// The middle is a start value only, so nothing depends on the exact number.
pub(crate) const ASKEW: f64 = 1e-7;

/// Planes of a cone of directions are known to this angle in radians.
///
/// A face that is seen edge-on may be taken to be turned either way, which moves a silhouette plane
/// by the distance of that face from the eye (a few units in the last place of the coordinates)
/// over the distance of the edge: with [`NEAREST_EDGE`], 1e-15 / 1e-5 with a factor of 20 to spare.
pub(crate) const CONE_MARGIN: f64 = 2e-9;

/// An edge closer to the eye than this share of the coordinates of its ends has no silhouette plane
/// that is known to [`CONE_MARGIN`].
pub(crate) const NEAREST_EDGE: f64 = 1e-5;

/// An edge seen by parallel rays whose sine with them is smaller has no silhouette plane that is
/// known.
pub(crate) const STEEPEST_EDGE: f64 = 1e-9;

/// An edge shorter than this share of the coordinates has no direction: its ends are roundings
/// apart.
pub(crate) const NO_EDGE: f64 = 1e-12;

/// If the middle of a polytope is closer to a silhouette plane than this share of the coordinates,
/// it is uncertain on which side of the plane the polytope lies.
pub(crate) const NO_WIDTH: f64 = 1e-9;

/// An occluder may leave the box of its bounds by this share of the box's diagonal: room for models
/// and occluders made by hand, which are a little inexact.
pub(crate) const OCCLUDER_SHARE: f64 = 1e-3;

/// An occluder may leave the box of its bounds also by this share of the coordinates: applications
/// compute both in single precision, whose steps are 6e-8.
pub(crate) const OCCLUDER_ROUNDING: f64 = 1e-6;

/// Boxes of regions in front of the near plane, and solids compared with them, count as larger by
/// this share of the coordinates: far more than the rounding of the corners, far less than matters
/// to a solid.
pub(crate) const REGION: f64 = 1e-9;

/// An error along each of three axes is shorter than this times itself: the root of 3 is less.
pub(crate) const LENGTH_OF_ERROR: f64 = 2.0;

/// Where a transform scales all axes alike but for [`crate::numeric::mesh::ANGLES`], it scales
/// every length as the x axis but for this share.
///
/// Of the product of the matrix with its transpose, in units of the squared length of the x axis,
/// eight elements differ from those of the identity by 1e-5 at most: its eigenvalues differ from 1
/// by the root of 8 times that at most, and their roots by half as much, 1.42e-5.
pub(crate) const ALIKE: f64 = 2e-5;

/// A convex occluder under a transform that must be pulled towards its middle by more than this
/// share of itself, to make room for single precision, hides nothing: it is hardly thicker than
/// that room.
pub(crate) const MOST_PULL: f64 = 0.5;
