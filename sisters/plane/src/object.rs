//! Objects as the application describes them.

use crate::error::{Error, not_negative};
use crate::geometry::Shape;
use crate::numeric::{OCCLUDER_ROUNDING, OCCLUDER_SHARE};

/// When the application tells of the motion of a dynamic object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Reports {
    /// Whenever it moved, hidden or not.
    #[default]
    WhenMoved,
    /// When [`crate::Scene::begin_frame`] lists it, and in every frame after one that ended with it
    /// in sight. Needs a greatest speed, which the object must keep while it goes unreported; a
    /// report may put it anywhere.
    ///
    /// It counts as visible when its volume is seen, and from [`crate::Scene::begin_frame`] on
    /// until a report that is due comes. Until then it hides nothing.
    OnExpiry,
}

/// Whether an object moves.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Motion {
    /// Stays where it is. It can still be updated.
    Static,
    /// Moves. While no view sees it, a temporal bounding volume stands for it.
    Dynamic {
        /// Greatest speed of any point in world units per second, if known.
        max_speed: Option<f32>,
        /// When its motion is reported.
        reports: Reports,
    },
}

/// An object to insert into a scene.
///
/// ```
/// use casca_plane::{Disc, ObjectDesc, Segment};
/// use glam::Vec2;
///
/// let wall = Segment::new(Vec2::ZERO, Vec2::new(10.0, 0.0));
/// let wall = ObjectDesc::fixed(wall).occluder(wall);
/// let guard = ObjectDesc::dynamic(Disc::new(Vec2::splat(5.0), 0.4)).max_speed(3.0);
/// # let _ = (wall, guard);
/// ```
#[derive(Debug, Clone)]
pub struct ObjectDesc {
    pub(crate) bounds: Shape,
    pub(crate) occluder: Option<Shape>,
    pub(crate) motion: Motion,
    /// Whether a speed was given for an object that does not move.
    pub(crate) contradicts: bool,
    pub(crate) user_data: u64,
    pub(crate) layers: u64,
}

impl ObjectDesc {
    /// An object that stays where it is.
    pub fn fixed(bounds: impl Into<Shape>) -> Self {
        Self::with_motion(bounds.into(), Motion::Static)
    }

    /// An object that moves, with no promise about its speed.
    pub fn dynamic(bounds: impl Into<Shape>) -> Self {
        Self::with_motion(bounds.into(), Motion::Dynamic { max_speed: None, reports: Reports::WhenMoved })
    }

    fn with_motion(bounds: Shape, motion: Motion) -> Self {
        Self { bounds, occluder: None, motion, contradicts: false, user_data: 0, layers: u64::MAX }
    }

    /// Lets the object hide others. The occluder must lie inside the bounds.
    #[must_use]
    pub fn occluder(mut self, occluder: impl Into<Shape>) -> Self {
        self.occluder = Some(occluder.into());
        self
    }

    /// Promises that no point of the object moves faster, in world units per second. Only for
    /// [dynamic](ObjectDesc::dynamic) objects: [`crate::Scene::insert`] refuses it for a fixed one.
    #[must_use]
    pub fn max_speed(mut self, speed: f32) -> Self {
        match &mut self.motion {
            Motion::Static => self.contradicts = true,
            Motion::Dynamic { max_speed, .. } => *max_speed = Some(speed),
        }
        self
    }

    /// Says that the object's motion goes unreported while it is hidden (see
    /// [`Reports::OnExpiry`]). Needs a [greatest speed](ObjectDesc::max_speed), and a
    /// [dynamic](ObjectDesc::dynamic) object.
    #[must_use]
    pub fn reported_on_expiry(mut self) -> Self {
        match &mut self.motion {
            Motion::Static => self.contradicts = true,
            Motion::Dynamic { reports, .. } => *reports = Reports::OnExpiry,
        }
        self
    }

    /// Gives the object a number of the application's, 0 if none is given: see
    /// [`crate::Scene::user_data`].
    #[must_use]
    pub fn user_data(mut self, user_data: u64) -> Self {
        self.user_data = user_data;
        self
    }

    /// Puts the object on some layers, a bit for each; without this it is on all. A view shows the
    /// objects that share a layer with it ([`crate::View::with_layers`]). The occluder hides in
    /// these views and in no others. An object that is not on all layers hides nothing from
    /// [`crate::Method::Cell`]. On no layer (0) it is shown by no view.
    #[must_use]
    pub fn layers(mut self, mask: u64) -> Self {
        self.layers = mask;
        self
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        check_pair(&self.bounds, self.occluder.as_ref())?;
        if self.contradicts {
            return Err(Error::FixedMoves);
        }
        match self.motion {
            Motion::Dynamic { max_speed: Some(speed), .. } => not_negative("the greatest speed", speed),
            Motion::Dynamic { max_speed: None, reports: Reports::OnExpiry } => Err(Error::SpeedNeeded),
            _ => Ok(()),
        }
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
