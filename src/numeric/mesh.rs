//! Margins of meshes: preparation, outlines, cells of triangles, instances, files.

/// Triangles are widened by this share of their greatest coordinate before cells are compared with
/// them.
///
/// A corner that comes from a cut errs by fewer than 16 units in the last place of that coordinate.
/// Three cuts and one interpolation follow each other: 64 units, 1.5e-14. A separating-axis test
/// errs by about as much.
pub(crate) const TRIANGLE: f64 = 1e-12;

/// The distance of a triangle's plane from a point, times the length of its normal, errs by fewer
/// than 16 roundings of the product of two sides and of the distance of their corner: of a triangle
/// that is long and narrow, this is more than [`TRIANGLE`] counts.
pub(crate) const NORMAL: f64 = 16.0 * f64::EPSILON;

/// The slab of a patch is widened by this share of its greatest coordinate: a dot product with a
/// unit normal errs by fewer than 4 units in the last place, 1e-15.
pub(crate) const SLAB: f64 = 1e-12;

/// The sine of the greatest angle between a patch's normal and its triangles is raised by this. A
/// cosine that rounding made too large by e = 1e-15 makes the sine of a small angle too small by
/// sqrt(2 e) = 5e-8.
pub(crate) const SINE: f64 = 1e-6;

/// The slack of a simplified side is raised by this share of itself, which covers the roundings of
/// the distance that it was computed from (below 1e-14) and of the comparison with it.
pub(crate) const SLACK: f64 = 1e-6;

/// Faces of the convex parts of a mesh are moved outwards by this share of the coordinates and of
/// the size: more than all roundings of dot products and cuts in double precision (below 1e-13).
pub(crate) const PART_ROOM: f64 = 1e-7;

/// Corners of a part this share of its room ([`PART_ROOM`]) beyond a plane are not cut off: cutting
/// there would make edges that are too short to have a direction.
pub(crate) const PART_CUT: f64 = 1e-3;

/// Parts are at least this share of their size thick, so that flat pieces of a mesh get an inside.
pub(crate) const PART_THICKNESS: f64 = 1e-4;

/// An element off the diagonal of a scatter matrix counts as zero from this share of the diagonal
/// on: the rotations that remain are rounding.
pub(crate) const DIAGONAL: f64 = 1e-14;

/// Renderers transform vertices in single precision: vertices may lie this share of the greatest
/// coordinate from the place that double precision gives. Four products and sums, twice.
pub(crate) const SINGLE: f64 = 8.0 * f32::EPSILON as f64;

/// A transform flattens space if its determinant is below this share of the cube of its growth:
/// normals under it are not known.
pub(crate) const FLATTENS: f64 = 1e-9;

/// A transform keeps angles if squared lengths and products of its axes are equal to this share:
/// sixteen steps of a matrix in single precision, with a factor of ten to spare.
pub(crate) const ANGLES: f64 = 1e-5;

/// A part of an instance is replaced by its box if room for [`SINGLE`] makes it larger by this
/// factor: it is thinner than twenty times the room.
pub(crate) const MOST_GROWTH: f64 = 1.1;

/// Share of the coordinates by which numbers in a file may disagree with each other, where one
/// follows from others: far above all roundings of the preparation.
pub(crate) const FILE_ROUNDING: f64 = 1e-6;

/// A mesh counts as convex if no vertex lies farther before the plane of a triangle than this share
/// of its size. Its solid is smaller by twice the distance found, so a larger share costs tightness
/// only.
pub(crate) const DENT: f64 = 1e-4;

/// The solid of a convex mesh is smaller by this share of its greatest coordinate, above the
/// roundings of the distances of vertices from planes (16 units in the last place, 4e-15).
pub(crate) const HULL_ROOM: f64 = 1e-12;

/// The solid inside a mesh is smaller by this share of its greatest coordinate, above the roundings
/// of the distances of vertices from planes (16 units in the last place, 4e-15).
pub(crate) const INNER_ROOM: f64 = 1e-12;

/// Offsets of planes that are fitted to a sample of triangles are made smaller by this factor: they
/// are found in single precision (two roundings of 6e-8 each), and no triangle of the sample may be
/// left out. The offsets that hide are then found from all triangles, in double precision: nothing
/// rests on the exact value.
pub(crate) const INNER_FIT: f64 = 1.0 - 1e-5;

/// The middle of the solid inside a mesh is deeper behind all its planes than this share of its
/// size. No triangle comes nearer to the middle then, so that the solid angles that it sees them at
/// are known to 1e-8.
pub(crate) const INNER_DEPTH: f64 = 1e-3;

/// A sum of solid angles in units of the whole sphere that is no farther than this from a whole
/// number is that number: far above the rounding of ten million angles, far below a half.
pub(crate) const WINDING: f64 = 0.125;
