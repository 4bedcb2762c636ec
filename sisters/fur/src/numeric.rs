//! All margins and limits of the crate, each with its reason.

/// The greatest coordinate of a vertex: products of four of them stay finite in single precision.
pub(crate) const MAX_COORDINATE: f32 = 1e9;

/// The most triangles of a mesh: corners are then numbered by 32 bits.
pub(crate) const MAX_TRIANGLES: usize = 1 << 29;

/// A sum of unit normals shorter than this share of their number has no direction: it is the
/// rounding of normals that cancel.
pub(crate) const NO_DIRECTION: f64 = 1e-5;

/// How many times fewer triangles the next level of detail has, as in the thesis.
pub(crate) const COARSER: usize = 4;

/// Levels of detail have so many triangles at least, where the mesh has.
pub(crate) const LEAST_LEVEL: usize = 32;

/// How much colours (0 to 1 as stored) and lengths (0 to 1) count when a mesh is simplified, against
/// places as shares of the size of the mesh.
pub(crate) const COLOR_WEIGHT: f32 = 0.5;
pub(crate) const LENGTH_WEIGHT: f32 = 0.5;

/// Half the thickness of the slab around the surface in which points become roots, in cells.
/// Together with [`MAX_RADIUS`] it keeps all strands of a point within half a cell, so that eight
/// cells are enough: 0.25² + 0.43² < 0.5².
pub(crate) const HALF_SLAB: f32 = 0.25;

/// Cells on the radius of a mesh, unless the caller sets another spacing: strands of an animal that
/// fills a picture 700 pixels high are then about five pixels apart.
pub(crate) const CELLS_ON_RADIUS: f32 = 60.0;

/// The greatest radius of a strand, in cells; see [`HALF_SLAB`].
pub(crate) const MAX_RADIUS: f32 = 0.43;

/// The least radius of a mesh and spacing of strands: squares of smaller ones come near the least
/// numbers of single precision.
pub(crate) const LEAST_LENGTH: f64 = 1e-9;

/// The search for the root of a strand ends when a step changes its place by less than this share
/// of its triangle: far below what single precision, in which roots are handed out, can show.
pub(crate) const SETTLED: f64 = 1e-12;

/// The most points in a cell. The cost of a lookup grows with it, and four already cover the whole
/// surface.
pub const MAX_PER_CELL: u32 = 4;

/// Cells along each axis after which strands repeat; a power of two. A table of all points then
/// takes a megabyte.
pub const PERIOD: u32 = 16;

/// Texels of the table in a cell, along each axis.
pub const TEXELS: u32 = 4;

/// An odd number near the golden section of 2^32: times the byte of a strand it gives a length that
/// has nothing to do with its colour.
pub(crate) const SPREAD: u32 = 0x9e37_79b1;

/// The most explicit strands: 64 bytes each, so about a gigabyte.
pub(crate) const MAX_STRANDS: usize = 1 << 24;

/// The most cells along the edges of all triangles when strands are listed: looking at them takes
/// some seconds.
pub(crate) const MAX_EDGE_CELLS: f64 = 33_554_432.0;

/// The widest mesh, in cells: cell numbers of single precision are then exact with 2 bits for the
/// place within the cell left.
pub(crate) const MAX_CELLS: f32 = 4_194_304.0;

/// Barycentric coordinates below minus this lie outside of a triangle: roots on an edge must not
/// fall between two triangles.
pub(crate) const ON_EDGE: f64 = 1e-6;

/// Feet of one point that are nearer to each other than this, in cells, are one: a point above an
/// edge has a foot on both triangles, which differ by rounding and by [`ON_EDGE`].
pub(crate) const SAME_FOOT: f64 = 1e-3;

/// The relative error of a vertex that a shader extrudes and transforms in single precision: bounds
/// grow by it. Extruding takes three products and three sums, a transform four each; 16 units of
/// 2^-24 cover both with room.
pub(crate) const EXTRUSION_ERROR: f32 = 1e-6;

/// Layers at most: more bring nothing that a picture shows.
pub(crate) const MAX_LAYERS: u32 = 256;

/// The distance between layers that hides that they are layers, in pixels. Two neighbouring layers
/// then share most pixels.
pub(crate) const LAYER_GAP: f32 = 1.5;

/// Fur lower than this is less than what one sample of a pixel can show, in pixels.
pub(crate) const FLAT_FUR: f32 = 0.5;

/// Pixels for each vertex of a mesh: outlines then have corners about four pixels apart, which
/// shading and fur hide.
pub(crate) const PIXELS_PER_VERTEX: f32 = 16.0;

/// An inner ball shrinks by this share of the size of the mesh: the rounding of distances to
/// triangles, with room.
pub(crate) const INNER_ROUNDING: f64 = 1e-5;

/// Lengths that are divided by are at least this, so that axes and bends of no length give no NaN.
/// Squares of shorter ones vanish in single precision. Shaders write the number itself.
pub(crate) const LEAST_DIVISOR: f32 = 1e-30;

/// The most joints of a skeleton: vertices number theirs by 16 bits.
pub(crate) const MAX_JOINTS: usize = 1 << 16;

/// How far the length of a rotation may be from 1: files round them to 8 or 16 bits, and bounds do
/// not depend on it.
pub(crate) const UNIT_QUATERNION: f64 = 1e-2;

/// The error of a skinned vertex in single precision, relative to the greatest sum of magnitudes
/// that goes into a coordinate: shares are rounded once, blending takes four products and three
/// sums, extruding six operations, the matrix seven, and computing the bounds themselves ten. 33
/// units of 2^-24 cover these 28.
pub(crate) const SKINNING_ERROR: f32 = 2e-6;

/// The sun stands at least so high over the skin, as the cosine to its normal: bodies are round,
/// and a flat ray leaves their fur sooner than that of a plane.
pub(crate) const LEAST_RISE: f32 = 0.15;

/// Where pixels are wider than this share of the spacing of strands, strands begin to give way to
/// their mean; at the double they have done so: such pixels cannot show single strands.
pub const FINE: f32 = 0.6;

/// The width of a tuft, in cells: some tens of strands.
pub(crate) const TUFT: f32 = 9.0;

/// How far clumped and curled tips go aside, in tufts: strands must not cross, so that the farthest
/// change from place to place stays below 1.
pub(crate) const CLUMPED: f32 = 0.1;
pub(crate) const CURLED: f32 = 0.045;

/// By how many radians curls turn along the longest strands.
pub(crate) const TURNS: f32 = 16.0;
