//! Margins of views: matrices, eyes, planes.
//!
//! Matrices come in single precision; one rounding to it is 2^-24 of the number.

/// An element of a matrix is off by this share of itself: up to two roundings to single precision,
/// with a factor of two to spare.
pub(crate) const ELEMENT: f64 = 1.0 / (1u64 << 22) as f64;

/// A plane through the eye is off by this share of the eye's distance from the origin.
///
/// Covers 16 roundings of 2^-24. A product of three matrices in single precision, or an inverse,
/// makes up to 14.
pub(crate) const EYE_ROUNDING: f64 = 1.0 / (1u64 << 20) as f64;

/// A given eye is refused if it is farther than this from a plane that contains the matrix's eye,
/// as a share of its distance from the origin plus the distance that it sees.
///
/// Four times [`EYE_ROUNDING`]: in between, where longer chains of products lead, and targets far
/// from the origin, the eye is taken to be known roughly.
pub(crate) const EYE_REFUSED: f64 = 4.0 * EYE_ROUNDING;

/// The target of a camera (of an orbit, say) lies no farther from it than this many times its near
/// distance, or than its far plane: with the usual near distance of 0.1, a thousand units.
pub(crate) const SIGHT: f64 = 1e4;

/// The difference of two rows that cancel is rounding up to this share of them: 8 roundings of
/// 2^-24 of each. Then it is the far plane of an infinite projection, or so far away that leaving
/// it out makes little difference.
pub(crate) const CANCELLED: f64 = 1.0 / (1u64 << 20) as f64;

/// Rays are parallel if w changes across the view by this share of the change of x or y.
///
/// For a perspective that ratio is about half the field of view in radians; for products with an
/// orthographic matrix it is exactly zero.
pub(crate) const PARALLEL: f64 = 1e-9;

/// Three unit normals that span a smaller volume are taken to lie in one plane. Nothing rests on
/// the exact value: the error of an eye grows with the inverse of the volume.
pub(crate) const FLAT_VOLUME: f64 = 1e-9;

/// Half-spaces given by the application go through the eye if they miss it by this share of the
/// products that make its distance: one step of single precision.
pub(crate) const THROUGH_EYE: f64 = 1.0 / (1u64 << 23) as f64;

/// Regions are clipped at planes moved outwards by this share of the coordinates. Distances from
/// planes err by a quarter of it, and so do the points where edges cross the plane, along its
/// normal.
pub(crate) const CLIP: f64 = 64.0 * f64::EPSILON;

/// A plane faces parallel rays only if the cosine between its normal and their direction is
/// greater: the sides of an orthographic view run along the rays but for the rounding of its
/// matrix.
pub(crate) const ALONG_RAYS: f64 = 1e-6;

/// Two sides of a view whose unit normals make a smaller sine with each other meet in no direction
/// that is known: that of normals with this sine is off by 1e-15 / 1e-6.
pub(crate) const NO_CORNER: f64 = 1e-6;

/// A direction lies in a side of a view, or inside, up to this sine: ten times the error of
/// [`NO_CORNER`]. A corner too many makes a view that may turn larger.
pub(crate) const IN_SIDE: f64 = 1e-8;

/// The directions of a view make at least this sine with the plane across its middle, and with its
/// sides the middle itself: half a thousandth of a degree less than flat. Nothing rests on the
/// exact value.
pub(crate) const NOT_FLAT: f64 = 1e-5;

/// Added to the sine of the angle by which a view may turn: far more than [`IN_SIDE`] and the
/// rounding of unit vectors.
pub(crate) const TURN: f64 = 1e-7;

/// Before the near plane of a view that may turn, the region where rays may start is larger by this
/// many times the rounding of that plane. The near planes of one camera in two places differ by up
/// to four times that, and at the corners by as much more as these are farther away. Nothing rests
/// on the exact value.
pub(crate) const NEAR_ROUNDINGS: f64 = 8.0;

/// The ball in which rays of a view that may turn start is larger by this share: then a view serves
/// itself, for which [`REGION`](crate::numeric::shape::REGION) is asked for.
pub(crate) const NEAR_ROOM: f64 = 4e-9;
