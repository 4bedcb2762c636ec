//! What a case is, and the shapes that cases are built from.

use std::sync::Arc;

use glam::{Affine3A, DVec3, Mat4, Quat, Vec3, camera::rh::view::look_to_mat4};

pub(super) use crate::experiments::ASPECT;
use casca_scenes::random::Dice;
use casca_scenes::world::{BOX_TRIANGLES, Camera, FRAME_SECONDS, Mesh, Motion, Object, Shape, box_corners};

/// A point of an object that the case was built to show; judged beside the points that the oracle
/// picks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    pub(super) object: usize,
    pub(super) point: DVec3,
}

/// A frame of a case.
pub(super) struct Shot {
    pub(super) camera: Camera,
    /// Objects that have another shape than in the shot before, ascending.
    pub(super) moves: Vec<(usize, Shape)>,
    /// The clock in seconds.
    pub(super) time: f64,
}

/// A small world and the frames seen of it.
pub(super) struct Case {
    pub(super) name: String,
    pub(super) objects: Vec<Object>,
    pub(super) cell: f32,
    pub(super) shots: Vec<Shot>,
    /// Count in the frames in which they are in the frustum.
    pub(super) known: Vec<Known>,
    /// Whether moving objects are reported only while they are seen, and when their volumes expire.
    pub(super) unreported: bool,
}

impl Case {
    /// A case at the usual settings.
    pub(super) fn new(name: impl Into<String>, objects: Vec<Object>, cell: f32, shots: Vec<Shot>) -> Self {
        Self { name: name.into(), objects, cell, shots, known: Vec::new(), unreported: false }
    }

    /// With points to look at.
    pub(super) fn with_known(mut self, known: Vec<Known>) -> Self {
        self.known = known;
        self
    }
}

/// Shots of a world that stands still.
pub(super) fn still(cameras: impl IntoIterator<Item = Camera>) -> Vec<Shot> {
    let shot = |(i, camera)| Shot { camera, moves: Vec::new(), time: i as f64 * FRAME_SECONDS };
    cameras.into_iter().enumerate().map(shot).collect()
}

/// The random numbers of a case.
pub(super) fn dice(seed: u64, case: u64) -> Dice {
    Dice::new(seed, case.wrapping_mul(0x2545_f491))
}

/// A static occluder that is tested.
pub(super) fn solid(name: &str, shape: Shape) -> Object {
    Object { name: name.to_owned(), shape, motion: Motion::Static, occludes: true, tested: true }
}

/// A static object that hides nothing.
pub(super) fn glass(name: &str, shape: Shape) -> Object {
    Object { occludes: false, ..solid(name, shape) }
}

/// A sphere.
pub(super) fn sphere(center: Vec3, radius: f32) -> Shape {
    Shape::Sphere { center, radius }
}

/// A box between two opposite corners.
pub(super) fn block(a: Vec3, b: Vec3) -> Shape {
    Shape::Box { min: a.min(b), max: a.max(b) }
}

/// A mesh in world space.
pub(super) fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Shape {
    Shape::Mesh {
        mesh: Arc::new(Mesh { positions, triangles, ..Mesh::default() }),
        transform: Affine3A::IDENTITY,
    }
}

/// A flat quadrilateral, its corners in order around it.
pub(super) fn quad(corners: [Vec3; 4]) -> Shape {
    mesh(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

/// The closed surface of a solid with eight corners, by bits: 1 the greater x, 2 the greater y, 4
/// the greater z.
pub(super) fn hexahedron(corners: [Vec3; 8]) -> Shape {
    mesh(corners.to_vec(), BOX_TRIANGLES.to_vec())
}

/// A box as the mesh of its twelve triangles.
pub(super) fn box_mesh(min: Vec3, max: Vec3) -> Shape {
    hexahedron(box_corners(min, max))
}

/// A camera moved to `eye` and turned by `turn`; its projection stays.
pub(super) fn placed(camera: &Camera, eye: Vec3, turn: Quat) -> Camera {
    let (up, back) = (camera.view.row(1).truncate(), camera.view.row(2).truncate());
    let view = look_to_mat4(eye, (turn * -back).normalize(), (turn * up).normalize());
    Camera { eye, view, projection: camera.projection }
}

/// A camera with another projection.
pub(super) fn through(camera: &Camera, projection: Mat4) -> Camera {
    Camera { projection, ..*camera }
}

/// A power of ten in few letters.
pub(super) fn plain(v: f32) -> String {
    if v == 0.0 { "0".to_owned() } else { format!("{v:.0e}") }
}
