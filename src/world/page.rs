//! Pages: cubes of cells that are loaded and dropped as wholes.

use std::fmt;

use glam::DVec3;

use crate::error::Error;
use crate::geometry::offset::Offset;
use crate::numeric::world::{FARTHEST, FARTHEST_PAGE};
use crate::object::{ObjectDesc, Occluder};

/// The cells of a page along each axis.
pub const PAGE_CELLS: u32 = 512;

/// Names a page of a [`World`](crate::World): its least corner is at these numbers of pages from
/// the origin. Up to 2^28 along each axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct PageId {
    /// Along x.
    pub x: i32,
    /// Along y.
    pub y: i32,
    /// Along z.
    pub z: i32,
}

impl PageId {
    /// The page at these numbers of pages from the origin.
    pub const fn new(x: i32, y: i32, z: i32) -> Self {
        Self { x, y, z }
    }

    pub(super) fn to_array(self) -> [i32; 3] {
        [self.x, self.y, self.z]
    }

    /// The page that contains a place, if it is one that may be.
    pub(super) fn containing(at: DVec3, page_size: f64) -> Option<Self> {
        let along = |p: f64| {
            let guess = (p / page_size).floor();
            // The quotient may be off by one rounding: the exact corners decide.
            let low = if guess * page_size > p { guess - 1.0 } else { guess };
            let page = if (low + 1.0) * page_size <= p { low + 1.0 } else { low };
            (page.abs() <= f64::from(FARTHEST_PAGE)).then_some(page as i32)
        };
        Some(Self { x: along(at.x)?, y: along(at.y)?, z: along(at.z)? })
    }

    /// The least corner, an exact place.
    pub(super) fn corner(self, page_size: f64) -> DVec3 {
        DVec3::from_array(self.to_array().map(|page| f64::from(page) * page_size))
    }

    /// # Errors
    /// Refuses a page that is too far from the first one.
    pub(super) fn check(self) -> Result<(), Error> {
        let far = self.to_array().iter().any(|page| page.unsigned_abs() > FARTHEST_PAGE.unsigned_abs());
        let value = DVec3::from_array(self.to_array().map(f64::from));
        if far { Err(Error::TooFar { what: "the page", value }) } else { Ok(()) }
    }
}

impl fmt::Display for PageId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "page ({}, {}, {})", self.x, self.y, self.z)
    }
}

/// The objects of a page, checked and ready to be taken into a world.
///
/// Make it on any thread, where files are read and meshes prepared; [`World::load`] then takes it
/// over without looking at anything again.
///
/// [`World::load`]: crate::World::load
#[derive(Debug, Clone, Default)]
pub struct PageObjects(pub(super) Vec<ObjectDesc>);

impl PageObjects {
    /// Checks the descriptions of a page's objects. Their shapes are in world units relative to the
    /// least corner of the page; they may reach out of it, and be larger than it. They may be
    /// [placed](ObjectDesc::placed) by a transform, and move.
    ///
    /// # Errors
    /// As [`Scene::insert`](crate::Scene::insert), for the first object that is refused.
    pub fn new(objects: impl IntoIterator<Item = ObjectDesc>) -> Result<Self, Error> {
        let objects: Vec<ObjectDesc> = objects.into_iter().collect();
        objects.iter().try_for_each(check)?;
        Ok(Self(objects))
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// Refuses objects that no scene takes, also at the farthest place of a world.
pub(super) fn check(desc: &ObjectDesc) -> Result<(), Error> {
    desc.check()?;
    for far in [FARTHEST, -FARTHEST] {
        let offset = Offset::exact(DVec3::splat(2.0 * far));
        desc.bounds.anchored(desc.transform, &offset)?.check()?;
        let occluder = desc.occluder.as_ref().filter(|o| !matches!(o, Occluder::Convex(_)));
        let occluder = occluder.map(|o| o.anchored(desc.transform, &offset)).transpose()?.flatten();
        occluder.iter().try_for_each(Occluder::check)?;
    }
    Ok(())
}
