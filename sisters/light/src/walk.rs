//! Rays: the surface that one hits first, and the entry of that surface there.

use glam::DVec3;

use crate::lattice::Cell;
use crate::voxels::{NONE, Reference, Voxels};

/// Where a ray meets a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hit {
    /// The distance from the start, in cells.
    pub(crate) distance: f64,
    /// The triangle.
    pub(crate) surface: u32,
}

impl Voxels {
    /// The first surface within a reach along a unit direction.
    pub(crate) fn first(&self, from: DVec3, direction: DVec3, reach: f64) -> Option<Hit> {
        self.tree.first(from, direction, reach).map(|(distance, surface)| Hit { distance, surface })
    }

    /// Whether the segment between two points meets no surface.
    pub(crate) fn free(&self, from: DVec3, to: DVec3) -> bool {
        self.free_of(from, to, &mut NONE.clone())
    }

    /// The same for many segments of one point: what blocked the last one is tried first.
    pub(crate) fn free_of(&self, from: DVec3, to: DVec3, last: &mut u32) -> bool {
        let way = to - from;
        let Some(direction) = way.try_normalize() else { return true };
        let blocker = self.tree.blocker(from, direction, way.length(), *last);
        *last = blocker.unwrap_or(*last);
        blocker.is_none()
    }

    /// The entry of a triangle at a point on it: that of the point's cell, or of a cell next to the
    /// point. Rounding may put a point into a cell in which hardly anything of the triangle is.
    pub(crate) fn entry_at(&self, surface: u32, point: DVec3) -> Option<u32> {
        let of = |c: Cell| {
            let is_it = |r: &&Reference| r.surface == surface && r.entry != NONE;
            self.references_of(c).iter().find(is_it).map(|r| r.entry)
        };
        let near = || self.lattice.all_at(point).flat_map(|at| self.lattice.around(at));
        of(self.lattice.at(point)).or_else(|| near().find_map(of))
    }
}
