//! Shapes in coordinates that are less by an offset: bounds rounded outwards, occluders inwards.

use std::sync::Arc;

use glam::Vec3;

use crate::error::Error;
use crate::geometry::offset::Offset;
use crate::object::{Bounds, Occluder};

impl Bounds {
    /// The bounds, for an object that is not placed by a transform; `None` for a mesh in world
    /// space, which stays where it is.
    ///
    /// # Errors
    /// As [`Instance::new`](crate::Instance::new).
    pub(crate) fn shifted(&self, offset: Vec3) -> Result<Option<Self>, Error> {
        match self {
            Self::Mesh(_) => Ok(None),
            Self::Instance(instance) => Ok(Some(instance.translated(-offset)?.into())),
            _ => self.anchored(None, &Offset::exact(-offset.as_dvec3())).map(Some),
        }
    }
}

impl Occluder {
    /// As [`Bounds::shifted`]; inside, `None` if rounding leaves nothing of it.
    ///
    /// # Errors
    /// As [`Instance::new`](crate::Instance::new) and
    /// [`Convex::translated`](crate::Convex::translated).
    pub(crate) fn shifted(&self, offset: Vec3) -> Result<Option<Option<Self>>, Error> {
        match self {
            Self::Mesh(_) => Ok(None),
            Self::Convex(solid) => Ok(Some(Some(Arc::new(solid.translated(-offset)?).into()))),
            Self::Instance(instance) => Ok(Some(Some(instance.translated(-offset)?.into()))),
            _ => self.anchored(None, &Offset::exact(-offset.as_dvec3())).map(Some),
        }
    }
}
