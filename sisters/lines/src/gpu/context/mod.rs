//! Context: opaque triangle meshes among the lines, which hide them.
//!
//! Meshes are rasterised into a depth of each pixel, so that their number costs no pixel anything.
//! The same triangles are occluders of the scene of bundles: casca's meshes hide no more than their
//! triangles do.

mod device;
mod pass;

use std::sync::Arc;

use casca::{Aabb, Occluder, TriMesh};
use glam::Vec3;

use crate::gpu::error::LinesGpuError;
use crate::mesh::Mesh;

pub use device::GpuContext;
pub(super) use pass::{ContextPass, Surfaces};

/// The colour of walls, bytes of sRGB.
pub const GREY: [u8; 3] = [158, 163, 173];

/// A mesh in a colour, prepared to hide lines.
pub struct Context {
    mesh: Mesh,
    colour: [u8; 3],
    occluders: Vec<(Aabb, Occluder)>,
}

impl Context {
    /// A mesh, open or closed, in a colour: bytes of sRGB. Time: that of [`TriMesh::new`], one to
    /// two seconds for a million triangles.
    ///
    /// # Errors
    /// The mesh has no triangles, or positions that are not finite, or it names vertices that are
    /// not there.
    pub fn new(mesh: Mesh, colour: [u8; 3]) -> Result<Self, LinesGpuError> {
        let occluder = TriMesh::new(mesh.positions.clone(), mesh.triangles.clone())?;
        let corners = mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize]);
        let occluders = Aabb::from_points(corners).map(|bounds| (bounds, Arc::new(occluder).into()));
        Ok(Self { mesh, colour, occluders: occluders.into_iter().collect() })
    }

    /// Grey boxes, by their least and greatest corners; each hides alone.
    pub fn of_boxes(boxes: &[[Vec3; 2]]) -> Self {
        let solid = |[min, max]: &[Vec3; 2]| (Aabb::new(*min, *max), Aabb::new(*min, *max).into());
        let occluders = boxes.iter().map(solid).collect();
        Self { mesh: Mesh::of_boxes(boxes), colour: GREY, occluders }
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The occluders, and their bounds.
    pub(super) fn occluders(&self) -> &[(Aabb, Occluder)] {
        &self.occluders
    }
}
