//! The triangles of objects, in cells.

use glam::{DVec3, IVec3};

use crate::clip::{Polygon, inside};
use crate::input::{Object, Triangle};
use crate::lattice::Lattice;
use crate::numeric::{FARTHEST, LEAST_AREA, SEAL};

/// A triangle in cells.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Surface {
    pub(crate) corners: [DVec3; 3],
    /// Unit normal of the front.
    pub(crate) normal: DVec3,
    pub(crate) area: f64,
    pub(crate) material: u32,
    pub(crate) object: u32,
}

impl Surface {
    pub(crate) fn new(corners: [DVec3; 3], material: u32, object: u32) -> Option<Self> {
        let [a, b, c] = corners;
        let cross = (b - a).cross(c - a);
        let area = 0.5 * cross.length();
        let normal = cross.try_normalize().filter(|_| area > LEAST_AREA && area.is_finite())?;
        Some(Self { corners, normal, area, material, object })
    }

    /// Whether it is the same triangle.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let kind = |s: &Self| (s.material, s.object);
        self.corners == other.corners && kind(self) == kind(other)
    }

    /// How far barycentric coordinates on it may be below 0: [`SEAL`] beyond its edges.
    pub(crate) fn slack(&self) -> [f64; 3] {
        let [a, b, c] = self.corners;
        // A height on an edge is twice the area over its length.
        [b.distance(c), c.distance(a), a.distance(b)].map(|edge| SEAL * edge / (2.0 * self.area))
    }

    pub(crate) fn polygon(&self) -> Polygon {
        self.corners.into_iter().collect()
    }

    /// The polygon in cells of which so many are along an edge of one of the grid.
    pub(crate) fn scaled(&self, fine: f64) -> Polygon {
        self.corners.into_iter().map(|p| p * fine).collect()
    }
}

/// Triangles that were left out, or not taken whole.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Skipped {
    /// Corners that are not finite.
    pub not_finite: usize,
    /// A corner more than 2^30 cells away, where single precision places no plane.
    pub far: usize,
    /// No area.
    pub degenerate: usize,
    /// Wholly outside of the grid.
    pub outside: usize,
    /// Not left out: only the part inside of the grid counts.
    pub cut: usize,
}

/// The triangles of objects that can be lit.
pub(crate) fn surfaces(objects: &[Object], lattice: &Lattice, skipped: &mut Skipped) -> Vec<Surface> {
    let mut all = Vec::new();
    for (object, o) in objects.iter().enumerate() {
        all.extend(o.triangles.iter().filter_map(|t| surface(t, object as u32, lattice, skipped)));
    }
    all
}

fn surface(t: &Triangle, object: u32, lattice: &Lattice, skipped: &mut Skipped) -> Option<Surface> {
    if !t.corners.iter().all(|p| p.is_finite()) {
        skipped.not_finite += 1;
        return None;
    }
    let corners = t.corners.map(|p| lattice.cells(p));
    if corners.iter().any(|p| p.abs().max_element() > FARTHEST) {
        skipped.far += 1;
        return None;
    }
    let Some(surface) = Surface::new(corners, t.material, object) else {
        skipped.degenerate += 1;
        return None;
    };
    let high = lattice.dims.as_dvec3();
    let is_in = |p: &DVec3| p.cmpge(DVec3::ZERO).all() && p.cmple(high).all();
    if !corners.iter().all(is_in) {
        if inside(&surface.polygon(), IVec3::ZERO, lattice.dims, 0.0).is_empty() {
            skipped.outside += 1;
            return None;
        }
        skipped.cut += 1;
    }
    Some(surface)
}
