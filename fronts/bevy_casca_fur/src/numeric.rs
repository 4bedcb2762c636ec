//! Limits, each with its reason.

/// The layers that meshes are made with. Each is a mesh of its own, so that there should be few;
/// neighbours differ by a half at most, which few pixels show.
pub(crate) const LADDER: [u32; 16] = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256];

/// The most vertices of all layers of a mesh: about 300 MB on the graphics processor. Larger meshes
/// get fewer layers.
pub(crate) const MOST_VERTICES: usize = 1 << 22;

/// The most triangles of all layers of a mesh, as many bytes as its vertices may have.
pub(crate) const MOST_TRIANGLES: usize = 1 << 24;

/// Frames for which meshes of layers that nobody uses are kept: a camera that turns around finds
/// them again.
pub(crate) const KEPT_FRAMES: u32 = 240;

/// A normal shorter than this has no direction: the rounding of unit normals in single precision.
pub(crate) const NO_NORMAL: f32 = 1e-6;
