//! The motion that a file gives: objects, the camera, and the walk where it has no camera.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::camera::rh::{proj::directx, view::look_to_mat4};
use glam::{Affine3A, Vec3};

use super::Trouble;
use super::nodes::Nodes;
use crate::world::{Animation, Camera, FRAME_SECONDS, Mesh, Motion, Object, Shape};

#[derive(Debug, Clone)]
pub(super) struct FileCamera {
    pub(super) node: usize,
    pub(super) fov_y: f32,
    pub(super) near: f32,
    pub(super) far: Option<f32>,
}

pub(super) fn camera_of(document: &gltf::Document, nodes: &Nodes, order: &[usize]) -> Option<FileCamera> {
    let cameras: Vec<FileCamera> = order
        .iter()
        .enumerate()
        .filter_map(|(place, &index)| {
            let camera = document.nodes().nth(index)?.camera()?;
            let gltf::camera::Projection::Perspective(p) = camera.projection() else { return None };
            let sound = p.yfov() > 0.0 && p.yfov() < 3.1 && p.znear() > 0.0 && p.znear().is_finite();
            let far = p.zfar().filter(|&far| far.is_finite() && far > p.znear());
            sound.then_some(FileCamera { node: place, fov_y: p.yfov(), near: p.znear(), far })
        })
        .collect();
    cameras.iter().find(|c| nodes.moves(c.node)).or(cameras.first()).cloned()
}

pub(super) struct Moving {
    pub(super) object: usize,
    pub(super) node: usize,
    pub(super) mesh: Arc<Mesh>,
}

/// The motion that a file gives.
pub(super) struct FilePath {
    pub(super) nodes: Nodes,
    pub(super) moving: Vec<Moving>,
    pub(super) camera: Option<FileCamera>,
    /// Centre and radius of the path where the file gives none.
    pub(super) orbit: (Vec3, f32),
    pub(super) frames: usize,
}

pub(super) fn time_of(frame: usize) -> f32 {
    (frame as f64 * FRAME_SECONDS) as f32
}

pub(super) fn bounds_of(mesh: &Mesh, transform: &Affine3A) -> (Vec3, Vec3) {
    let corners = mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize]);
    corners
        .map(|p| transform.transform_point3(p))
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)))
}

impl FilePath {
    /// Goes through all frames: finds speeds and bounds, and refuses what is not finite.
    pub(super) fn settle(&mut self, objects: &mut [Object]) -> Result<(Vec3, Vec3), Trouble> {
        let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let mut grow = |lo: Vec3, hi: Vec3| {
            (min, max) = (min.min(lo), max.max(hi));
            lo.is_finite() && hi.is_finite()
        };
        for (i, object) in objects.iter().enumerate() {
            let Shape::Mesh { mesh, transform } = &object.shape else { continue };
            let (lo, hi) = bounds_of(mesh, transform);
            if !grow(lo, hi) {
                return Err(Trouble::NotFinite(format!("object {i} in world space")));
            }
        }
        for moving in &self.moving {
            let rest = bounds_of(&moving.mesh, &Affine3A::IDENTITY);
            let corner = |i: usize| {
                let pick = |bit: usize, axis: usize| {
                    if i >> bit & 1 == 0 { rest.0[axis] } else { rest.1[axis] }
                };
                Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
            };
            let mut last: Option<Affine3A> = None;
            let mut farthest = 0f32;
            for frame in 0..self.frames {
                let transform = self.nodes.global(moving.node, time_of(frame));
                let (lo, hi) = bounds_of(&moving.mesh, &transform);
                if !grow(lo, hi) {
                    return Err(Trouble::NotFinite(format!("object {} in frame {frame}", moving.object)));
                }
                if let Some(last) = last {
                    for i in 0..8 {
                        let way = transform.transform_point3(corner(i)) - last.transform_point3(corner(i));
                        farthest = farthest.max(way.length());
                    }
                }
                last = Some(transform);
            }
            let max_speed = farthest / FRAME_SECONDS as f32 * 1.01;
            objects[moving.object].motion = Motion::Dynamic { max_speed };
        }
        self.orbit = ((min + max) * 0.5, 0.35 * (max - min).x.min((max - min).z));
        for frame in 0..self.frames {
            let camera = self.camera(frame, 1.0);
            if !(camera.eye.is_finite() && camera.view.is_finite()) {
                return Err(Trouble::NotFinite(format!("the camera in frame {frame}")));
            }
            (min, max) = (min.min(camera.eye), max.max(camera.eye));
        }
        Ok((min, max))
    }
}

impl Animation for FilePath {
    fn shapes(&self, frame: usize, set: &mut dyn FnMut(usize, Shape)) {
        for moving in &self.moving {
            let transform = self.nodes.global(moving.node, time_of(frame));
            set(moving.object, Shape::Mesh { mesh: moving.mesh.clone(), transform });
        }
    }

    fn camera(&self, frame: usize, aspect: f32) -> Camera {
        let Some(camera) = &self.camera else {
            let angle = frame as f32 / self.frames.max(1) as f32 * TAU;
            let (sin, cos) = angle.sin_cos();
            let eye = self.orbit.0 + Vec3::new(cos, 0.0, sin) * self.orbit.1;
            let forward = Vec3::new(-sin, 0.0, cos);
            return Camera {
                eye,
                view: look_to_mat4(eye, forward, Vec3::Y),
                projection: directx::perspective_infinite(1.0, aspect, 0.05),
            };
        };
        let pose = self.nodes.global(camera.node, time_of(frame));
        let eye = Vec3::from(pose.translation);
        let forward = pose.transform_vector3(Vec3::NEG_Z).normalize_or(Vec3::NEG_Z);
        let up = pose.transform_vector3(Vec3::Y).normalize_or(Vec3::Y);
        let projection = match camera.far {
            Some(far) => directx::perspective(camera.fov_y, aspect, camera.near, far),
            None => directx::perspective_infinite(camera.fov_y, aspect, camera.near),
        };
        Camera { eye, view: look_to_mat4(eye, forward, up), projection }
    }
}
