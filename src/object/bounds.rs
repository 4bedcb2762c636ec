//! Bounds: the shapes that are tested for visibility.

use std::sync::Arc;

use glam::Vec3;

use crate::error::Error;
use crate::geometry::{Aabb, Block, Obb, Sphere};
use crate::mesh::{Instance, TriMesh};
use crate::object::kinds::kinds;
use crate::shape::kind::Kind;

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
    /// A box around the bounds in world units, rounded outwards: the one that is compared with
    /// cells and occlusion buffers first. Infinite where it ends beyond the range of single
    /// precision. Costs a few operations.
    ///
    /// The box of an [`Instance`] is that of the convex parts that it is tested by, which may be
    /// larger than its vertices need: see [`Instance::aabb`].
    ///
    /// ```
    /// use casca::{Aabb, Bounds, Sphere};
    /// use glam::Vec3;
    ///
    /// let ball = Bounds::from(Sphere::new(Vec3::ONE, 0.1));
    /// assert!(ball.aabb().contains(Vec3::new(1.1, 1.0, 1.0)));
    /// let level = Aabb::new(Vec3::ZERO, Vec3::splat(0.7));
    /// assert_eq!(Bounds::from(level).aabb(), level);
    /// ```
    pub fn aabb(&self) -> Aabb {
        self.block().to_aabb()
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        self.kind().check("the bounds")
    }
}
