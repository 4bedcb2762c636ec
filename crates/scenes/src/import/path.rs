//! The motion that a file gives: objects, the camera, and the walk where it has no camera.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::camera::rh::{proj::directx, view::look_to_mat4};
use glam::{Affine3A, Vec3};

use super::error::Trouble;
use super::nodes::Nodes;
use crate::numeric::{NEAR_PLANES, NEAR_SHARE};
use crate::world::{Animation, Camera, FRAME_SECONDS, Mesh, Motion, Object, Shape, box_corners};

#[derive(Debug, Clone)]
pub(super) struct FileCamera {
    pub(super) node: usize,
    fov_y: f32,
    near: f32,
    far: Option<f32>,
}

/// The first perspective camera that moves, else the first.
pub(super) fn camera_of(document: &gltf::Document, nodes: &Nodes, moves: &[bool]) -> Option<FileCamera> {
    let cameras: Vec<FileCamera> = nodes
        .0
        .iter()
        .enumerate()
        .filter_map(|(node, item)| {
            let camera = document.nodes().nth(item.index)?.camera()?;
            let gltf::camera::Projection::Perspective(p) = camera.projection() else { return None };
            let sound = p.yfov() > 0.0 && p.yfov() < 3.1 && p.znear() > 0.0 && p.znear().is_finite();
            let far = p.zfar().filter(|&far| far.is_finite() && far > p.znear());
            sound.then_some(FileCamera { node, fov_y: p.yfov(), near: p.znear(), far })
        })
        .collect();
    cameras.iter().find(|c| moves[c.node]).or(cameras.first()).cloned()
}

/// The walk through a file without a camera: a circle, looking ahead.
#[derive(Debug, Clone, Copy, Default)]
struct Walk {
    center: Vec3,
    radius: f32,
    near: f32,
}

impl Walk {
    /// The walk inside a box. A side that is flat, shorter than a hundredth of the longest, counts
    /// as a tenth of that: nothing can be seen from within a floor or a wall.
    fn inside(min: Vec3, max: Vec3) -> Self {
        let size = max - min;
        let longest = size.max_element();
        let room = |side: f32| if side < longest * 0.01 { longest * 0.1 } else { side };
        let mut center = min + size * 0.5;
        // One stands on a floor, not half in it.
        center.y = min.y + room(size.y) * 0.5;
        let radius = 0.35 * room(size.x).min(room(size.z));
        Self { center, radius, near: (longest * NEAR_SHARE).clamp(NEAR_PLANES[0], NEAR_PLANES[1]) }
    }

    /// The camera after a part of the walk.
    fn camera(&self, part: f32, aspect: f32) -> Camera {
        let (sin, cos) = (part * TAU).sin_cos();
        let eye = self.center + Vec3::new(cos, 0.0, sin) * self.radius;
        Camera {
            eye,
            view: look_to_mat4(eye, Vec3::new(-sin, 0.0, cos), Vec3::Y),
            projection: directx::perspective_infinite(1.0, aspect, self.near),
        }
    }
}

/// An object that moves with its node.
#[derive(Debug)]
pub(super) struct Moving {
    pub(super) object: usize,
    pub(super) node: usize,
    /// Where it is, seen from its node.
    pub(super) place: Affine3A,
    pub(super) mesh: Arc<Mesh>,
}

/// The motion that a file gives.
#[derive(Debug)]
pub(super) struct FilePath {
    nodes: Nodes,
    /// The nodes that something moves with, and those that they hang from: before a node its
    /// parent, whose place in this list it has.
    links: Vec<(usize, Option<usize>)>,
    /// By moving object: the place of its node in that list.
    link_of: Vec<usize>,
    /// By node.
    moving: Vec<Moving>,
    camera: Option<FileCamera>,
    /// The walk where the file has no camera.
    walk: Walk,
    frames: usize,
}

pub(super) fn time_of(frame: usize) -> f32 {
    (frame as f64 * FRAME_SECONDS) as f32
}

/// The box of a transformed mesh; `None` if a part of it is not finite.
fn bounds_of(mesh: &Mesh, transform: &Affine3A) -> Option<(Vec3, Vec3)> {
    let mut bounds = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for &position in &mesh.positions {
        let p = transform.transform_point3(position);
        if !p.is_finite() {
            return None;
        }
        bounds = (bounds.0.min(p), bounds.1.max(p));
    }
    Some(bounds)
}

/// How an object went until now.
struct Way {
    /// Corners of the box of its mesh.
    corners: [Vec3; 8],
    last: Option<Affine3A>,
    /// The farthest that a point of it went from one frame to the next.
    farthest: f32,
}

impl Way {
    fn new(mesh: &Mesh) -> Self {
        let (min, max) = bounds_of(mesh, &Affine3A::IDENTITY).unwrap_or_default();
        Self { corners: box_corners(min, max), last: None, farthest: 0.0 }
    }

