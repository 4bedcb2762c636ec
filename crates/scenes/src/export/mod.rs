//! Test scenes written as glTF 2.0 files, which [`crate::import`] reads back.
//!
//! What hides is said by materials: see-through ones blend, and what hides from both sides is
//! double sided. Each object is a node: a box is scaled from one unit cube, a sphere is a ball of
//! 320 triangles. The positions of moving objects and of the camera are stored for every frame of
//! the path.

#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Mat4, Quat, Vec3};
use gltf::Glb;
use gltf::binary::Header;
use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::animation::{Channel, Interpolation, Property, Sampler, Target};
use gltf::json::buffer::View;
use gltf::json::camera::Perspective;
use gltf::json::extras::RawValue;
use gltf::json::material::AlphaMode;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked::Valid;
use gltf::json::{self, Accessor, Animation, Buffer, Index, Node, Root, Scene, Value};
use serde_json::json;
use serde_json::value::to_raw_value;

use crate::world::{Camera, FRAME_SECONDS, Mesh, Motion, Object, Shape, Sides, World};
use casca_tools::path_error::PathError;

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
    /// The document cannot be encoded.
    #[error("the scene cannot be encoded: {0}")]
    Encode(#[from] gltf::Error),
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
        let node = writer.object(i, object)?;
        if let Some(positions) = paths.objects.get(&i) {
            writer.animate(node, Property::Translation, Type::Vec3, positions);
        }
    }
    let node = writer.camera(&world.camera(0, 1.0));
    writer.animate(node, Property::Translation, Type::Vec3, &paths.eyes);
    writer.animate(node, Property::Rotation, Type::Vec4, &paths.turns);
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

/// A file in the making.
struct Writer {
    root: Root,
    bytes: Vec<u8>,
    /// The times of all frames.
    times: Index<Accessor>,
    cube: Arc<Mesh>,
    ball: Arc<Mesh>,
    /// Meshes that are written, by their address.
    meshes: HashMap<*const Mesh, Index<json::Mesh>>,
    channels: Vec<Channel>,
    samplers: Vec<Sampler>,
}

impl Writer {
    fn new(frames: usize) -> Self {
        let mut writer = Self {
            root: Root::default(),
            bytes: Vec::new(),
            times: Index::new(0),
            cube: Arc::new(Mesh::cuboid(Vec3::ZERO, Vec3::ONE)),
            ball: Arc::new(Mesh::ball(CUTS)),
            meshes: HashMap::new(),
            channels: Vec::new(),
            samplers: Vec::new(),
        };
        let times: Vec<f32> = (0..frames).map(|frame| (frame as f64 * FRAME_SECONDS) as f32).collect();
        writer.times = writer.floats(Type::Scalar, &times);
        writer
    }

    /// The node of an object.
    fn object(&mut self, index: usize, object: &Object) -> Result<Index<Node>, ExportError> {
        let mut node = Node { name: Some(object.name.clone()), ..Node::default() };
        node.extras = match (object.occludes, object.tested) {
            (true, true) => None,
            (true, false) => Some(role("occluder")?),
            (false, _) => Some(role("occludee")?),
        };
        let origin = origin(&object.shape).to_array();
        let mesh = match &object.shape {
            Shape::Sphere { radius, .. } => {
                (node.translation, node.scale) = (Some(origin), Some([*radius; 3]));
                self.ball.clone()
            }
            Shape::Box { min, max } => {
                (node.translation, node.scale) = (Some(origin), Some((*max - *min).to_array()));
                self.cube.clone()
            }
            Shape::Mesh { .. } if object.motion != Motion::Static => {
                return Err(ExportError::MovingMesh(index));
            }
            Shape::Mesh { mesh, transform } => {
                node.matrix = Some(Mat4::from(*transform).to_cols_array());
                mesh.clone()
            }
        };
        node.mesh = Some(self.mesh(&mesh));
        Ok(self.root.push(node))
    }

    /// A mesh, which is written when it is first asked for.
    fn mesh(&mut self, mesh: &Arc<Mesh>) -> Index<json::Mesh> {
        let key = Arc::as_ptr(mesh);
        if let Some(known) = self.meshes.get(&key) {
            return *known;
        }
        let positions: Vec<f32> = mesh.positions.iter().flat_map(|p| p.to_array()).collect();
        let positions = self.floats(Type::Vec3, &positions);
        // What hides alike is one primitive.
        let mut primitives = Vec::new();
        for sides in [Sides::Both, Sides::Front, Sides::Neither] {
            let triangles = (0..mesh.triangles.len()).filter(|&i| mesh.sides_of(i) == sides);
            let corners: Vec<u32> = triangles.flat_map(|i| mesh.triangles[i]).collect();
            if corners.is_empty() {
                continue;
            }
            let bytes: Vec<u8> = corners.iter().flat_map(|corner| corner.to_le_bytes()).collect();
            let corners = self.accessor(ComponentType::U32, Type::Scalar, corners.len(), &bytes);
            primitives.push(Primitive {
                attributes: BTreeMap::from([(Valid(Semantic::Positions), positions)]),
                extensions: None,
                extras: None,
                indices: Some(corners),
                material: Some(self.material(sides)),
                mode: Valid(Mode::Triangles),
                targets: None,
            });
        }
        let new = self.root.push(json::Mesh {
            extensions: None,
            extras: None,
            name: None,
            primitives,
            weights: None,
        });
        self.meshes.insert(key, new);
        new
    }

