//! Points sorted by the cells of a regular grid or of an octree.

use super::options::{ClusterError, Clustering};
use crate::morton::morton;
use glam::DVec3;

/// The largest number of cells along an axis: three such numbers fit into 63 bits. An octree of
/// this size has 20 levels.
const MOST: u32 = 1 << LEVELS;

/// The levels of an octree. Points in one of its smallest cells, as all equal ones, share a leaf.
const LEVELS: u32 = 20;

/// The points of each cell that is not empty.
pub(super) struct Cells {
    indices: Vec<u32>,
    /// Where each cell ends.
    ends: Vec<usize>,
}

impl Cells {
    /// Sorts finite points, fewer than 2^32.
    pub fn new(points: &[DVec3], clustering: Clustering) -> Result<Self, ClusterError> {
        let sizes = match clustering {
            Clustering::Grid { cells } if cells.iter().any(|n| !(1..=MOST).contains(n)) => {
                return Err(ClusterError::Cells { cells });
            }
            Clustering::Octree { max_points: 0 } => return Err(ClusterError::NoPoints),
            Clustering::Grid { cells } => cells,
            Clustering::Octree { .. } => [MOST; 3],
        };
        let low = points.iter().copied().reduce(DVec3::min).unwrap_or(DVec3::ZERO);
        let high = points.iter().copied().reduce(DVec3::max).unwrap_or(DVec3::ZERO);
        let key = |p: DVec3| {
            let at = [0, 1, 2].map(|axis| {
                // Halves, as the difference of huge coordinates overflows. Equal ones give NaN,
                // which is cell 0.
                let part = (p[axis] / 2.0 - low[axis] / 2.0) / (high[axis] / 2.0 - low[axis] / 2.0);
                ((part * f64::from(sizes[axis])) as u32).min(sizes[axis] - 1)
            });
            match clustering {
                Clustering::Grid { .. } => at.into_iter().fold(0, |key, x| key << LEVELS | u64::from(x)),
                Clustering::Octree { .. } => morton(at),
            }
        };
        let mut keyed: Vec<(u64, u32)> = points.iter().zip(0..).map(|(&p, i)| (key(p), i)).collect();
        keyed.sort_unstable();
        let keys: Vec<u64> = keyed.iter().map(|&(key, _)| key).collect();
        let mut ends = Vec::new();
        match clustering {
            Clustering::Grid { .. } => grid(&keys, &mut ends),
            Clustering::Octree { max_points } => octree(&keys, 0, LEVELS, max_points as usize, &mut ends),
        }
        Ok(Self { indices: keyed.into_iter().map(|(_, i)| i).collect(), ends })
    }

    /// The indices of each cell's points.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.indices[start..end])
    }
}

/// Cells of equal keys.
fn grid(keys: &[u64], ends: &mut Vec<usize>) {
    let mut end = 0;
    for run in keys.chunk_by(|a, b| a == b) {
        end += run.len();
        ends.push(end);
    }
}

/// Leaves of a node, whose keys begin at `start` of all keys and are equal above its `level`.
fn octree(keys: &[u64], start: usize, level: u32, max_points: usize, ends: &mut Vec<usize>) {
    if keys.len() <= max_points || level == 0 {
        if !keys.is_empty() {
            ends.push(start + keys.len());
        }
        return;
    }
    let mut from = start;
    for child in keys.chunk_by(|a, b| a >> (3 * (level - 1)) == b >> (3 * (level - 1))) {
        octree(child, from, level - 1, max_points, ends);
        from += child.len();
    }
}
