//! Test scenes written as glTF 2.0 files, which [`crate::import`] reads back.
//!
//! What hides is said by materials: see-through ones blend, and what hides from both sides is
//! double sided. Each object is a node: a box is scaled from one unit cube, a sphere is a ball of
//! 320 triangles. The positions of moving objects and of the camera are stored for every frame of
//! the path.

#[cfg(test)]
mod tests;

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Mat4, Quat, Vec3};
use gltf::binary::{Glb, Header};
use serde_json::{Value, json};

use crate::world::{Camera, FRAME_SECONDS, Mesh, Motion, Object, Shape, Sides, World};
use casca_tools::command_line::PathError;

/// How often the triangles of a ball are cut.
const CUTS: u32 = 2;

/// Why a scene cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// A moving mesh is not written, because its transform may be none that glTF can animate.
    #[error("object {0} is a mesh that moves, which is not written")]
    MovingMesh(usize),
    /// The scene is too large for the format.
    #[error("the scene does not fit into a file of 4 GB")]
    TooLarge,
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] PathError),
}

/// Writes a scene to a file (.glb).
///
/// # Errors
/// As [`glb`], and if the file cannot be written.
pub fn save(world: &mut World, path: &Path) -> Result<(), ExportError> {
    let bytes = glb(world)?;
    Ok(std::fs::write(path, bytes).map_err(PathError::write(path))?)
}

/// The bytes of a scene as a .glb file.
///
/// # Errors
/// The scene has a mesh that moves, or is too large.
pub fn glb(world: &mut World) -> Result<Vec<u8>, ExportError> {
    let paths = Paths::of(world);
    world.set_frame(0);
    let mut writer = Writer::new(world.frames);
    for (i, object) in world.objects.iter().enumerate() {
        writer.object(i, object)?;
        if let Some(positions) = paths.objects.get(&i) {
            writer.animate("translation", "VEC3", positions);
        }
    }
    writer.camera(&world.camera(0, 1.0));
    writer.animate("translation", "VEC3", &paths.eyes);
    writer.animate("rotation", "VEC4", &paths.turns);
    writer.finish(&world.name, world.source.origin)
}

/// The positions of everything that moves, frame by frame.
#[derive(Default)]
struct Paths {
    objects: HashMap<usize, Vec<f32>>,
    eyes: Vec<f32>,
    turns: Vec<f32>,
}

impl Paths {
    fn of(world: &mut World) -> Self {
        let mut paths = Self::default();
        let dynamic = |object: &Object| object.motion != Motion::Static;
        let dynamic: Vec<usize> = (0..world.objects.len()).filter(|&i| dynamic(&world.objects[i])).collect();
        for frame in 0..world.frames {
            world.set_frame(frame);
            for &i in &dynamic {
                let at = origin(&world.objects[i].shape);
                paths.objects.entry(i).or_default().extend(at.to_array());
            }
            let camera = world.camera(frame, 1.0);
            paths.eyes.extend(camera.eye.to_array());
            paths.turns.extend(turn(&camera).to_array());
        }
        paths
    }
}

/// The translation of the node of a shape.
fn origin(shape: &Shape) -> Vec3 {
    match shape {
        Shape::Sphere { center, .. } => *center,
        Shape::Box { min, .. } => *min,
        Shape::Mesh { transform, .. } => Vec3::from(transform.translation),
    }
}

/// The rotation of a camera, which looks along -z.
fn turn(camera: &Camera) -> Quat {
    Quat::from_mat4(&camera.view).conjugate().normalize()
}

/// The component types of accessors.
const U32: u32 = 5125;
const F32: u32 = 5126;

/// A file in the making: the lists of its document, and its bytes.
#[derive(Default)]
struct Writer {
    accessors: Vec<Value>,
    views: Vec<Value>,
    nodes: Vec<Value>,
    materials: Vec<Value>,
    made: Vec<Value>,
    channels: Vec<Value>,
    samplers: Vec<Value>,
    lens: Value,
    bytes: Vec<u8>,
    /// The accessor of the times of all frames.
    times: usize,
    cube: Arc<Mesh>,
    ball: Arc<Mesh>,
    /// Meshes that are written, by their address.
    meshes: HashMap<*const Mesh, usize>,
}

/// Adds an item to a list; returns its number.
fn push(list: &mut Vec<Value>, item: Value) -> usize {
    list.push(item);
    list.len() - 1
}

impl Writer {
    fn new(frames: usize) -> Self {
        let cube = Arc::new(Mesh::cuboid(Vec3::ZERO, Vec3::ONE));
        let mut writer = Self { cube, ball: Arc::new(Mesh::ball(CUTS)), ..Self::default() };
        let times: Vec<f32> = (0..frames).map(|frame| (frame as f64 * FRAME_SECONDS) as f32).collect();
        writer.times = writer.floats("SCALAR", &times);
        writer
    }

    /// Adds the node of an object.
    fn object(&mut self, index: usize, object: &Object) -> Result<(), ExportError> {
        let mut node = json!({ "name": object.name });
        let role = match (object.occludes, object.tested) {
            (true, true) => None,
            (true, false) => Some("occluder"),
            (false, _) => Some("occludee"),
        };
        if let Some(role) = role {
            node["extras"] = json!({ "role": role });
        }
        let origin = origin(&object.shape).to_array();
        let mesh = match &object.shape {
            Shape::Sphere { radius, .. } => {
                (node["translation"], node["scale"]) =
                    (json!(origin), json!(Vec3::splat(*radius).to_array()));
                self.ball.clone()
            }
            Shape::Box { min, max } => {
                (node["translation"], node["scale"]) = (json!(origin), json!((*max - *min).to_array()));
                self.cube.clone()
            }
            Shape::Mesh { .. } if object.motion != Motion::Static => {
                return Err(ExportError::MovingMesh(index));
            }
            Shape::Mesh { mesh, transform } => {
                node["matrix"] = json!(Mat4::from(*transform).to_cols_array());
                mesh.clone()
            }
        };
        node["mesh"] = json!(self.mesh(&mesh));
        self.nodes.push(node);
        Ok(())
    }

