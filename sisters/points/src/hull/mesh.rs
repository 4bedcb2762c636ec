//! Triangles of a growing hull, and their neighbours.

use crate::numeric::{PLANE_ERROR, above};
use glam::DVec3;

/// No point, or no face.
pub(super) const NONE: u32 = u32::MAX;

/// A triangle of the hull, counterclockwise as seen from outside.
#[derive(Debug, Clone)]
pub(super) struct Face {
    normal: DVec3,
    offset: f64,
    error: f64,
    /// The height of `far` above the plane.
    pub far_height: f64,
    /// Its corners.
    pub corners: [u32; 3],
    /// The faces across the edges from corner `i` to the next one.
    pub neighbours: [u32; 3],
    /// The first of a list of points above this face; [`NONE`] if there is none.
    pub first: u32,
    /// The point of the list that is farthest from the plane.
    pub far: u32,
    /// The last step at which a point was found to be above (even) or not above (odd) this face;
    /// [`NONE`] for a removed face.
    pub mark: u32,
}

impl Face {
    pub fn new(points: &[DVec3], corners: [u32; 3]) -> Self {
        let [a, b, c] = corners.map(|i| points[i as usize]);
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac);
        let error = PLANE_ERROR * ab.abs().max_element() * ac.abs().max_element();
        let offset = normal.dot(a);
        let (neighbours, first, far, mark) = ([NONE; 3], NONE, NONE, 0);
        Self { normal, offset, error, far_height: 0.0, corners, neighbours, first, far, mark }
    }

    /// Positive if a point is strictly above the plane, zero on it, negative below; the sign is
    /// exact.
    #[inline]
    pub fn height(&self, points: &[DVec3], p: DVec3) -> f64 {
        let height = self.normal.dot(p) - self.offset;
        if height.abs() > self.error {
            return height;
        }
        let [a, b, c] = self.corners.map(|i| points[i as usize]);
        above(a, b, c, p)
    }

    /// The edge across which the neighbour is `face`.
    pub fn edge_to(&self, face: u32) -> usize {
        self.neighbours.iter().position(|&n| n == face).unwrap_or(0)
    }
}
