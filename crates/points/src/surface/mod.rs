//! The surface that points are samples of, estimated as one disc for each point, and the points
//! that rays from an eye reach between these discs.
//!
//! The other operators know points only, and leak where surfaces lie close together: thin boards,
//! fences, clutter. Here each point has a normal, its own or one of the plane that most of its
//! neighbours lie on, and a disc that reaches to those neighbours, as far as an edge, or less than
//! half a spacing where the surface seems to end. A point is hidden if the ray from the eye crosses
//! a disc before it comes near the point's own part of the surface. The idea is that of ray tracing
//! points (Schaufler & Jensen 2000, "Ray Tracing Point Sampled Geometry"); the planes are a robust
//! fit by random sampling (Fischler & Bolles 1981) with all pairs of few neighbours in the place of
//! random ones; the discs end like the triangles of a local Delaunay triangulation.
//!
//! Where points have normals that tell front and back, the far sides of closed bodies are hidden
//! even where rays leak in; sheets with one side are seen from both.

mod build;
mod fan;
mod plane;
mod rays;
#[cfg(test)]
mod tests;

use crate::PointCloud;
use crate::cloud::LengthError;
use crate::hull::MAX_POINTS;
use bitvec::vec::BitVec;
use glam::{DVec3, Vec3A};
use obvhs::bvh2::Bvh2;
use std::fmt;

/// The points of a cloud that can be seen from `eye`, which is in the coordinates of the source, as
/// the cloud's origin is: a bit for each point.
///
/// It takes the place of Open3D's `hidden_point_removal(eye, radius)`, without a radius to choose.
/// Normals are used if the cloud has some, and estimated otherwise. An estimate, which errs in both
/// directions. For several eyes make a [`Surface`] once.
///
/// # Errors
///
/// [`SurfaceError`] names the point at fault.
pub fn visible(cloud: &PointCloud, eye: DVec3) -> Result<BitVec, SurfaceError> {
    Surface::new(cloud)?.visible(eye)
}

/// Why there is no answer.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// A coordinate of a position or of the origin is infinite or not a number.
    #[error("point {index} has a coordinate that is not finite")]
    PointNotFinite {
        /// The first such point.
        index: usize,
    },
    /// A coordinate of the eye is infinite or not a number.
    #[error("the eye has a coordinate that is not finite")]
    EyeNotFinite,
    /// There are more points than indices.
    #[error("{count} points are too many: at most {MAX_POINTS}")]
    TooMany {
        /// The number of points.
        count: usize,
    },
    /// An attribute that not all points have.
    #[error(transparent)]
    Length(#[from] LengthError),
}

/// A cloud made ready for eyes: a disc for each of its places.
///
/// Takes `O(n log n)` on usual inputs, about 30 us of one thread for each point, on all threads;
/// and about 400 bytes for each point.
#[derive(Clone)]
pub struct Surface {
    discs: Vec<Disc>,
    /// For each disc, neighbours on the same part of the surface.
    peers: Vec<[u32; PEERS]>,
    tree: Bvh2,
    /// The disc of each point.
    disc_of: Vec<u32>,
    /// Normals tell front and back.
    oriented: bool,
    margins: Margins,
    frame: Frame,
}

/// Neighbours whose answers a point's own is compared with.
const PEERS: usize = 8;

/// In the place of a neighbour that there is not.
const NOBODY: u32 = u32::MAX;

/// Where the cloud lies: it is moved and scaled into the cube from -1 to 1, so that nothing over- or
/// underflows.
#[derive(Debug, Clone, Copy)]
struct Frame {
    middle: DVec3,
    scale: f64,
}

/// Lengths in spacings, which grow with the noise of the points.
#[derive(Debug, Clone, Copy)]
struct Margins {
    /// How far from a plane its points may be.
    inlier: f32,
    /// How far from a plane neighbours of the same part of the surface may be.
    layer: f32,
    /// How far behind a disc a point may be and not be hidden by it.
    behind: f32,
    /// The least distance between the two sides of a plate.
    plate: f32,
}

/// A piece of the estimated surface.
#[derive(Debug, Clone, Copy)]
struct Disc {
    at: Vec3A,
    /// Of length 1; zero if the point has too few neighbours, so that it hides nothing.
    normal: Vec3A,
    /// The side of the square of surface that the point stands for.
    spacing: f32,
    /// How far the neighbours of the plane are from it: the root of the mean square.
    rough: f32,
    /// How far the disc reaches, by [`fan::sector`].
    reach: [f32; fan::SECTORS],
}

impl fmt::Debug for Surface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (points, discs) = (self.disc_of.len(), self.discs.len());
        f.debug_struct("Surface").field("points", &points).field("discs", &discs).finish_non_exhaustive()
    }
}

impl Surface {
    /// Finds the discs of a cloud.
    ///
    /// Its normals, if there are some, are taken to point to the side from which the surface was
    /// seen, as the files of scanners and meshes have them.
    ///
    /// # Errors
    ///
    /// [`SurfaceError`] names the point at fault.
    pub fn new(cloud: &PointCloud) -> Result<Self, SurfaceError> {
        cloud.check()?;
        if cloud.len() > MAX_POINTS {
            return Err(SurfaceError::TooMany { count: cloud.len() });
        }
        build::build(cloud)
    }

    /// The points that can be seen from `eye`, which is in the coordinates of the source: a bit for
    /// each point. Points at the eye are visible, and so are those that no surface hides for want of
    /// neighbours.
    ///
    /// A ray for each point, on all threads, whose number does not change the answer.
    ///
    /// # Errors
    ///
    /// [`SurfaceError::EyeNotFinite`].
    pub fn visible(&self, eye: DVec3) -> Result<BitVec, SurfaceError> {
        if !eye.is_finite() {
            return Err(SurfaceError::EyeNotFinite);
        }
        let seen = self.seen((eye - self.frame.middle) * self.frame.scale);
        Ok(self.disc_of.iter().map(|&disc| seen[disc as usize]).collect())
    }
}
