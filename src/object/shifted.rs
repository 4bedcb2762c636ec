//! Shapes in coordinates that are less by an offset: bounds rounded outwards, occluders inwards.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::error::Error;
use crate::geometry::block::{above, below};
use crate::geometry::{Aabb, Block, Obb, Sphere};
use crate::object::{Bounds, Occluder};

/// A point in other coordinates, and how far rounding moved it along all axes together.
fn shifted(point: Vec3, offset: DVec3) -> (Vec3, f64) {
    let exact = point.as_dvec3() - offset;
    let rounded = exact.as_vec3();
    (rounded, (rounded.as_dvec3() - exact).abs().element_sum())
}

impl Bounds {
    /// The bounds, for an object that is not placed by a transform; `None` for a mesh in world
    /// space, which stays where it is.
    ///
    /// # Errors
    /// As [`Instance::new`](crate::Instance::new).
    pub(crate) fn shifted(&self, offset: Vec3) -> Result<Option<Self>, Error> {
        let by = offset.as_dvec3();
        Ok(Some(match self {
            Self::Sphere(sphere) => {
                let (center, off) = shifted(sphere.center, by);
                Sphere::new(center, above(f64::from(sphere.radius) + off)).into()
            }
            Self::Box(b) => {
                let block = Block::from(*b);
                Block { min: block.min - by, max: block.max - by }.to_aabb().into()
            }
            Self::Oriented(b) => {
                let (center, off) = shifted(b.center, by);
                let half = b.half.as_dvec3().to_array().map(|half| above(half + off));
                Obb { center, half: half.into(), ..*b }.into()
            }
            Self::Mesh(_) => return Ok(None),
            Self::Instance(instance) => instance.translated(-offset)?.into(),
        }))
    }
}

impl Occluder {
    /// As [`Bounds::shifted`]; inside, `None` if rounding leaves nothing of it.
    ///
    /// # Errors
    /// As [`Instance::new`](crate::Instance::new) and
    /// [`Convex::translated`](crate::Convex::translated).
    pub(crate) fn shifted(&self, offset: Vec3) -> Result<Option<Option<Self>>, Error> {
        let by = offset.as_dvec3();
        Ok(Some(match self {
            Self::Sphere(sphere) => {
                let (center, off) = shifted(sphere.center, by);
                let radius = f64::from(sphere.radius) - off;
                (radius >= 0.0).then(|| Sphere::new(center, below(radius)).into())
            }
            Self::Box(b) => {
                let block = Block::from(*b);
                let (min, max) = (block.min - by, block.max - by);
                let inner = Aabb::new(min.to_array().map(above).into(), max.to_array().map(below).into());
                inner.min.cmple(inner.max).all().then(|| inner.into())
            }
            Self::Oriented(b) => {
                let (center, off) = shifted(b.center, by);
                let half = b.half.as_dvec3() - off;
                let inner = Obb { center, half: half.to_array().map(below).into(), ..*b };
                (half.min_element() >= 0.0).then(|| inner.into())
            }
            Self::Convex(solid) => Some(Arc::new(solid.translated(-offset)?).into()),
            Self::Mesh(_) => return Ok(None),
            Self::Instance(instance) => Some(instance.translated(-offset)?.into()),
        }))
    }
}
