//! The surface that points are samples of, estimated as one disc for each point, and the points
//! that rays from an eye reach between these discs.
//!
//! The other operators know points only, and leak where surfaces lie close together: thin boards, fences,
//! clutter. Here each point has a normal, its own or one of the plane that most of its neighbours lie on, and
//! a disc that reaches to those neighbours, as far as an edge, or less than half a spacing where the surface
//! seems to end. A point is hidden if the ray from the eye crosses a disc before it comes near the point's
//! own part of the surface. The idea is that of ray tracing points (Schaufler & Jensen 2000, "Ray Tracing
//! Point Sampled Geometry"); the planes are a robust fit by random sampling (Fischler & Bolles 1981) with all
//! pairs of few neighbours in the place of random ones; the discs are polygons that end like the triangles of
//! a local Delaunay triangulation, and where points of a side of the same body lie below their face.
//!
//! Where points have normals that tell front and back, the far sides of closed bodies are hidden
//! even where rays leak in; sheets with one side are seen from both.

mod build;
mod disc;
mod error;
mod fan;
mod plane;
mod rays;
mod rim;
mod steps;
mod stray;
#[cfg(test)]
mod tests;

use crate::cloud::PointCloud;
use crate::hull::MAX_POINTS;
use crate::numeric::FARTHEST_EYE;
use bitvec::vec::BitVec;
use disc::Discs;
use glam::{DVec3, Vec3};
use std::fmt;

pub use error::SurfaceError;

/// The points of a cloud that can be seen from `eye`, which is in the coordinates of the source, as
/// the cloud's origin is: a bit for each point.
///
/// It takes the place of Open3D's `hidden_point_removal(eye, radius)`, without a radius to choose.
/// Normals are used where the cloud has some, and estimated otherwise. An estimate, which errs in
/// both directions. For several eyes make a [`Surface`] once.
///
/// # Errors
/// [`SurfaceError`] names the point at fault.
pub fn visible(cloud: &PointCloud, eye: DVec3) -> Result<BitVec, SurfaceError> {
    Surface::new(cloud)?.visible(eye)
}

/// A cloud made ready for eyes: a disc for each of its places.
///
/// Takes `O(n log n)` on usual inputs, about 10 us of one thread for each point, on all threads.
/// Keeps at most 44 bytes for each point of large clouds, and needs some 300 while it is made.
#[derive(Clone)]
pub struct Surface(Discs);

impl fmt::Debug for Surface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (points, discs) = (self.0.disc_of.len(), self.0.discs.len());
        f.debug_struct("Surface").field("points", &points).field("discs", &discs).finish_non_exhaustive()
    }
}

impl Surface {
    /// Finds the discs of a cloud.
    ///
    /// Its normals, if there are some, are taken to point to the side from which the surface was
    /// seen, as the files of scanners and meshes have them. They may have any length; those that
    /// are zero or not finite are estimated.
    ///
    /// # Errors
    /// [`SurfaceError`] names the point at fault.
    pub fn new(cloud: &PointCloud) -> Result<Self, SurfaceError> {
        cloud.check()?;
        if cloud.len() > MAX_POINTS {
            return Err(SurfaceError::TooMany { count: cloud.len() });
        }
        build::build(cloud).map(Self)
    }

    /// The points that can be seen from `eye`, which is in the coordinates of the source: a bit for each
    /// point. Points at the eye are visible, and so are those that no surface hides for want of neighbours.
    ///
    /// A ray for each point, on all threads, whose number does not change the answer.
    ///
    /// # Errors
    /// [`SurfaceError::EyeNotFinite`].
    pub fn visible(&self, eye: DVec3) -> Result<BitVec, SurfaceError> {
        if !eye.is_finite() {
            return Err(SurfaceError::EyeNotFinite);
        }
        let way = eye - self.0.frame.middle;
        let most = way.abs().max_element();
        // The product may be infinite.
        let scale = self.0.frame.scale;
        let factor = if most * scale > FARTHEST_EYE { FARTHEST_EYE / most } else { scale };
        let visible = self.0.visible(way * factor);
        Ok(self.0.disc_of.iter().map(|&disc| visible[disc as usize]).collect())
    }

    /// Whether points that are on no surface are visible where nothing hides them, as they are by
    /// default, or never. They hide nothing.
    #[must_use]
    pub fn with_strays(mut self, shown: bool) -> Self {
        self.0.show_strays = shown;
        self
    }

    /// The points that seem to be on no surface: a bit for each point. In sparse scans some of thin
    /// leaves and wires are taken for such.
    pub fn strays(&self) -> BitVec {
        self.0.disc_of.iter().map(|&disc| self.0.discs[disc as usize].disc().stray).collect()
    }

    /// The memory that it takes beside the cloud, in bytes.
    pub fn bytes(&self) -> usize {
        let Discs { discs, tree, disc_of, .. } = &self.0;
        let of_discs = size_of_val(&discs[..]) + size_of_val(&tree.nodes[..]);
        size_of::<Self>() + of_discs + size_of_val(&disc_of[..])
    }

    /// The normals of the discs, one for each point: those of the cloud to four digits, or estimates
    /// whose sign tells nothing; zero where there are too few neighbours, and on no surface.
    pub fn normals(&self) -> impl Iterator<Item = Vec3> {
        self.0.disc_of.iter().map(|&disc| self.0.discs[disc as usize].disc().normal.into())
    }
}
