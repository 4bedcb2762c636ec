//! Meshes as shapes: touched cells from the triangles, opaque cells from slices
//! and parity (thesis, section 3.4.1).
//!
//! Cells that no triangle touches lie wholly inside or wholly outside a closed
//! mesh, and so do all cells reached from them without crossing the surface. Such
//! a component is opaque if the lines along x through the middles of *all*
//! its rows count an odd number of crossings: a wrong count on one line can
//! only make it transparent.
//!
//! Where triangles hide from their front only, the triangles must be wound alike, and the component
//! must have a positive winding number: then a ray from where it is zero passes a front.

use std::sync::Arc;

use glam::{DVec3, IVec3, Vec3};

use crate::error::Error;
use crate::geometry::Block;
use crate::geometry::plane::HalfSpace;
use crate::geometry::polytope::Part;
use crate::grid::Grid;
use crate::grid::run::CellRun;
use crate::heap::in_arc;
use crate::mesh::cells::SurfaceCells;
use crate::mesh::raster::margin;
use crate::mesh::tri_mesh::TriMesh;
use crate::mesh::triangle::{crossing, triangle_meets_box};
use crate::shape::Shape;
use crate::shape::kind::Kind;

impl TriMesh {
    /// The block of grid cells around the mesh, and its surface there.
    pub(crate) fn surface_cells(&self, grid: &Grid) -> Option<Arc<SurfaceCells>> {
        self.cells.get(grid, || SurfaceCells::new(self.all_corners(), grid, self.bounds()))
    }

    /// The greatest margin of its triangles.
    fn greatest_margin(&self) -> f64 {
        let (min, max) = self.bounds();
        margin(&[min, max, max])
    }

    /// Whether triangles may meet a box.
    pub(crate) fn surface_meets(&self, block: &Block) -> bool {
        let (min, max) = (block.min, block.max);
        self.index().any_in_box((min, max), self.greatest_margin(), |t| {
            let t = self.corners(t);
            triangle_meets_box(&t, (min, max), margin(&t))
        })
    }

    /// Where the line along `axis` through `point` crosses the mesh before that: how often, and the
    /// sum of the changes of the winding number.
    fn crossings_before(&self, axis: usize, point: DVec3) -> (u32, i32) {
        let (mut count, mut winding) = (0, 0);
        let (mut min, mut max) = (point, point);
        min[axis] = f64::NEG_INFINITY;
        max[axis] = point[axis];
        // Triangles that are left out would give no crossing, or one that comes later.
        self.index().any_in_box((min, max), self.greatest_margin(), |t| {
            if let Some((_, change)) = crossing(&self.corners(t), axis, point).filter(|c| c.0 < point[axis]) {
                (count, winding) = (count + 1, winding + change);
            }
            false
        });
        (count, winding)
    }

    /// Whether points beyond these crossings of a line are behind the mesh's triangles as seen
    /// from outside.
    fn is_behind(&self, (count, winding): (u32, i32)) -> bool {
        count % 2 == 1 && (winding > 0 || !self.surface.front)
    }
}

impl Shape for TriMesh {
    fn bounds(&self) -> (DVec3, DVec3) {
        (self.bounds.min.as_dvec3(), self.bounds.max.as_dvec3())
    }

    fn has_rows(&self) -> bool {
        false
    }

    fn touched_rows(&self, grid: &Grid, _: IVec3, _: IVec3, out: &mut dyn FnMut(CellRun)) {
        if let Some(cells) = self.surface_cells(grid) {
            cells.runs.iter().for_each(|&run| out(run));
        }
    }

    fn opaque_rows(&self, grid: &Grid, _: IVec3, _: IVec3, out: &mut dyn FnMut(CellRun)) {
        if !self.solid {
            return;
        }
        let Some(cells) = self.surface_cells(grid) else { return };
        let crossed = cells.crossings(self.all_corners(), grid, |t, point| crossing(t, 0, point));
        cells.inside(grid, &crossed, |count, winding| self.is_behind((count, winding)), out);
    }

    fn contains_box(&self, min: DVec3, max: DVec3) -> bool {
        let block = Block { min, max };
        if !self.solid || !Block::from(self.bounds).contains(&block) || self.surface_meets(&block) {
            return false;
        }
        let middle = (min + max) * 0.5;
        (0..3).all(|axis| self.is_behind(self.crossings_before(axis, middle)))
    }

    fn contains_point(&self, point: DVec3) -> bool {
        if !self.closed || !Block::from(self.bounds).contains_point(point) {
            return false;
        }
        (0..3).any(|axis| {
            let (count, winding) = self.crossings_before(axis, point);
            count % 2 == 1 || winding != 0 && self.surface.front
        })
    }
}

impl Kind for TriMesh {
    fn check_hides(&self) -> Result<(), Error> {
        if self.occludes() { Ok(()) } else { Err(Error::BoundsOnly) }
    }

    fn same(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }

    fn moved(&self, _: Vec3) -> Result<Option<Self>, Error> {
        Ok(None)
    }

    fn shared(&self, out: &mut dyn FnMut(*const u8, usize)) {
        out(std::ptr::from_ref(self).cast(), in_arc::<Self>() + self.memory_bytes());
    }

    fn is_solid(&self) -> bool {
        self.is_closed()
    }

    fn may_meet(&self, _: &[HalfSpace], around: &Block) -> bool {
        self.surface_meets(around)
    }

    fn middle_of_parts(&self) -> Option<DVec3> {
        Some(self.middle())
    }

    fn all_parts(&self, origin: DVec3, test: &mut dyn FnMut(&Part) -> bool) -> Option<bool> {
        Some(self.parts().iter().all(|part| test(&part.part(origin))))
    }
}
