//! The motion that a file gives: objects, the camera, and the walk where it has no camera.

use std::collections::HashMap;
use std::f32::consts::TAU;
use std::sync::Arc;

use glam::camera::rh::{proj::directx, view::look_to_mat4};
use glam::{Affine3A, DAffine3, DVec3, Vec3};

use super::error::Trouble;
use super::nodes::Nodes;
use super::warnings::{Warnings, node_name};
use crate::numeric::{NEAR_PLANES, NEAR_SHARE};
use crate::world::{
    Animation, Bounds, Camera, FRAME_SECONDS, Mesh, Motion, Object, Shape, around, box_corners,
};

/// What the motion of a file may cost, in points that are transformed; the evaluation of a node
/// counts as [`STEPS_OF_A_NODE`]. That is half a second at most.
const FREE_STEPS: usize = 1 << 25;
/// The same, in addition, for each byte of the buffers.
const STEPS_OF_A_BYTE: usize = 64;
const STEPS_OF_A_NODE: usize = 16;
/// The corners of a box.
const CORNERS: usize = 8;

#[derive(Debug, Clone)]
pub(super) struct FileCamera {
    pub(super) node: usize,
    fov_y: f32,
    near: f32,
    far: Option<f32>,
}

/// The first perspective camera that moves, else the first. Others are named if there is none.
pub(super) fn camera_of(
    document: &gltf::Document,
    nodes: &Nodes,
    moves: &[bool],
    warnings: &Warnings,
) -> Option<FileCamera> {
    let (mut cameras, mut others) = (Vec::new(), Vec::new());
    for (node, item) in nodes.0.iter().enumerate() {
        let Some(of) = document.nodes().nth(item.index) else { continue };
        let Some(camera) = of.camera() else { continue };
        let gltf::camera::Projection::Perspective(p) = camera.projection() else {
            others
                .push((of, "has an orthographic camera, which is not used: the path is a walk in a circle"));
            continue;
        };
        let sound = p.yfov() > 0.0 && p.yfov() < 3.1 && p.znear() > 0.0 && p.znear().is_finite();
        let far = p.zfar().filter(|&far| far.is_finite() && far > p.znear());
        match sound {
            true => cameras.push(FileCamera { node, fov_y: p.yfov(), near: p.znear(), far }),
            false => others.push((of, "has a camera without an angle or a near plane, which is not used")),
        }
    }
    if cameras.is_empty() {
        others.iter().for_each(|(node, what)| warnings.add(node_name(node), what));
    }
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
    pub(super) place: DAffine3,
    pub(super) mesh: Arc<Mesh>,
}

/// The motion that a file gives.
#[derive(Debug)]
pub(super) struct FilePath {
    nodes: Nodes,
    /// The nodes that something moves with, and those that they hang from: before a node its
    /// parent, whose place in this list it has. Those that do not move by themselves have a place.
    links: Vec<(usize, Option<usize>, Option<DAffine3>)>,
    /// By moving object: the place of its node in that list.
    link_of: Vec<usize>,
    moving: Vec<Moving>,
    /// What is taken from all positions.
    origin: DVec3,
    camera: Option<FileCamera>,
    /// The walk where the file has no camera.
    walk: Walk,
    /// How long the path is.
    pub(super) frames: usize,
}

pub(super) fn time_of(frame: usize) -> f32 {
    (frame as f64 * FRAME_SECONDS) as f32
}

/// The box of transformed points; `None` if one of them is not finite.
fn bounds_of(points: &[Vec3], transform: &Affine3A) -> Option<Bounds> {
    let bounds = around(points.iter().map(|&p| transform.transform_point3(p)));
    Some(bounds).filter(|(low, high)| low.is_finite() && high.is_finite())
}

/// The boxes of meshes that objects share, each found once.
#[derive(Default)]
struct Boxes(HashMap<*const Mesh, [Vec3; 8]>);

