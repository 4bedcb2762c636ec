//! The parameters of clusters, and their errors.

use crate::hpr::HprError;

/// How points are cut into cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clustering {
    /// A regular grid over the bounding box, with this many cells along each axis; from 1 to 2^20.
    Grid {
        /// Cells along x, y and z.
        cells: [u32; 3],
    },
    /// An octree over the bounding box: cells of more points than this are cut into eight. At
    /// least 1.
    Octree {
        /// The largest number of points of a leaf.
        max_points: u32,
    },
}

/// The radius of the kernel for representatives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Radius {
    /// That of the points, as in the thesis: with few clusters it makes nearly all of them visible.
    AsGiven,
    /// Divides the radius by the number of points per cluster, but not below the largest distance,
    /// and multiplies gamma by it. A point is hidden behind a gap of the angle `a` if it is more
    /// than about `R a^2 / 4` farther away, and for samples of a surface `a^2` grows with the
    /// number of points for each cluster.
    Rescaled,
}

/// The points that get an answer of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Passes {
    /// All points of a cell have the answer of their representative.
    One,
    /// A second removal, with the given kernel, among the points of visible cells.
    Two,
}

/// Why clusters have no answer.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClusterError {
    /// A number of cells that is 0 or above 2^20.
    #[error("a grid of {cells:?} cells: each number must be from 1 to 2^20")]
    Cells {
        /// The given numbers.
        cells: [u32; 3],
    },
    /// Leaves of no points.
    #[error("max_points is 0, and must be at least 1")]
    NoPoints,
    /// The points, the eye or the kernel.
    #[error(transparent)]
    Hpr(#[from] HprError),
}
