//! What the tests share: small scenes, views, and random numbers. Nothing here knows how the
//! library works.

// Each test uses a part of it.
#![allow(dead_code, unused_imports)]

pub mod objects;
pub mod worlds;

pub use std::collections::BTreeSet;
pub use std::sync::Arc;

pub use casca::*;
use casca_scenes::drive::Driver;
use casca_scenes::world::{FRAME_SECONDS, Mesh};
pub use casca_truth::cases;
pub use casca_truth::places::{coordinate, points};
pub use glam::camera::rh::{proj::directx, view::look_to_mat4};
pub use glam::{
    Affine3A, DAffine3, DMat4, DQuat, DVec3, DVec4, EulerRot, IVec3, Mat3, Mat4, Quat, UVec3, Vec3,
};
pub use proptest::prelude::*;

/// An empty scene with cells of one unit.
pub fn empty() -> Scene {
    Scene::new(1.0).unwrap()
}

/// What tests insert again and again.
pub trait Insert {
    /// A fixed object.
    fn fixed(&mut self, bounds: impl Into<Bounds>) -> ObjectId;
    /// A fixed object that hides what is behind it.
    fn solid<S: Clone + Into<Bounds> + Into<Occluder>>(&mut self, shape: S) -> ObjectId;
}

impl Insert for Scene {
    fn fixed(&mut self, bounds: impl Into<Bounds>) -> ObjectId {
        self.insert(ObjectDesc::fixed(bounds)).unwrap()
    }

    fn solid<S: Clone + Into<Bounds> + Into<Occluder>>(&mut self, shape: S) -> ObjectId {
        self.insert(ObjectDesc::fixed(shape.clone()).occluder(shape)).unwrap()
    }
}

pub fn query_by(method: Method) -> Query {
    Query::with_method(method).unwrap()
}

/// Runs a query, and ends the frame with its result.
pub fn look(scene: &mut Scene, query: &mut Query, view: &View) -> FrameReport {
    query.run(scene, view);
    scene.end_frame([query.pvs()]).unwrap()
}

/// Ends a frame in which nobody sees anything: what may be hidden goes into volumes.
pub fn look_away(scene: &mut Scene) -> FrameReport {
    let nothing = Plane { normal: Vec3::X, offset: -1e6 };
    look(scene, &mut Query::new(), &View::from_planes(Vec3::ONE, &[nothing]).unwrap())
}

/// A scene in the library, in the grid that it asks for.
pub fn driver(world: &casca_scenes::world::World) -> Driver {
    Driver::new(world, world.grid.cell, |_| ()).unwrap()
}

/// Goes to a frame; what moved.
pub fn go_to(driver: &mut Driver, world: &mut casca_scenes::world::World, frame: usize) -> Vec<usize> {
    let moved = world.set_frame(frame);
    driver.scene.begin_frame(frame as f64 * FRAME_SECONDS).unwrap();
    driver.update(&world.objects, &moved).unwrap();
    moved
}

/// The view of an eye that looks all round.
pub fn around(eye: Vec3) -> View {
    View::omnidirectional(eye).unwrap()
}

/// The matrix of a camera: its field of view and aspect, and the distances of its planes.
pub fn lens(eye: Vec3, forward: Vec3, [fov, aspect, near, far]: [f32; 4]) -> Mat4 {
    let up = if forward.y.abs() > 0.9 { Vec3::Z } else { Vec3::Y };
    directx::perspective(fov, aspect, near, far) * look_to_mat4(eye, forward, up)
}

/// The view of such a camera.
pub fn looking(eye: Vec3, forward: Vec3, numbers: [f32; 4]) -> View {
    View::perspective(eye, lens(eye, forward, numbers)).unwrap()
}

/// A mesh that hides, as casca prepares it by itself.
pub fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Arc<TriMesh> {
    Arc::new(TriMesh::new(positions, triangles).unwrap())
}

/// A sheet of `m` times `k` squares, each of two triangles; its corners by their numbers.
pub fn sheet(m: u32, k: u32, at: impl FnMut(u32, u32) -> Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let Mesh { positions, triangles, .. } = Mesh::sheet(m, k, at);
    (positions, triangles)
}

/// The objects of a result, in the order of their ids.
pub fn sorted(pvs: &Pvs) -> Vec<ObjectId> {
    let mut ids = pvs.visible().to_vec();
    ids.sort_unstable();
    ids
}

/// Vectors of which half of the coordinates are whole numbers above the start of the range.
pub fn vector(range: std::ops::Range<f32>) -> impl Strategy<Value = Vec3> + Clone {
    points(range, 1.0)
}

/// Any direction.
pub fn direction() -> impl Strategy<Value = Vec3> + Clone {
    vector(-1.0..1.0).prop_map(|d| d.normalize_or(Vec3::X))
}

pub fn rotation() -> impl Strategy<Value = Quat> + Clone {
    (direction(), 0.0..std::f32::consts::TAU).prop_map(|(axis, angle)| Quat::from_axis_angle(axis, angle))
}

/// Random numbers from a seed, the same in every run.
#[derive(Debug, Clone)]
pub struct Random(pub u64);

impl Random {
    fn step(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0
    }

    /// A number from 0 to less than 1, as all of these are.
    pub fn next(&mut self) -> f64 {
        (self.step() >> 33) as f64 / (1u64 << 31) as f64
    }

    /// The same in single precision.
    pub fn unit(&mut self) -> f32 {
        (self.step() >> 40) as f32 / (1u64 << 24) as f32
    }

    pub fn within(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.next()
    }

    pub fn vector(&mut self, lo: f64, hi: f64) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| self.within(lo, hi)))
    }

    pub fn between(&mut self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.unit()
    }

    pub fn below(&mut self, n: usize) -> usize {
        ((self.next() * n as f64) as usize).min(n - 1)
    }

    /// A number whose decimal logarithm lies in a range.
    pub fn power(&mut self, lo: f64, hi: f64) -> f64 {
        10f64.powf(self.within(lo, hi))
    }

    pub fn chance(&mut self, share: f64) -> bool {
        self.next() < share
    }

    /// A place in a cube. Half of its coordinates are multiples of a step above the least.
    pub fn place(&mut self, lo: f32, hi: f32, step: f32) -> Vec3 {
        Vec3::from_array([(); 3].map(|()| coordinate(self.unit().into(), lo..hi, step)))
    }

    /// The same in double precision, with a lattice of eight steps.
    pub fn point(&mut self, lo: f64, hi: f64) -> DVec3 {
        let (range, step) = (lo as f32..hi as f32, (hi - lo) as f32 / 8.0);
        DVec3::from_array([(); 3].map(|()| coordinate(self.next(), range.clone(), step).into()))
    }

    /// A direction, often along an axis or between two.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let d = DVec3::from_array([(); 3].map(|()| coordinate(self.next(), -1.0..1.0, 0.5).into()));
            if (0.01..=1.0).contains(&d.length_squared()) {
                return d.normalize();
            }
        }
    }
}
