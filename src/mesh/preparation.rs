//! The options by which meshes are prepared, and the progress of that.

use std::ops::ControlFlow;

use crate::error::{Error, not_negative};
use crate::mesh::surface::Rules;

/// The greatest angle between the triangles of a group and the first of them that may be asked for,
/// in degrees: near a right angle a group has no side that is turned to the eye.
const MOST_DEGREES: f32 = 80.0;

/// The same by default, for triangles that hide from their front only.
const FRONT_DEGREES: f32 = 40.0;

/// By default outlines may leave the edges by this share of the diagonal.
const TOLERANCE: f64 = 1.0 / 2000.0;

/// By default groups of a radius below this share of the diagonal hide nothing.
const LEAST_RADIUS: f64 = 1.0 / 1000.0;

/// How the triangles of a [`TriMesh`](crate::TriMesh) are prepared for hiding.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use casca::{MeshOptions, TriMesh};
/// use glam::Vec3;
///
/// # fn main() -> Result<(), casca::Error> {
/// let how = MeshOptions::default().tolerance(0.002);
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let mesh = TriMesh::prepare(corners, faces, &how, &mut |_| ControlFlow::Continue(()))?;
/// assert!(mesh.is_closed());
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct MeshOptions {
    /// How far the outlines of patches may leave the edges of triangles, in world units. The
    /// distance is added as a margin when they are drawn: a larger one is faster, and hides less
    /// near outlines. `None` is a 2000th of the mesh's diagonal.
    pub tolerance: Option<f32>,
    /// Connected groups of patches of a smaller radius hide nothing, in world units. `None` is a
    /// 1000th of the mesh's diagonal.
    pub min_radius: Option<f32>,
    /// The greatest angle between the triangles of a group of patches and the first of them, in
    /// degrees, up to 80. A query draws groups as one where that hides as much as their parts do,
    /// and else the parts, so that a smaller angle makes queries slower, and not tighter. `None` is
    /// 80, or 40 for triangles that hide from their front only: a group of those hides only where
    /// all of it is seen from the front.
    pub max_angle: Option<f32>,
    /// From which side triangles hide.
    pub facing: Facing,
    /// Whether the mesh will hide others. One that will not is prepared faster and takes less
    /// memory, but serves as bounds only: as an occluder it is refused.
    pub occludes: bool,
}

/// The sides from which triangles hide objects behind them: those from which the renderer draws
/// them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Facing {
    /// From both sides.
    #[default]
    Both,
    /// From the side where their corners run counter-clockwise: for renderers that leave out
    /// triangles seen from behind.
    Front,
}

impl Default for MeshOptions {
    fn default() -> Self {
        let facing = Facing::Both;
        Self { tolerance: None, min_radius: None, max_angle: None, facing, occludes: true }
    }
}

impl MeshOptions {
    /// Sets [`MeshOptions::tolerance`], in world units.
    #[must_use]
    pub const fn tolerance(mut self, distance: f32) -> Self {
        self.tolerance = Some(distance);
        self
    }

    /// Sets [`MeshOptions::min_radius`], in world units.
    #[must_use]
    pub const fn min_radius(mut self, radius: f32) -> Self {
        self.min_radius = Some(radius);
        self
    }

    /// Sets [`MeshOptions::max_angle`], in degrees.
    #[must_use]
    pub const fn max_angle(mut self, degrees: f32) -> Self {
        self.max_angle = Some(degrees);
        self
    }

    /// Sets [`MeshOptions::facing`].
    #[must_use]
    pub const fn facing(mut self, facing: Facing) -> Self {
        self.facing = facing;
        self
    }

    /// Sets [`MeshOptions::occludes`].
    #[must_use]
    pub const fn occludes(mut self, occludes: bool) -> Self {
        self.occludes = occludes;
        self
    }

    /// The rules for a mesh with a diagonal of this length.
    pub(crate) fn rules(&self, diagonal: f64) -> Result<Rules, Error> {
        let length = |what, given: Option<f32>, share: f64| match given {
            Some(v) => not_negative(what, f64::from(v)).map(|()| f64::from(v)),
            None => Ok(diagonal * share),
        };
        let degrees = f64::from(self.max_angle.unwrap_or(match self.facing {
            Facing::Both => MOST_DEGREES,
            Facing::Front => FRONT_DEGREES,
        }));
        if !(0.0..=f64::from(MOST_DEGREES)).contains(&degrees) {
            let what = "the greatest angle of a patch in degrees";
            return Err(Error::Setting { what, value: degrees, min: 0.0, max: f64::from(MOST_DEGREES) });
        }
        Ok(Rules {
            tolerance: length("the tolerance of outlines", self.tolerance, TOLERANCE)?,
            least: length("the least radius of a patch", self.min_radius, LEAST_RADIUS)?,
            cosine: degrees.to_radians().cos(),
            front: self.facing == Facing::Front,
        })
    }
}

/// Tells the share of a task that is done, from 0 to 1, as a share of the task that it is a part
/// of.
pub(crate) struct Progress<'a> {
    tell: &'a mut dyn FnMut(f32) -> ControlFlow<()>,
    from: f32,
    to: f32,
}

impl<'a> Progress<'a> {
    pub(crate) fn new(tell: &'a mut dyn FnMut(f32) -> ControlFlow<()>) -> Self {
        Self { tell, from: 0.0, to: 1.0 }
    }

    /// The progress of a part, which starts and ends at these shares.
    pub(crate) fn part(&mut self, from: f32, to: f32) -> Progress<'_> {
        let share = |x: f32| self.from + (self.to - self.from) * x;
        Progress { from: share(from), to: share(to), tell: &mut *self.tell }
    }

    /// # Errors
    /// [`Error::Cancelled`] if the task is to end.
    pub(crate) fn tell(&mut self, share: f32) -> Result<(), Error> {
        match (self.tell)(self.from + (self.to - self.from) * share) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Error::Cancelled),
        }
    }
}