    /// The material of what hides so.
    fn material(&mut self, sides: Sides) -> Index<json::Material> {
        let wanted = |m: &json::Material| {
            m.double_sided == (sides == Sides::Both)
                && (m.alpha_mode == Valid(AlphaMode::Opaque)) == (sides != Sides::Neither)
        };
        if let Some(known) = self.root.materials.iter().position(wanted) {
            return Index::new(known as u32);
        }
        let alpha_mode = if sides == Sides::Neither { AlphaMode::Blend } else { AlphaMode::Opaque };
        self.root.push(json::Material {
            double_sided: sides == Sides::Both,
            alpha_mode: Valid(alpha_mode),
            ..json::Material::default()
        })
    }

    /// The node of a perspective camera.
    fn camera(&mut self, camera: &Camera) -> Index<Node> {
        // Planes of a matrix with depth 0 to 1, found in double precision: they cancel.
        let projection = camera.projection.as_dmat4();
        let (a, b) = (projection.z_axis.z, projection.w_axis.z);
        let lens = self.root.push(json::Camera {
            name: None,
            orthographic: None,
            perspective: Some(Perspective {
                aspect_ratio: None,
                yfov: (2.0 * (1.0 / projection.y_axis.y).atan()) as f32,
                zfar: (a != -1.0).then_some((b / (a + 1.0)) as f32),
                znear: (b / a) as f32,
                extensions: None,
                extras: None,
            }),
            type_: Valid(json::camera::Type::Perspective),
            extensions: None,
            extras: None,
        });
        self.root.push(Node { camera: Some(lens), name: Some("camera".to_owned()), ..Node::default() })
    }

    /// Moves a node by one value a frame.
    fn animate(&mut self, node: Index<Node>, property: Property, kind: Type, values: &[f32]) {
        let output = self.floats(kind, values);
        let sampler = Sampler {
            extensions: None,
            extras: None,
            input: self.times,
            interpolation: Valid(Interpolation::Linear),
            output,
        };
        let sampler = Index::push(&mut self.samplers, sampler);
        let target = Target { extensions: None, extras: None, node, path: Valid(property) };
        self.channels.push(Channel { sampler, target, extensions: None, extras: None });
    }

    /// An accessor of floats, with their bounds.
    fn floats(&mut self, kind: Type, values: &[f32]) -> Index<Accessor> {
        let width = kind.multiplicity();
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let accessor = self.accessor(ComponentType::F32, kind, values.len() / width, &bytes);
        let bound = |pick: fn(f32, f32) -> f32| {
            let of = |i: usize| values.iter().skip(i).step_by(width).copied().reduce(pick).unwrap_or(0.0);
            Some(Value::from((0..width).map(of).collect::<Vec<f32>>()))
        };
        let written = &mut self.root.accessors[accessor.value()];
        (written.min, written.max) = (bound(f32::min), bound(f32::max));
        accessor
    }

    fn accessor(
        &mut self,
        component: ComponentType,
        kind: Type,
        count: usize,
        bytes: &[u8],
    ) -> Index<Accessor> {
        // All components have four bytes, so that every part starts at a multiple of four.
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        let view = self.root.push(View {
            buffer: Index::new(0),
            byte_length: bytes.len().into(),
            byte_offset: Some(start.into()),
            byte_stride: None,
            name: None,
            target: None,
            extensions: None,
            extras: None,
        });
        self.root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: count.into(),
            component_type: Valid(GenericComponentType(component)),
            extensions: None,
            extras: None,
            type_: Valid(kind),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
        })
    }

    /// The file; `origin` is added to all positions.
    fn finish(mut self, name: &str, origin: DVec3) -> Result<Vec<u8>, ExportError> {
        self.root.push(Buffer {
            byte_length: self.bytes.len().into(),
            name: None,
            uri: None,
            extensions: None,
            extras: None,
        });
        self.root.push(Animation {
            extensions: None,
            extras: None,
            channels: self.channels,
            name: None,
            samplers: self.samplers,
        });
        let mut nodes: Vec<_> = (0..self.root.nodes.len() as u32).map(Index::new).collect();
        if origin != DVec3::ZERO {
            let translation = Some(origin.as_vec3().to_array());
            nodes = vec![self.root.push(Node { translation, children: Some(nodes), ..Node::default() })];
        }
        let scene = Scene { extensions: None, extras: None, name: Some(name.to_owned()), nodes };
        self.root.scene = Some(self.root.push(scene));
        let json = self.root.to_vec().map_err(gltf::Error::Deserialize)?;
        // A header of 12 bytes, two chunks with headers of 8, each filled up to a multiple of four.
        let length = 28 + json.len().next_multiple_of(4) + self.bytes.len().next_multiple_of(4);
        let length = u32::try_from(length).map_err(|_| ExportError::TooLarge)?;
        let header = Header { magic: *b"glTF", version: 2, length };
        Ok(Glb { header, json: json.into(), bin: Some(self.bytes.into()) }.to_vec()?)
    }
}

/// The extras of a node that names its role.
fn role(role: &str) -> Result<Box<RawValue>, ExportError> {
    Ok(to_raw_value(&json!({ "role": role })).map_err(gltf::Error::Deserialize)?)
}
