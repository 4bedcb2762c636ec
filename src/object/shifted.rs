//! Shapes in the coordinates of another origin: bounds rounded outwards, occluders inwards.
//!
//! Boxes, spheres and turned boxes are stored in single precision: they round by the exact error of
//! their sums, and where those are single numbers, not at all. Convex solids and meshes keep
//! offsets in double precision.

use std::sync::Arc;

use glam::{Affine3A, DAffine3, DMat3};

use crate::error::Error;
use crate::geometry::block::{above, below};
use crate::geometry::offset::Offset;
use crate::geometry::placement::Placement;
use crate::geometry::{Aabb, Obb, Sphere};
use crate::mesh::Instance;
use crate::numeric::place::ONE_ROUNDING;
use crate::object::{Bounds, Occluder};
use crate::shape::Convex;

impl Bounds {
    /// The bounds in coordinates that differ by an offset. A mesh becomes an instance of it.
    ///
    /// # Errors
    /// Refuses instances whose coordinates would leave single precision.
    pub(crate) fn shifted(&self, offset: &Offset) -> Result<Self, Error> {
        Ok(match self {
            Self::Sphere(sphere) => {
                let (center, off) = offset.nearest(sphere.center);
                Sphere::new(center, grown(sphere.radius, off)).into()
            }
            Self::Box(b) => Aabb::new(offset.below(b.min), offset.above(b.max)).into(),
            Self::Oriented(b) => {
                let (center, off) = offset.nearest(b.center);
                let half = b.half.to_array().map(|half| grown(half, off));
                Obb { center, half: half.into(), ..*b }.into()
            }
            Self::Mesh(mesh) => Instance::carried(mesh.clone(), Affine3A::IDENTITY, offset)?.into(),
            Self::Instance(instance) => moved(instance, offset)?.into(),
        })
    }
}

impl Occluder {
    /// As [`Bounds::shifted`]; `None` if hardly anything of it is left.
    ///
    /// # Errors
    /// As [`Bounds::shifted`].
    pub(crate) fn shifted(&self, offset: &Offset) -> Result<Option<Self>, Error> {
        Ok(match self {
            Self::Sphere(sphere) => {
                let (center, off) = offset.nearest(sphere.center);
                let radius = shrunk(sphere.radius, off);
                (radius >= 0.0).then(|| Sphere::new(center, radius).into())
            }
            Self::Box(b) => {
                let inner = Aabb::new(offset.above(b.min), offset.below(b.max));
                inner.min.cmple(inner.max).all().then(|| inner.into())
            }
            Self::Oriented(b) => {
                let (center, off) = offset.nearest(b.center);
                let half = b.half.to_array().map(|half| shrunk(half, off));
                let inner = Obb { center, half: half.into(), ..**b };
                (inner.half.min_element() >= 0.0).then(|| inner.into())
            }
            Self::Convex(solid) => carried(solid, offset).map(|solid| Arc::new(solid).into()),
            Self::Mesh(mesh) => Some(Instance::carried(mesh.clone(), Affine3A::IDENTITY, offset)?.into()),
            Self::Instance(instance) => Some(moved(instance, offset)?.into()),
        })
    }
}

/// An instance in other coordinates. What its transform, in single precision, rounds is not lost.
fn moved(instance: &Instance, offset: &Offset) -> Result<Instance, Error> {
    let (transform, at) = (instance.transform(), instance.placement().affine.translation);
    // The difference of a number and its rounding is exact.
    let total = Offset::between(at - transform.translation.as_dvec3(), -offset.by);
    let rounding = ONE_ROUNDING * at.abs().max_element();
    let error = total.error + offset.error + instance.error() + rounding;
    Instance::carried(instance.mesh().clone(), transform, &Offset { error, ..total })
}

/// A length that is not less than the sum of two.
fn grown(length: f32, by: f64) -> f32 {
    if by == 0.0 { length } else { above((f64::from(length) + by).next_up()) }
}

/// A length that is not greater than the difference of two.
fn shrunk(length: f32, by: f64) -> f32 {
    if by == 0.0 { length } else { below((f64::from(length) - by).next_down()) }
}

/// A convex solid inside the one that an offset leads to.
fn carried(solid: &Convex, offset: &Offset) -> Option<Convex> {
    if let Some(moved) = offset.single().and_then(|by| solid.translated(by).ok()) {
        return Some(moved);
    }
    let (affine, error) =
        (DAffine3::from_translation(offset.by), offset.error + ONE_ROUNDING * offset.by.abs().max_element());
    let normals = Some(DMat3::IDENTITY);
    let (keeps_angles, mirrors) = (true, false);
    solid.placed(&Placement { affine, growth: 1.0, error, normals, keeps_angles, mirrors })
}
