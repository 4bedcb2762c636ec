//! Objects as the application describes them, and their ids.

use std::fmt;

use crate::error::{Error, not_negative};
use crate::shape::{Bounds, Occluder};

/// Names an object of one scene. An id is never used again: after removal it
/// is an error wherever it is passed, as is an id of another scene.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId {
    pub(crate) scene: u32,
    pub(crate) slot: u32,
    pub(crate) generation: u32,
}

impl ObjectId {
    /// A small number that no other living object of the scene has: an index for
    /// the application's own arrays. It may be given again after removal.
    pub fn index(self) -> usize {
        self.slot as usize
    }
}

impl fmt::Debug for ObjectId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ObjectId({self})")
    }
}

impl fmt::Display for ObjectId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "object {}.{} of scene {}", self.slot, self.generation, self.scene)
    }
}

/// When the application tells of the motion of a dynamic object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reports {
    /// Whenever it moved, hidden or not.
    #[default]
    WhenMoved,
    /// In every frame in which the last PVS holds it, and when
    /// [`crate::Scene::begin_frame`] lists it. Needs a greatest speed, which must be
    /// kept while it goes unreported. Counts as visible when its volume is revealed.
    OnExpiry,
}

/// Whether an object moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// Stays where it is. It can still be updated, at the cost of taking it
    /// out of the static matrices and putting it back.
    Static,
    /// Moves. While no view sees it, it is held by a temporal bounding volume.
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
/// use casca::{Aabb, ObjectDesc, Sphere};
/// use glam::Vec3;
///
/// let wall = Aabb::new(Vec3::ZERO, Vec3::new(10.0, 3.0, 0.5));
/// let wall = ObjectDesc::fixed(wall).occluder(wall);
/// let bird = ObjectDesc::dynamic(Sphere::new(Vec3::splat(5.0), 0.2)).max_speed(12.0);
/// # let _ = (wall, bird);
/// ```
#[derive(Debug, Clone)]
pub struct ObjectDesc {
    pub(crate) bounds: Bounds,
    pub(crate) occluder: Option<Occluder>,
    pub(crate) motion: Motion,
}

impl ObjectDesc {
    /// An object that stays where it is.
    pub fn fixed(bounds: impl Into<Bounds>) -> Self {
        Self { bounds: bounds.into(), occluder: None, motion: Motion::Static }
    }

    /// An object that moves, with no promise about its speed.
    pub fn dynamic(bounds: impl Into<Bounds>) -> Self {
        let motion = Motion::Dynamic { max_speed: None, reports: Reports::WhenMoved };
        Self { bounds: bounds.into(), occluder: None, motion }
    }

    /// Lets the object hide others. The occluder must lie inside the object's
    /// solid geometry, which must lie inside its bounds.
    #[must_use]
    pub fn occluder(mut self, occluder: impl Into<Occluder>) -> Self {
        self.occluder = Some(occluder.into());
        self
    }

    /// Promises that no point of the object moves faster, in world units per second.
    #[must_use]
    pub fn max_speed(mut self, speed: f32) -> Self {
        let reports = match self.motion {
            Motion::Static => Reports::WhenMoved,
            Motion::Dynamic { reports, .. } => reports,
        };
        self.motion = Motion::Dynamic { max_speed: Some(speed), reports };
        self
    }

    /// Says that the object's motion goes unreported while it is hidden
    /// (see [`Reports::OnExpiry`]).
    #[must_use]
    pub fn reported_on_expiry(mut self) -> Self {
        let max_speed = match self.motion {
            Motion::Static => None,
            Motion::Dynamic { max_speed, .. } => max_speed,
        };
        self.motion = Motion::Dynamic { max_speed, reports: Reports::OnExpiry };
        self
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        self.bounds.check()?;
        self.occluder.as_ref().map_or(Ok(()), Occluder::check)?;
        match self.motion {
            Motion::Dynamic { max_speed: Some(v), .. } => not_negative("the greatest speed", f64::from(v)),
            Motion::Dynamic { max_speed: None, reports: Reports::OnExpiry } => Err(Error::SpeedNeeded),
            _ => Ok(()),
        }
    }
}
