//! Objects as the application describes them, and their ids.

use glam::Affine3A;

use crate::error::{Error, not_negative};
use crate::numeric::shape::{OCCLUDER_ROUNDING, OCCLUDER_SHARE};
use crate::object::{Bounds, Occluder, Placed};

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
    /// A small object that hides nothing is asked in each of the next 256 to 512 frames if a volume of it
    /// lasts less than eight frames and a quarter of a second: that costs less than volumes.
    ///
    /// It counts as visible when its volume is revealed, and from [`crate::Scene::begin_frame`] on
    /// until a report that is due comes. Until then it hides nothing.
    OnExpiry,
}

/// Whether an object moves.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Motion {
    /// Stays where it is. It can still be updated, at the cost of taking it
    /// out of the static matrices and putting it back.
    Static,
    /// Moves. While no view sees it, a temporal bounding volume stands for it.
    Dynamic {
        /// Greatest speed of any point in world units per second, if known.
        max_speed: Option<f32>,
        /// When its motion is reported.
        #[cfg_attr(feature = "serde", serde(default))]
        reports: Reports,
    },
}

/// The mask of an object on all layers.
pub(crate) const ALL_LAYERS: u64 = u64::MAX;

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
    /// Whether a speed or a way of reports was given for an object that does not move.
    pub(crate) contradicts: bool,
    pub(crate) user_data: u64,
    /// The layers that it is on, a bit for each.
    pub(crate) layers: u64,
    /// From the space of the shapes to world space, if they are not in the latter.
    pub(crate) transform: Option<Affine3A>,
}

impl ObjectDesc {
    /// An object that stays where it is.
    pub fn fixed(bounds: impl Into<Bounds>) -> Self {
        Self::with_motion(bounds.into(), Motion::Static)
    }

    /// An object that moves, with no promise about its speed.
    pub fn dynamic(bounds: impl Into<Bounds>) -> Self {
        let motion = Motion::Dynamic { max_speed: None, reports: Reports::WhenMoved };
        Self::with_motion(bounds.into(), motion)
    }

    fn with_motion(bounds: Bounds, motion: Motion) -> Self {
        Self {
            bounds,
            occluder: None,
            motion,
            contradicts: false,
            user_data: 0,
            layers: ALL_LAYERS,
            transform: None,
        }
    }

    /// Lets the object hide others. The occluder must lie inside the object's
    /// solid geometry, which must lie inside its bounds.
    #[must_use]
    pub fn occluder(mut self, occluder: impl Into<Occluder>) -> Self {
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

    /// Says that the object's motion goes unreported while it is hidden
    /// (see [`Reports::OnExpiry`]). Needs a [greatest speed](ObjectDesc::max_speed), and a
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

    /// Puts the object on some layers only, a bit for each: it is shown by the views whose
    /// [mask](crate::View::with_layers) has a bit in common with these. Without this call it is on
    /// all layers.
    ///
    /// Its occluder hides in the views that show the object, and in no others.
    /// [`crate::Method::Cell`] joins occluders with the same mask only, and while some are on 16
    /// different masks, those on others hide nothing from it. On no layer (0) an object is shown by
    /// no view.
    ///
    /// Engines with more than 64 layers give layers 0 to 62 a bit each and all others the last bit.
    /// Sets then contain objects of layers that a view does not show, which the engine leaves out.
    /// An object on one of those others must have no occluder: a view that shares the bit would
    /// take it to hide, and not show it.
    #[must_use]
    pub fn layers(mut self, mask: u64) -> Self {
        self.layers = mask;
        self
    }

    /// Places the object: its bounds and its occluder are in a space of their own, and `transform`
    /// leads from there to world space. [`crate::Scene::set_transform`] moves both in one call.
    ///
    /// Transforms may turn, move and scale. The scale may differ by axis, but not for spheres. In
    /// world space a box becomes a turned box, and a mesh an [`Instance`](crate::Instance). A box
    /// that a transform shears is tested by the box around it and hides as a convex solid. Give a
    /// mesh itself, not an instance of it.
    ///
    /// A renderer transforms vertices in single precision. Bounds grow by that error and occluders
    /// shrink by it: by about two millionths of the greatest coordinate. An occluder that is hardly
    /// thicker hides nothing.
    ///
    /// ```
    /// use casca::{Aabb, ObjectDesc, Scene};
    /// use glam::{Affine3A, UVec3, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// let mut scene = Scene::new(1.0)?;
    /// // A door that turns around its hinge.
    /// let leaf = Aabb::new(Vec3::ZERO, Vec3::new(1.0, 2.0, 0.1));
    /// let at = |angle| Affine3A::from_translation(Vec3::splat(8.0)) * Affine3A::from_rotation_y(angle);
    /// let door = scene.insert(ObjectDesc::dynamic(leaf).occluder(leaf).placed(at(0.0)))?;
    /// scene.set_transform(door, at(0.5))?;
    /// assert_eq!(scene.transform(door)?, Some(at(0.5)));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn placed(mut self, transform: Affine3A) -> Self {
        self.transform = Some(transform);
        self
    }

    /// Takes the shapes to world space. Returns them as they were, for an object that is placed.
    ///
    /// # Errors
    /// As [`Placed::at`].
    pub(crate) fn place(&mut self) -> Result<Option<Placed>, Error> {
        let Some(transform) = self.transform else { return Ok(None) };
        let placed = Placed { bounds: self.bounds.clone(), occluder: self.occluder.clone(), transform };
        (self.bounds, self.occluder) = placed.at(transform)?;
        Ok(Some(placed))
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        check_pair(&self.bounds, self.occluder.as_ref())?;
        if self.contradicts {
            return Err(Error::FixedMoves);
        }
        match self.motion {
            Motion::Dynamic { max_speed: Some(v), .. } => not_negative("the greatest speed", f64::from(v)),
            Motion::Dynamic { max_speed: None, reports: Reports::OnExpiry } => Err(Error::SpeedNeeded),
            _ => Ok(()),
        }
    }
}

/// Refuses bounds and occluders that are no shapes, and occluders that plainly stick out of their
/// bounds.
pub(crate) fn check_pair(bounds: &Bounds, occluder: Option<&Occluder>) -> Result<(), Error> {
    bounds.check()?;
    let Some(occluder) = occluder else { return Ok(()) };
    occluder.check()?;
    let outer = bounds.block();
    let largest = outer.min.abs().max(outer.max.abs()).max_element();
    let allowed = OCCLUDER_SHARE * (outer.max - outer.min).length() + OCCLUDER_ROUNDING * largest;
    // The quick box of an instance may be much larger than its vertices need.
    if outer.beyond(&occluder.block()) > allowed {
        let by = outer.beyond(&occluder.kind().least_block());
        if by > allowed {
            return Err(Error::OccluderOutside { by });
        }
    }
    Ok(())
}
