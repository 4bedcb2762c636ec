//! Occluders: the shapes that hide others.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::error::Error;
use crate::geometry::placement::Placement;
use crate::geometry::polytope::Part;
use crate::geometry::{Aabb, Block, Obb, Sphere};
use crate::grid::Grid;
use crate::mesh::cells::CachedCells;
use crate::mesh::inner::Inner;
use crate::mesh::surface::Surface;
use crate::mesh::{Instance, TriMesh};
use crate::object::kinds::kinds;
use crate::shape::Convex;
use crate::shape::kind::Kind;

/// The part of an object that hides others: it must lie inside the object's
/// solid geometry.
#[derive(Debug, Clone)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Occluder {
    /// A solid sphere.
    Sphere(Sphere),
    /// A solid axis-aligned box.
    Box(Aabb),
    /// A solid box turned by a rotation. Apart, so that objects without one are small.
    Oriented(Box<Obb>),
    /// A solid convex polytope in world space.
    #[cfg_attr(feature = "serde", serde(with = "crate::shape::convex::stored"))]
    Convex(Arc<Convex>),
    /// The triangles of a mesh in world space, and the inside of a closed one.
    #[cfg_attr(feature = "serde", serde(skip))]
    Mesh(Arc<TriMesh>),
    /// The triangles of a mesh under a transform.
    #[cfg_attr(feature = "serde", serde(skip))]
    Instance(Instance),
}

kinds!(
    Occluder:
    Sphere(Sphere),
    Box(Aabb),
    Oriented(Box<Obb>),
    Convex(Arc<Convex>),
    Mesh(Arc<TriMesh>),
    Instance(Instance),
);

impl From<Obb> for Occluder {
    fn from(shape: Obb) -> Self {
        Self::Oriented(Box::new(shape))
    }
}

impl Occluder {
    /// Whether it has an inside that points can lie in.
    pub(crate) fn is_solid(&self) -> bool {
        self.kind().is_solid()
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        self.kind().check("the occluder")?;
        self.kind().check_hides()
    }

    /// While the result lives, the cells of a mesh in a grid are found once, and then known: for
    /// the bounds too, if those are the same mesh.
    pub(crate) fn cache_cells(&self, grid: &Grid) -> Option<Arc<CachedCells>> {
        match self {
            Self::Mesh(m) => Some(m.cache_cells(grid)),
            _ => None,
        }
    }

    /// The surface that is drawn of it, if it is made of triangles.
    pub(crate) fn surface(&self) -> Option<&Surface> {
        match self {
            Self::Mesh(m) => Some(m.surface()),
            Self::Instance(i) => Some(i.mesh().surface()),
            _ => None,
        }
    }

    /// A solid inside a convex mesh and hardly smaller, to be drawn in place of its triangles,
    /// relative to an origin that is known exactly; with a distance by which the mesh reaches
    /// beyond the solid's faces at most. Seen from farther outside than that, it hides nothing that
    /// the triangles do not.
    pub(crate) fn convex_mesh(&self, origin: DVec3) -> Option<(Part<'_>, f64)> {
        match self {
            Self::Mesh(m) => m.convex().map(|convex| (convex.part(origin), convex.lost)),
            Self::Instance(i) => i.convex_from(origin),
            _ => None,
        }
    }

    /// The convex solid inside a closed mesh.
    pub(crate) fn inner(&self) -> Option<&Inner> {
        match self {
            Self::Mesh(m) => m.inner(),
            Self::Instance(i) => i.mesh().inner(),
            _ => None,
        }
    }

    /// That solid relative to an origin that is known exactly. It may be drawn in place of the
    /// triangles if rays start outside of the box around the mesh.
    pub(crate) fn inner_from(&self, origin: DVec3) -> Option<Part<'_>> {
        match self {
            Self::Mesh(m) => m.inner().map(|inner| inner.solid.part(origin)),
            Self::Instance(i) => i.inner_from(origin),
            _ => None,
        }
    }

    /// The share of a mesh that is not of convex pieces open on one side, if there are such pieces.
    pub(crate) fn beside_shells(&self) -> Option<f64> {
        let shells = match self {
            Self::Mesh(m) => m.shells(),
            Self::Instance(i) => i.mesh().shells(),
            _ => return None,
        };
        (!shells.solids.is_empty()).then_some(shells.gap)
    }

    /// Solids inside convex pieces of a mesh that are open on one side, relative to an origin that
    /// is known exactly; with distances by which the pieces reach beyond their faces at most. Each
    /// line through such a solid meets the triangles of its piece.
    pub(crate) fn shells(&self, origin: DVec3, found: &mut dyn FnMut(&Part, f64)) {
        match self {
            Self::Mesh(m) => {
                m.shells().solids.iter().for_each(|shell| found(&shell.part(origin), shell.lost))
            }
            Self::Instance(i) => i.shells_from(origin).for_each(|(part, beyond)| found(&part, beyond)),
            _ => {}
        }
    }

    /// The transform of its triangles, if they are not in world space.
    pub(crate) fn placement(&self) -> Option<&Placement> {
        match self {
            Self::Instance(i) => Some(i.placement()),
            _ => None,
        }
    }
}
