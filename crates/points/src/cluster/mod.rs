//! Hidden point removal of clusters: one representative for the points of a cell.
//!
//! Tavares 2009, "Aproximação Eficiente de Visibilidade para Nuvem de Pontos utilizando a GPU", chapter 3. The thesis keeps the
//! radius that is best for all points; here [`Radius::Rescaled`] shrinks it with the distance between representatives.

mod cells;

use crate::hpr::{HprError, Kernel, visible_points};
use crate::numeric::DISTANCE_ERROR;
use bitvec::vec::BitVec;
use cells::Cells;
pub use cells::morton;
use glam::DVec3;

/// How points are cut into cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clustering {
    /// A regular grid over the bounding box, with this many cells along each axis; from 1 to 2^20.
    Grid {
        /// Cells along x, y and z.
        cells: [u32; 3],
    },
    /// An octree over the bounding box: cells of more points than this are cut into eight. At least 1.
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
    /// Divided by the number of points for each cluster, but at least the largest distance; gamma is multiplied. A point is
    /// hidden behind a gap of the angle `a` if it is more than about `R a^2 / 4` farther away, and for samples of a
    /// surface `a^2` grows with the number of points for each cluster.
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

/// The number of clusters: of cells or leaves that hold points.
///
/// # Errors
///
/// As [`visible_clusters`].
pub fn cluster_count(points: &[DVec3], clustering: Clustering) -> Result<usize, ClusterError> {
    check(points)?;
    Ok(Cells::new(points, clustering)?.iter().count())
}

fn check(points: &[DVec3]) -> Result<(), HprError> {
    match points.iter().position(|p| !p.is_finite()) {
        Some(index) => Err(HprError::PointNotFinite { index }),
        None => Ok(()),
    }
}

/// A bit for each point: whether it is visible from the eye, by the centroids of clusters.
///
/// Fast and rough: a cell at the silhouette is visible or hidden as a whole. Takes `O(n log n)` time and about 60 bytes a point for the
/// cells, empty ones cost nothing, and hidden point removal of the centroids.
///
/// # Errors
///
/// [`ClusterError`] names the parameter at fault.
pub fn visible_clusters(
    points: &[DVec3],
    eye: DVec3,
    kernel: Kernel,
    clustering: Clustering,
    radius: Radius,
    passes: Passes,
) -> Result<BitVec, ClusterError> {
    check(points)?;
    let cells = Cells::new(points, clustering)?;
    let centroids: Vec<DVec3> = cells.iter().map(|cell| centroid(points, cell)).collect();
    let kernel_of_cells = match radius {
        Radius::AsGiven => kernel,
        Radius::Rescaled => {
            rescaled(kernel, points.len() as f64 / centroids.len().max(1) as f64, &centroids, eye)
        }
    };
    let visible_cells = visible_points(&centroids, eye, kernel_of_cells)?;
    let mut chosen: Vec<u32> = Vec::new();
    for (cell, _) in cells.iter().zip(&visible_cells).filter(|(_, visible)| **visible) {
        chosen.extend(cell);
    }
    let mut visible = BitVec::repeat(false, points.len());
    match passes {
        Passes::One => chosen.iter().for_each(|&i| visible.set(i as usize, true)),
        Passes::Two => {
            let subset: Vec<DVec3> = chosen.iter().map(|&i| points[i as usize]).collect();
            let second = visible_points(&subset, eye, kernel)?;
            chosen.iter().zip(&second).for_each(|(&i, bit)| visible.set(i as usize, *bit));
        }
    }
    Ok(visible)
}

/// The mean of points. Each is divided first: the sum of huge ones could overflow.
fn centroid(points: &[DVec3], cell: &[u32]) -> DVec3 {
    cell.iter().map(|&i| points[i as usize] / cell.len() as f64).sum()
}

/// A kernel for points of which each stands for `share` of the points that a kernel is for.
fn rescaled(kernel: Kernel, share: f64, representatives: &[DVec3], eye: DVec3) -> Kernel {
    match kernel {
        Kernel::Relative { log10_radius } if log10_radius > 0.0 => {
            Kernel::Relative { log10_radius: (log10_radius - share.log10()).max(0.0) }
        }
        Kernel::Absolute { radius } => {
            let farthest = representatives.iter().fold(0.0, |most: f64, p| most.max(p.distance(eye)));
            // Given too small, it stays so, and is an error as with single points.
            let least = farthest * (1.0 + DISTANCE_ERROR);
            Kernel::Absolute { radius: (radius / share).max(least.min(radius)) }
        }
        Kernel::Exponential { gamma } => Kernel::Exponential { gamma: gamma * share },
        Kernel::Relative { .. } => kernel,
    }
}

#[cfg(test)]
mod tests;