impl Boxes {
    fn of(&mut self, mesh: &Arc<Mesh>) -> [Vec3; 8] {
        *self.0.entry(Arc::as_ptr(mesh)).or_insert_with(|| {
            let (min, max) = mesh.bounds(&Affine3A::IDENTITY);
            box_corners(min, max)
        })
    }
}

/// How objects went until now: one, or all of a node.
struct Way {
    /// The place of the node in the list of links.
    link: usize,
    /// Where the corners are, seen from the node.
    place: DAffine3,
    corners: [Vec3; 8],
    /// The mesh of one object, for a box that is not larger than it must be.
    mesh: Option<Arc<Mesh>>,
    /// By place in the list of what moves.
    objects: Vec<usize>,
    last: Option<Affine3A>,
    /// The farthest that a point of it went from one frame to the next.
    farthest: f32,
}

impl Way {
    /// The box of all that it has, at a place of its corners.
    fn bounds(&self, at: &Affine3A) -> Option<(Vec3, Vec3)> {
        let points = self.mesh.as_ref().map_or(&self.corners[..], |mesh| &mesh.positions);
        bounds_of(points, at)
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
    pub(super) fn new(
        nodes: Nodes,
        moving: Vec<Moving>,
        camera: Option<FileCamera>,
        frames: usize,
        origin: DVec3,
    ) -> Self {
        let mut needed = vec![false; nodes.0.len()];
        for moving in &moving {
            let new = nodes.way(moving.node).take_while(|&node| !std::mem::replace(&mut needed[node], true));
            new.for_each(drop);
        }
        let mut place = vec![0; nodes.0.len()];
        let mut links = Vec::new();
        for (node, item) in nodes.0.iter().enumerate().filter(|(node, _)| needed[*node]) {
            place[node] = links.len();
            let fixed = (!item.moves).then(|| item.local(0.0));
            links.push((node, item.parent.map(|parent| place[parent]), fixed));
        }
        let link_of = moving.iter().map(|moving| place[moving.node]).collect();
        Self { nodes, links, link_of, moving, camera, walk: Walk::default(), frames, origin }
    }

    /// Where the nodes are that something moves with.
    fn globals(&self, frame: usize) -> Vec<DAffine3> {
        let time = time_of(frame);
        let mut globals: Vec<DAffine3> = Vec::with_capacity(self.links.len());
        for &(node, parent, fixed) in &self.links {
            let local = fixed.unwrap_or_else(|| self.nodes.0[node].local(time));
            globals.push(parent.map_or(local, |parent| globals[parent] * local));
        }
        globals
    }

    /// A place in single precision, from the origin of the scene.
    fn seen(&self, mut place: DAffine3) -> Affine3A {
        place.translation -= self.origin;
        place.as_affine3a()
    }

    /// What moves: one by one, or all of a node together, which costs less and bounds less closely.
    fn ways(&self, boxes: &mut Boxes, together: bool) -> Vec<Way> {
        let mut ways: Vec<Way> = Vec::new();
        let all = self.moving.iter().zip(&self.link_of).enumerate();
        for (i, (Moving { place, mesh, .. }, &link)) in all {
            let own = boxes.of(mesh);
            // Objects of a node follow each other.
            if let Some(way) = ways.last_mut().filter(|way| together && way.link == link) {
                let corners = own.map(|corner| place.transform_point3(corner.as_dvec3()).as_vec3());
                let (min, max) = around(corners.into_iter().chain(way.corners));
                way.corners = box_corners(min, max);
                way.objects.push(i);
                continue;
            }
            let (mut place, mut corners, mut mesh) = (*place, own, Some(mesh.clone()));
            if together {
                corners = corners.map(|corner| place.transform_point3(corner.as_dvec3()).as_vec3());
                (place, mesh) = (DAffine3::IDENTITY, None);
            }
            ways.push(Way { link, place, corners, mesh, objects: vec![i], last: None, farthest: 0.0 });
        }
        ways
    }

    /// Goes through all frames: finds speeds and bounds, and refuses what is not finite. What costs
    /// more than a file of that size may is bounded less closely, and then in fewer frames.
    pub(super) fn settle(
        &mut self,
        objects: &mut [Object],
        bytes: usize,
        warnings: &Warnings,
    ) -> Result<(Vec3, Vec3), Trouble> {
        let most = bytes.saturating_mul(STEPS_OF_A_BYTE).saturating_add(FREE_STEPS);
        let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let mut lost: Option<(usize, usize)> = None;
        let mut grow = |object: usize, frame: usize, bounds: Option<(Vec3, Vec3)>| match bounds {
            Some((lo, hi)) => (min, max) = (min.min(lo), max.max(hi)),
            None => lost = lost.or(Some((object, frame))),
        };
        let mut boxes = Boxes::default();
        let points = |mesh: &Mesh| mesh.positions.len() + CORNERS;
        let sum = |all: &mut dyn Iterator<Item = usize>| all.fold(0, usize::saturating_add);
        let shapes = |o: &Object| if let Shape::Mesh { mesh, .. } = &o.shape { points(mesh) } else { 0 };
        let closely = sum(&mut objects.iter().map(shapes)) <= most;
        for (i, object) in objects.iter().enumerate() {
            match &object.shape {
                Shape::Mesh { mesh, transform } => {
                    let corners = boxes.of(mesh);
                    grow(i, 0, bounds_of(if closely { &mesh.positions } else { &corners }, transform));
                }
                Shape::Box { min, max } => grow(i, 0, Some((*min, *max))),
                Shape::Sphere { .. } => {}
            }
        }
        let depth = self.camera.as_ref().map_or(0, |camera| self.nodes.way(camera.node).count());
        let nodes = (self.links.len() + depth).saturating_mul(STEPS_OF_A_NODE);
        let step = sum(&mut self.moving.iter().map(|moving| points(&moving.mesh))).saturating_add(nodes);
        let together = step.saturating_mul(self.frames) > most;
        let mut ways = self.ways(&mut boxes, together);
        if together {
            let fit = most / (nodes + ways.len() * CORNERS).max(1);
            if fit < self.frames {
                let what = format!("are too many for what moves; the path has {} instead", fit.max(1));
                warnings.add(format!("{} frames", self.frames), &what);
                self.frames = fit.max(1);
            }
        }
        for frame in 0..self.frames {
            let globals = self.globals(frame);
            for way in &mut ways {
                let transform = self.seen(globals[way.link] * way.place);
                grow(self.moving[way.objects[0]].object, frame, way.bounds(&transform));
                way.go(transform);
            }
        }
        if let Some((object, frame)) = lost {
            let name = &objects[object].name;
            return Err(Trouble::NotFinite(format!("object {object} ({name:?}) in frame {frame}")));
        }
        self.promise(&ways, objects)?;
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

    /// Gives what moves its greatest speed.
    fn promise(&self, ways: &[Way], objects: &mut [Object]) -> Result<(), Trouble> {
        for way in ways {
            let max_speed = way.farthest / FRAME_SECONDS as f32 * 1.01;
            for &i in &way.objects {
                let number = self.moving[i].object;
                let object = &mut objects[number];
                if !max_speed.is_finite() {
                    let name = &object.name;
                    return Err(Trouble::NotFinite(format!("the speed of object {number} ({name:?})")));
                }
                object.motion = Motion::Dynamic { max_speed };
            }
        }
        Ok(())
    }
}

impl Animation for FilePath {
    fn shapes(&self, frame: usize, set: &mut dyn FnMut(usize, Shape)) {
        let globals = self.globals(frame);
        for (Moving { object, place, mesh, .. }, &link) in self.moving.iter().zip(&self.link_of) {
            let transform = self.seen(globals[link] * *place);
            set(*object, Shape::Mesh { mesh: mesh.clone(), transform });
        }
    }

    fn camera(&self, frame: usize, aspect: f32) -> Camera {
        let Some(camera) = &self.camera else {
            return self.walk.camera(frame as f32 / self.frames.max(1) as f32, aspect);
        };
        let pose = self.seen(self.nodes.global(camera.node, time_of(frame)));
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
