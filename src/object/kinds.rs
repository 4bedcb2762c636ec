//! The kinds of bounds and occluders.

use std::sync::Arc;

use glam::DVec3;

use crate::error::Error;
use crate::geometry::placement::Placement;
use crate::geometry::{Aabb, Block, Obb, Sphere};
use crate::grid::Grid;
use crate::grid::run::CellRun;
use crate::mesh::cells::Held;
use crate::mesh::surface::Surface;
use crate::mesh::{Instance, TriMesh};
use crate::shape::{Convex, Shape};

/// What is tested for visibility: it must hold the object's whole geometry.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Bounds {
    /// A sphere.
    Sphere(Sphere),
    /// An axis-aligned box.
    Box(Aabb),
    /// A box turned by a rotation.
    Oriented(Obb),
    /// The triangles themselves, in world space. Their bounding box is tested
    /// against the frustum; only cells that triangles touch hold the object.
    Mesh(Arc<TriMesh>),
    /// A mesh under a transform.
    Instance(Instance),
}

/// The part of an object that hides others: it must lie inside the object's
/// solid geometry.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Occluder {
    /// A solid sphere.
    Sphere(Sphere),
    /// A solid axis-aligned box.
    Box(Aabb),
    /// A solid box turned by a rotation.
    Oriented(Obb),
    /// A solid convex polytope in world space.
    Convex(Arc<Convex>),
    /// The triangles of a mesh in world space, and the inside of a closed one.
    Mesh(Arc<TriMesh>),
    /// The triangles of a mesh under a transform.
    Instance(Instance),
}

macro_rules! shapes {
    ($name:ident, $what:literal, $check_mesh:expr, $($convex:ident)?) => {
        impl $name {
            fn shape(&self) -> &dyn Shape {
                match self {
                    Self::Sphere(s) => s,
                    Self::Box(b) => b,
                    Self::Oriented(b) => b,
                    $(Self::$convex(c) => &**c,)?
                    Self::Mesh(m) => &**m,
                    Self::Instance(i) => i,
                }
            }

            pub(crate) fn check(&self) -> Result<(), Error> {
                match self {
                    Self::Sphere(s) => s.check($what),
                    Self::Box(b) => b.check($what),
                    Self::Oriented(b) => b.check($what),
                    $(Self::$convex(_) => Ok(()),)?
                    Self::Mesh(m) => $check_mesh(m),
                    Self::Instance(i) => $check_mesh(i.mesh()),
                }
            }

            /// Whether both are the same shape at the same place.
            pub(crate) fn same(&self, other: &Self) -> bool {
                match (self, other) {
                    (Self::Sphere(a), Self::Sphere(b)) => a == b,
                    (Self::Box(a), Self::Box(b)) => a == b,
                    (Self::Oriented(a), Self::Oriented(b)) => a == b,
                    $((Self::$convex(a), Self::$convex(b)) => Arc::ptr_eq(a, b),)?
                    (Self::Mesh(a), Self::Mesh(b)) => Arc::ptr_eq(a, b),
                    (Self::Instance(a), Self::Instance(b)) => a == b,
                    _ => false,
                }
            }

            /// What other objects may share of it: its place in memory, and its bytes.
            pub(crate) fn shared(&self) -> Option<(*const u8, usize)> {
                let mesh = |m: &Arc<TriMesh>| (Arc::as_ptr(m).cast::<u8>(), m.memory_bytes());
                match self {
                    Self::Sphere(_) | Self::Box(_) | Self::Oriented(_) => None,
                    $(Self::$convex(c) => Some((Arc::as_ptr(c).cast::<u8>(), c.memory_bytes())),)?
                    Self::Mesh(m) => Some(mesh(m)),
                    Self::Instance(i) => Some(mesh(i.mesh())),
                }
            }

            /// A box that holds the shape.
            pub(crate) fn block(&self) -> Block {
                Block::new(self.shape().bounds())
            }
        }

        impl Shape for $name {
            fn bounds(&self) -> (DVec3, DVec3) {
                self.shape().bounds()
            }

            fn touched(&self, grid: &Grid, out: &mut dyn FnMut(CellRun)) {
                self.shape().touched(grid, out)
            }

            fn opaque(&self, grid: &Grid, out: &mut dyn FnMut(CellRun)) {
                self.shape().opaque(grid, out)
            }

            fn contains_box(&self, min: DVec3, max: DVec3) -> bool {
                self.shape().contains_box(min, max)
            }

            fn contains_point(&self, point: DVec3) -> bool {
                self.shape().contains_point(point)
            }
        }

        impl From<Sphere> for $name {
            fn from(s: Sphere) -> Self {
                Self::Sphere(s)
            }
        }

        impl From<Aabb> for $name {
            fn from(b: Aabb) -> Self {
                Self::Box(b)
            }
        }

        impl From<Obb> for $name {
            fn from(b: Obb) -> Self {
                Self::Oriented(b)
            }
        }

        impl From<Instance> for $name {
            fn from(i: Instance) -> Self {
                Self::Instance(i)
            }
        }

        impl From<Arc<TriMesh>> for $name {
            fn from(m: Arc<TriMesh>) -> Self {
                Self::Mesh(m)
            }
        }
    };
}

