//! Objects as they were described, from which their shapes in a scene are made.

use glam::{Affine3A, DVec3};

use crate::error::Error;
use crate::geometry::Aabb;
use crate::geometry::offset::Offset;
use crate::object::{Bounds, ObjectDesc, Occluder};
use crate::world::page::{PageId, check};

/// The shapes of an object relative to a place.
#[derive(Debug, Clone)]
pub(super) struct ObjectSource {
    pub(super) bounds: Bounds,
    pub(super) occluder: Option<Occluder>,
    /// From the space of the shapes to that around the place. Apart, since few objects have one.
    pub(super) transform: Option<Box<Affine3A>>,
    /// The place in the world.
    pub(super) place: DVec3,
    /// The page that it goes with, if it belongs to one.
    pub(super) page: Option<PageId>,
}

/// Bounds that contain everything. Shapes are checked before, so that nothing needs them.
const EVERYWHERE: Aabb = Aabb { min: glam::Vec3::splat(-f32::MAX), max: glam::Vec3::splat(f32::MAX) };

impl ObjectSource {
    /// The shapes of an object, which are left in its description without their transform.
    pub(super) fn of(desc: &mut ObjectDesc, place: DVec3, page: Option<PageId>) -> Self {
        let transform = desc.transform.take().map(Box::new);
        Self { bounds: desc.bounds.clone(), occluder: desc.occluder.clone(), transform, place, page }
    }

    /// Refuses shapes that no scene takes.
    ///
    /// # Errors
    /// As [`check`].
    pub(super) fn check(&self) -> Result<(), Error> {
        let mut desc = ObjectDesc::dynamic(self.bounds.clone());
        (desc.occluder, desc.transform) = (self.occluder.clone(), self.transform.as_deref().copied());
        check(&desc)
    }

    /// The shapes in coordinates relative to an origin. Shapes that cannot be told there are
    /// everywhere and hide nothing.
    pub(super) fn at(&self, origin: DVec3) -> (Bounds, Option<Occluder>) {
        let offset = Offset::between(self.place, origin);
        let transform = self.transform.as_deref().copied();
        let bounds = self.bounds.anchored(transform, &offset);
        let bounds = bounds.ok().filter(|bounds| bounds.check().is_ok());
        let occluder = self.occluder.as_ref().and_then(|o| o.anchored(transform, &offset).ok().flatten());
        let occluder = occluder.filter(|occluder| occluder.check().is_ok());
        match bounds {
            Some(bounds) => (bounds, occluder),
            None => (EVERYWHERE.into(), None),
        }
    }
}
