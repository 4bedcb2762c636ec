//! Bounds: the shapes that are tested for visibility.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::error::Error;
use crate::geometry::{Aabb, Block, Obb, Sphere};
use crate::grid::Grid;
use crate::grid::run::CellRun;
use crate::mesh::{Instance, TriMesh};
use crate::object::kinds::kinds;
use crate::shape::Shape;
use crate::shape::kind::Kind;
use crate::shape::pieces::Parts;
use crate::shape::traits::Rows;

/// The shape that is tested for visibility: the object's whole geometry must lie inside.
#[derive(Debug, Clone)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Bounds {
    /// A sphere.
    Sphere(Sphere),
    /// An axis-aligned box.
    Box(Aabb),
    /// A box turned by a rotation.
    Oriented(Obb),
    /// The triangles themselves, in world space. Their bounding box is tested
    /// against the frustum; only cells that triangles touch contain the object.
    #[cfg_attr(feature = "serde", serde(skip))]
    Mesh(Arc<TriMesh>),
    /// A mesh under a transform.
    #[cfg_attr(feature = "serde", serde(skip))]
    Instance(Instance),
}

kinds!(Bounds: Sphere(Sphere), Box(Aabb), Oriented(Obb), Mesh(Arc<TriMesh>), Instance(Instance));

impl Bounds {
    pub(crate) fn check(&self) -> Result<(), Error> {
        self.kind().check("the bounds")
    }
}