shapes!(Bounds, "the bounds", |_: &TriMesh| Ok(()),);
shapes!(Occluder, "the occluder", check_hides, Convex);

/// Refuses a mesh that was not prepared to hide anything.
fn check_hides(mesh: &TriMesh) -> Result<(), Error> {
    if mesh.occludes() { Ok(()) } else { Err(Error::BoundsOnly) }
}

impl From<Arc<Convex>> for Occluder {
    fn from(c: Arc<Convex>) -> Self {
        Self::Convex(c)
    }
}

impl Occluder {
    /// Whether it has an inside that points can lie in.
    pub(crate) fn is_solid(&self) -> bool {
        match self {
            Self::Mesh(m) => m.is_closed(),
            Self::Instance(_) => false,
            _ => true,
        }
    }

    /// While the result lives, the cells of a mesh in a grid are found once, and then known: for the bounds too, if
    /// those are the same mesh.
    pub(crate) fn hold_cells(&self, grid: &Grid) -> Option<Arc<Held>> {
        match self {
            Self::Mesh(m) => Some(m.hold_cells(grid)),
            _ => None,
        }
    }

    /// What is drawn of it, if it is made of triangles.
    pub(crate) fn surface(&self) -> Option<&Surface> {
        match self {
            Self::Mesh(m) => Some(m.surface()),
            Self::Instance(i) => Some(i.mesh().surface()),
            _ => None,
        }
    }

    /// Where what is drawn of it lies, if that is not where its triangles are.
    pub(crate) fn placement(&self) -> Option<&Placement> {
        match self {
            Self::Instance(i) => Some(i.placement()),
            _ => None,
        }
    }
}

/// Whether the union of solids wholly contains a block; in doubt, no.
///
/// Boxes are cut off exactly, so walls of abutting boxes are solid across their
/// seams; what remains must lie inside one of the other solids.
pub(crate) fn union_contains(block: &Block, solids: &[&Occluder]) -> bool {
    fn covered(block: &Block, solids: &[&Occluder], budget: &mut u32) -> bool {
        if solids.iter().any(|s| s.contains_box(block.min, block.max)) {
            return true;
        }
        if *budget == 0 {
            return false;
        }
        *budget -= 1;
        let cutter = solids.iter().find_map(|s| match s {
            Occluder::Box(b) => Some(Block::from(*b)).filter(|b| b.overlaps(block)),
            _ => None,
        });
        let Some(cut) = cutter else { return false };
        // Slabs of the block outside the box, axis by axis; what is left lies inside it.
        let mut rest = *block;
        for axis in 0..3 {
            if rest.min[axis] < cut.min[axis] {
                let mut slab = rest;
                slab.max[axis] = cut.min[axis];
                rest.min[axis] = cut.min[axis];
                if !covered(&slab, solids, budget) {
                    return false;
                }
            }
            if rest.max[axis] > cut.max[axis] {
                let mut slab = rest;
                slab.min[axis] = cut.max[axis];
                rest.max[axis] = cut.max[axis];
                if !covered(&slab, solids, budget) {
                    return false;
                }
            }
        }
        true
    }
    covered(block, solids, &mut 64)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn abutting_boxes_are_solid_across_their_seam() {
        let a = Occluder::from(Aabb::new(Vec3::ZERO, Vec3::new(0.37, 2.0, 2.0)));
        let b = Occluder::from(Aabb::new(Vec3::new(0.37, 0.0, 0.0), Vec3::splat(2.0)));
        let gap = Occluder::from(Aabb::new(Vec3::new(0.3701, 0.0, 0.0), Vec3::splat(2.0)));
        let block = Block { min: DVec3::splat(0.1), max: DVec3::splat(1.0) };
        assert!(!union_contains(&block, &[&a]));
        assert!(union_contains(&block, &[&a, &b]));
        assert!(!union_contains(&block, &[&a, &gap]));
        let ball = Occluder::from(Sphere::new(Vec3::splat(0.5), 0.9));
        assert!(union_contains(&block, &[&a, &gap, &ball]));
        let thin = Block { min: DVec3::splat(0.1), max: DVec3::new(1.9, 0.2, 0.2) };
        let low = Occluder::from(Sphere::new(Vec3::new(1.2, 0.1, 0.1), 0.9));
        assert!(union_contains(&thin, &[&a, &low]));
    }
}