    /// A mesh, which is written when it is first asked for.
    fn mesh(&mut self, mesh: &Arc<Mesh>) -> usize {
        let key = Arc::as_ptr(mesh);
        if let Some(known) = self.meshes.get(&key) {
            return *known;
        }
        let positions: Vec<f32> = mesh.positions.iter().flat_map(|p| p.to_array()).collect();
        let positions = self.floats("VEC3", &positions);
        // What hides alike is one primitive.
        let mut primitives = Vec::new();
        for sides in [Sides::Both, Sides::Front, Sides::Neither] {
            let triangles = (0..mesh.triangles.len()).filter(|&i| mesh.sides_of(i) == sides);
            let corners: Vec<u32> = triangles.flat_map(|i| mesh.triangles[i]).collect();
            if corners.is_empty() {
                continue;
            }
            let bytes: Vec<u8> = corners.iter().flat_map(|corner| corner.to_le_bytes()).collect();
            let indices = self.accessor(U32, "SCALAR", corners.len(), &bytes);
            let material = json!({
                "doubleSided": sides == Sides::Both,
                "alphaMode": if sides == Sides::Neither { "BLEND" } else { "OPAQUE" },
            });
            let known = self.materials.iter().position(|m| *m == material);
            let material = known.unwrap_or_else(|| push(&mut self.materials, material));
            primitives.push(json!({
                "attributes": { "POSITION": positions }, "indices": indices, "material": material,
            }));
        }
        let new = push(&mut self.made, json!({ "primitives": primitives }));
        self.meshes.insert(key, new);
        new
    }

    /// Adds the node of a perspective camera.
    fn camera(&mut self, camera: &Camera) {
        // Planes of a matrix with depth 0 to 1, found in double precision: they cancel.
        let projection = camera.projection.as_dmat4();
        let (a, b) = (projection.z_axis.z, projection.w_axis.z);
        let yfov = 2.0 * (1.0 / projection.y_axis.y).atan();
        let mut lens = json!({ "yfov": yfov as f32, "znear": (b / a) as f32 });
        if a != -1.0 {
            lens["zfar"] = json!((b / (a + 1.0)) as f32);
        }
        self.lens = json!({ "type": "perspective", "perspective": lens });
        self.nodes.push(json!({ "camera": 0, "name": "camera" }));
    }

    /// Moves the last node by one value a frame.
    fn animate(&mut self, path: &str, kind: &str, values: &[f32]) {
        let output = self.floats(kind, values);
        let sampler = push(&mut self.samplers, json!({ "input": self.times, "output": output }));
        let target = json!({ "node": self.nodes.len() - 1, "path": path });
        self.channels.push(json!({ "sampler": sampler, "target": target }));
    }

    /// An accessor of floats, with their bounds.
    fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC3" => 3,
            _ => 4,
        };
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let accessor = self.accessor(F32, kind, values.len() / width, &bytes);
        for (name, pick) in [("min", f32::min as fn(f32, f32) -> f32), ("max", f32::max)] {
            let of = |i: usize| values.iter().skip(i).step_by(width).copied().reduce(pick).unwrap_or(0.0);
            self.accessors[accessor][name] = json!((0..width).map(of).collect::<Vec<f32>>());
        }
        accessor
    }

    fn accessor(&mut self, component: u32, kind: &str, count: usize, bytes: &[u8]) -> usize {
        // All components have four bytes, so that every part starts at a multiple of four.
        let view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        self.bytes.extend(bytes);
        let view = push(&mut self.views, view);
        let accessor =
            json!({ "bufferView": view, "componentType": component, "type": kind, "count": count });
        push(&mut self.accessors, accessor)
    }

    /// The file; `origin` is added to all positions.
    fn finish(mut self, name: &str, origin: DVec3) -> Result<Vec<u8>, ExportError> {
        let mut roots: Vec<usize> = (0..self.nodes.len()).collect();
        if origin != DVec3::ZERO {
            let node = json!({ "translation": origin.as_vec3().to_array(), "children": roots });
            roots = vec![push(&mut self.nodes, node)];
        }
        let document = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "name": name, "nodes": roots }],
            "nodes": self.nodes,
            "cameras": [self.lens],
            "meshes": self.made,
            "materials": self.materials,
            "animations": [{ "channels": self.channels, "samplers": self.samplers }],
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{ "byteLength": self.bytes.len() }],
        });
        container(document, self.bytes).ok_or(ExportError::TooLarge)
    }
}

/// A .glb file of a document and its buffer; `None` beyond 4 GB. Empty lists go: glTF has none.
pub fn container(mut document: Value, bytes: Vec<u8>) -> Option<Vec<u8>> {
    if let Some(members) = document.as_object_mut() {
        members.retain(|_, list| list.as_array().is_none_or(|list| !list.is_empty()));
    }
    // The length is found as the file is written.
    let header = Header { magic: *b"glTF", version: 2, length: 0 };
    let json = document.to_string().into_bytes().into();
    let file = Glb { header, json, bin: Some(bytes.into()) }.to_vec().ok()?;
    u32::try_from(file.len()).is_ok().then_some(file)
}
