//! Hidden point removal of clusters: one representative for the points of a cell.
//!
//! Tavares 2009, "Aproximação Eficiente de Visibilidade para Nuvem de Pontos utilizando a GPU",
//! chapter 3. The thesis keeps the radius that is best for all points; here [`Radius::Rescaled`]
//! shrinks it with the distance between representatives.

mod cells;
mod options;

use crate::hpr::{HprError, Kernel, visible_points};
use crate::numeric::DISTANCE_ERROR;
use bitvec::vec::BitVec;
use cells::Cells;
use glam::DVec3;
pub use options::{ClusterError, Clustering, Passes, Radius};

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
/// Fast and rough: a cell at the silhouette is visible or hidden as a whole. Takes `O(n log n)`
/// time and about 60 bytes a point for the cells, empty ones cost nothing, and hidden point removal
/// of the centroids.
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
            let share = points.len().max(1) as f64 / centroids.len().max(1) as f64;
            rescaled(kernel, share, &centroids, eye)
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
