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
    /// Closes gaps up to about half as wide in the surface that hides others, in world units:
    /// cracks between panels that nearly meet, and corners that nearly lie on edges. `None` is 0:
    /// the triangles hide as they are.
    ///
    /// It is for levels modelled with cracks that nobody is meant to look through. A vertex within
    /// half of the gap of another moves there, and edges are split at vertices as near as that. All
    /// that the mesh hides is then hidden by *the triangles grown by the gap*: each line of sight
    /// to it passes a point that is no farther than the gap from a triangle, or ends at one. So
    /// objects may be lost that are seen through an opening as narrow, past an edge as near, or
    /// that lie as near to a triangle. Choose it smaller than all openings that matter, and
    /// than the distance of posters from their walls: a few millimetres for a building.
    ///
    /// With [`Facing::Front`] such a triangle may be seen from its back, as those that are not much
    /// larger than the gap may tilt; those that turn over are left out.
    ///
    /// Bounds, the solids that meshes are drawn as, opaque cells and
    /// [`TriMesh::is_closed`](crate::TriMesh::is_closed) come from the triangles as given. Parts
    /// thinner than half of the gap become sheets, and of closed ones may hide from one side only.
    /// Gaps between different meshes stay open. Preparation takes up to twice as long; queries take
    /// less time where many gaps are closed.
    pub gap: Option<f32>,
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
        Self { tolerance: None, min_radius: None, max_angle: None, gap: None, facing, occludes: true }
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

    /// Sets [`MeshOptions::gap`], in world units.
    #[must_use]
    pub const fn gap(mut self, gap: f32) -> Self {
        self.gap = Some(gap);
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

    /// How wide gaps are that the surface closes: 0 if there is none to close.
    pub(crate) fn closed_gap(&self) -> Result<f64, Error> {
        let gap = f64::from(self.gap.unwrap_or(0.0));
        not_negative("the gap that is closed", gap)?;
        Ok(if self.occludes { gap } else { 0.0 })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_lengths() {
        let gap = |gap: f32| MeshOptions::default().gap(gap).closed_gap();
        assert_eq!(MeshOptions::default().closed_gap(), Ok(0.0));
        assert_eq!((gap(0.5), gap(f32::MAX)), (Ok(0.5), Ok(f64::from(f32::MAX))));
        assert!(matches!(gap(-0.5), Err(Error::Negative { .. })));
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(matches!(gap(bad), Err(Error::NotFinite { .. })));
        }
        assert_eq!(MeshOptions::default().gap(0.5).occludes(false).closed_gap(), Ok(0.0));
    }
}
