//! One disc, and the discs of a whole cloud.

use super::fan::SECTORS;
use crate::numeric::BOX;
use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use std::time::Duration;

/// The discs of a cloud: one for each of its places.
#[derive(Clone)]
pub(super) struct Discs {
    pub discs: Vec<Disc>,
    /// For each disc, neighbours on the same part of the surface; none if it is oriented.
    pub peers: Vec<[u32; PEERS]>,
    pub tree: Bvh2,
    /// The disc of each point.
    pub disc_of: Vec<u32>,
    pub margins: Margins,
    pub frame: Frame,
    /// Whether points of no surface are visible where nothing hides them.
    pub show_strays: bool,
}

/// Neighbours whose answers a point's own is compared with.
pub(super) const PEERS: usize = 8;

/// In the place of a neighbour that there is not.
pub(super) const NOBODY: u32 = u32::MAX;

/// Where the cloud lies: it is moved and scaled into the cube from -1 to 1, so that nothing over-
/// or underflows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub middle: DVec3,
    pub scale: f64,
}

/// Lengths in spacings, which grow with the noise of the points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Margins {
    /// How far from a plane its points may be.
    pub inlier: f32,
    /// How far from a plane neighbours of the same part of the surface may be.
    pub layer: f32,
    /// How far behind a disc a point may be and not be hidden by it.
    pub behind: f32,
    /// The least distance between the two sides of a plate.
    pub plate: f32,
    /// The least distance of a point between the two sides of a plate from each.
    pub between: f32,
    /// The least spacing by which these are taken but the last: that of noise.
    pub grain: f32,
}

/// A piece of the estimated surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Disc {
    pub at: Vec3A,
    /// Of length 1; zero if the point has too few neighbours, so that it hides nothing.
    pub normal: Vec3A,
    /// The side of the square of surface that the point stands for.
    pub spacing: f32,
    /// How far the neighbours of the plane are from it: the root of the mean square.
    pub rough: f32,
    /// The sign of the normal tells front and back.
    pub oriented: bool,
    /// It is on the rim of a plate: nobody sees it from behind.
    pub solid: bool,
    /// It is on no surface.
    pub stray: bool,
    /// How far the disc reaches in each of the directions in which sectors begin.
    pub reach: [f32; SECTORS],
}

/// The tree of some discs.
pub(super) fn tree(discs: &[Disc]) -> Bvh2 {
    let bounds: Vec<Aabb> = discs.iter().map(Disc::bounds).collect();
    build_bvh2(&bounds, BvhBuildParams::fast_build(), &mut Duration::default())
}

impl Disc {
    fn bounds(&self) -> Aabb {
        let reach = self.reach.iter().copied().fold(0.0, f32::max);
        let sine2 = (Vec3A::ONE - self.normal * self.normal).max(Vec3A::ZERO);
        let half = Vec3A::new(sine2.x.sqrt(), sine2.y.sqrt(), sine2.z.sqrt()) * reach
            + BOX * (reach + self.at.abs());
        Aabb { min: self.at - half, max: self.at + half }
    }
}
