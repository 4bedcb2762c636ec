//! Margins of the walks: direction masks, frustum in cells, patches before they are drawn.

/// Half-spaces are widened by this many cells.
///
/// Far more than the rounding of sums of three products of coordinates up to 2^21 cells (about
/// 1e-9), far less than a cell.
pub(crate) const HALF_SPACE: f64 = 1e-6;

/// A half-space whose value changes by less than this from column to column is not divided by: it
/// is decided at the ends of the row. Larger slopes give quotients of which [`HALF_SPACE`] still
/// covers the rounding.
pub(crate) const ROW_SLOPE: f64 = 1e-9;

/// Beyond this distance from the grid, in cells, nothing is taken to be hidden: [`HALF_SPACE`]
/// holds for coordinates up to twice that.
pub(crate) const FAR_VIEWER: i32 = 1 << 20;

/// Widening of the lattice lines around a pixel of a direction mask if the eye is not known
/// exactly, in pixels or cells.
///
/// Covers a product and a quotient of numbers up to 2^14 cells and 2^12 pixels. Without an
/// uncertain eye all of this is integer arithmetic.
pub(crate) const MASK: f64 = 1e-9;

/// Widening of the slab of a patch, as a share of its coordinates: three products, a transform and
/// two differences, each with a relative error of 1e-16.
pub(crate) const SLAB: f64 = 1e-12;

/// Added to the sine of the greatest angle between the normals of a patch, which is kept in single
/// precision and was found on rounded normals.
pub(crate) const FRONT_SINE: f64 = 1e-4;

/// Growth of the region that the near plane cuts away, as a share of its size, when it is compared
/// with the slab of a patch: sums of three products.
pub(crate) const CUT_REGION: f64 = 1e-9;

/// Sums of a plane's equation in single precision are compared with this share of the greatest
/// coordinate and the offset together.
///
/// Four products and three sums for the middle of a box and as many for its reach, with numbers
/// rounded before, are each off by at most 2^-24 of three times the greatest coordinate: 1.5e-6
/// together. What is nearer to the plane is tested in double precision.
pub(crate) const SINGLE_FRUSTUM: f64 = 4e-6;

/// An eye that may be this far outside its cell, in cells, gets no occlusion by
/// [`crate::Method::Cell`]: the shells then grow by that much at each step. The rule is made for
/// eyes that are known roughly: with 8 in the place of this it loses what rooms of eyes see through
/// small holes beside them.
pub(crate) const UNCERTAIN_EYE: f64 = 0.2;

/// Objects nearer to the eye than this share of a cell are visible without a test by
/// [`crate::Method::Point`]: nearness, which is the inverse of a depth, stays below 50 cells.
/// Larger values only make more objects visible.
pub(crate) const NEAREST: f64 = 0.02;
