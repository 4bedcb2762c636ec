//! Every margin and numeric limit of this crate, with its reason.

/// How far from (0, 0, 0, 1) the last row of a matrix may be, in each number: exporters round.
pub const AFFINE: f32 = 1e-5;
/// Rotations of other lengths are mistakes and not roundings.
pub(crate) const ROTATION_LENGTHS: std::ops::Range<f64> = 1e-3..1e3;

/// Boxes around what follows joints are larger by this share of their coordinates: renderers
/// multiply matrices in single precision.
pub(crate) const POSED: f32 = 1e-4;

/// Scenes from files count as no smaller than this, in metres: a point has a grid, too.
pub(crate) const LEAST_SIZE: f32 = 1e-3;
/// The grid reaches past a scene by this share of its size, so that nothing lies on its border.
pub(crate) const GRID_ROOM: f32 = 1e-3;
/// The same as a share of the greatest coordinate: far from the origin, cells that are smaller
/// could not be told apart.
pub(crate) const GRID_ROOM_FAR: f32 = 1e-5;

/// A scene from a file is moved to an origin of its own if it lies farther than this many times its
/// size from that of the file. From there on the room for far coordinates is wider than the one for
/// the size, so that distance costs precision that can be seen.
pub(crate) const FAR: f64 = (GRID_ROOM / GRID_ROOM_FAR) as f64;

/// The near plane of a walk that is made up, as a share of the longest side of the scene.
pub(crate) const NEAR_SHARE: f32 = 5e-3;
/// The nearest and the farthest of such planes, in metres: one has a place in f32, and nothing in a
/// room is cut off.
pub(crate) const NEAR_PLANES: [f32; 2] = [1e-6, 0.05];

/// Objects promise a speed that is greater than the one of their motion by this factor: the way
/// between two frames is rounded.
pub(crate) const SPEED_ROOM: f32 = 1.0001;
/// What is added to such a speed: the rounding of coordinates of some hundred metres, seen as
/// speed.
pub(crate) const SPEED_ROUNDING: f32 = 2e-3;