    /// The way of a point is linear in where it is on the mesh, so that none goes farther than a
    /// corner of the box; but for what is rounded when each is transformed.
    fn go(&mut self, transform: Affine3A) {
        if let Some(last) = self.last.replace(transform).filter(|last| *last != transform) {
            for corner in self.corners {
                let way = transform.transform_point3(corner) - last.transform_point3(corner);
                let rounded = 8.0 * f32::EPSILON * (reach(&transform, corner) + reach(&last, corner));
                self.farthest = self.farthest.max(way.length() + rounded);
            }
        }
    }
}

/// The largest number that transforming a point goes through.
fn reach(transform: &Affine3A, point: Vec3) -> f32 {
    let m = transform.matrix3;
    let sum =
        m.x_axis.abs() * point.x.abs() + m.y_axis.abs() * point.y.abs() + m.z_axis.abs() * point.z.abs();
    (sum + transform.translation.abs()).max_element()
}

impl FilePath {
    pub(super) fn new(nodes: Nodes, moving: Vec<Moving>, camera: Option<FileCamera>, frames: usize) -> Self {
        let mut needed = vec![false; nodes.0.len()];
        for moving in &moving {
            let mut at = Some(moving.node);
            while let Some(node) = at.filter(|&node| !std::mem::replace(&mut needed[node], true)) {
                at = nodes.0[node].parent;
            }
        }
        let mut place = vec![0; nodes.0.len()];
        let mut links = Vec::new();
        for (node, item) in nodes.0.iter().enumerate().filter(|(node, _)| needed[*node]) {
            place[node] = links.len();
            links.push((node, item.parent.map(|parent| place[parent])));
        }
        let link_of = moving.iter().map(|moving| place[moving.node]).collect();
        Self { nodes, links, link_of, moving, camera, walk: Walk::default(), frames }
    }

    /// Calls `each` for everything that moves, with where it is.
    fn transforms(&self, frame: usize, mut each: impl FnMut(usize, Affine3A)) {
        let time = time_of(frame);
        let mut globals: Vec<Affine3A> = Vec::with_capacity(self.links.len());
        for &(node, parent) in &self.links {
            let local = self.nodes.0[node].local(time);
            globals.push(parent.map_or(local, |parent| globals[parent] * local));
        }
        for (i, (moving, &link)) in self.moving.iter().zip(&self.link_of).enumerate() {
            each(i, globals[link] * moving.place);
        }
    }

    /// Goes through all frames: finds speeds and bounds, and refuses what is not finite.
    pub(super) fn settle(&mut self, objects: &mut [Object]) -> Result<(Vec3, Vec3), Trouble> {
        let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let mut lost: Option<(usize, usize)> = None;
        let mut grow = |object: usize, frame: usize, bounds: Option<(Vec3, Vec3)>| match bounds {
            Some((lo, hi)) => (min, max) = (min.min(lo), max.max(hi)),
            None => lost = lost.or(Some((object, frame))),
        };
        for (i, object) in objects.iter().enumerate() {
            match &object.shape {
                Shape::Mesh { mesh, transform } => grow(i, 0, bounds_of(mesh, transform)),
                Shape::Box { min, max } => grow(i, 0, Some((*min, *max))),
                Shape::Sphere { .. } => {}
            }
        }
        let mut ways: Vec<Way> = self.moving.iter().map(|m| Way::new(&m.mesh)).collect();
        for frame in 0..self.frames {
            self.transforms(frame, |i, transform| {
                let moving = &self.moving[i];
                grow(moving.object, frame, bounds_of(&moving.mesh, &transform));
                ways[i].go(transform);
            });
        }
        if let Some((object, frame)) = lost {
            let name = &objects[object].name;
            return Err(Trouble::NotFinite(format!("object {object} ({name:?}) in frame {frame}")));
        }
        for (moving, way) in self.moving.iter().zip(ways) {
            let object = &mut objects[moving.object];
            let max_speed = way.farthest / FRAME_SECONDS as f32 * 1.01;
            if !max_speed.is_finite() {
                return Err(Trouble::NotFinite(format!(
                    "the speed of object {} ({:?})",
                    moving.object, object.name
                )));
            }
            object.motion = Motion::Dynamic { max_speed };
        }
        self.walk = Walk::inside(min, max);
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
        self.transforms(frame, |i, transform| {
            let Moving { object, mesh, .. } = &self.moving[i];
            set(*object, Shape::Mesh { mesh: mesh.clone(), transform });
        });
    }

    fn camera(&self, frame: usize, aspect: f32) -> Camera {
        let Some(camera) = &self.camera else {
            return self.walk.camera(frame as f32 / self.frames.max(1) as f32, aspect);
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
