//! Objects as the application describes them.

use crate::error::Error;
use crate::geometry::Shape;
use crate::numeric::{OCCLUDER_ROUNDING, OCCLUDER_SHARE};

/// An object to insert into a scene. It may move at any time ([`crate::Scene::update`]).
///
/// ```
/// use casca_plane::{Disc, ObjectDesc, Segment};
/// use glam::Vec2;
///
/// let wall = Segment::new(Vec2::ZERO, Vec2::new(10.0, 0.0));
/// let wall = ObjectDesc::new(wall).occluder(wall);
/// let guard = ObjectDesc::new(Disc::new(Vec2::splat(5.0), 0.4)).user_data(7);
/// # let _ = (wall, guard);
/// ```
#[derive(Debug, Clone)]
pub struct ObjectDesc {
    pub(crate) bounds: Shape,
    pub(crate) occluder: Option<Shape>,
    pub(crate) user_data: u64,
}

impl ObjectDesc {
    /// An object that hides nothing.
    pub fn new(bounds: impl Into<Shape>) -> Self {
        Self { bounds: bounds.into(), occluder: None, user_data: 0 }
    }

    /// Lets the object hide others. The occluder must lie inside the bounds.
    #[must_use]
    pub fn occluder(mut self, occluder: impl Into<Shape>) -> Self {
        self.occluder = Some(occluder.into());
        self
    }

    /// Gives the object a number of the application's, 0 if none is given: see
    /// [`crate::Scene::user_data`].
    #[must_use]
    pub fn user_data(mut self, user_data: u64) -> Self {
        self.user_data = user_data;
        self
    }
}

/// Refuses bounds and occluders that are no shapes, and occluders that plainly stick out of their
/// bounds.
pub(crate) fn check_pair(bounds: &Shape, occluder: Option<&Shape>) -> Result<(), Error> {
    bounds.check("the bounds")?;
    let Some(occluder) = occluder else { return Ok(()) };
    occluder.check("the occluder")?;
    let (outer, inner) = (bounds.block(), occluder.block());
    let by = (outer.min - inner.min).max(inner.max - outer.max).max_element();
    let reach = outer.min.abs().max(outer.max.abs()).max_element();
    if by > OCCLUDER_SHARE * (outer.max - outer.min).length() + OCCLUDER_ROUNDING * reach {
        return Err(Error::OccluderOutside { by });
    }
    Ok(())
}
