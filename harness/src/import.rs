//! Scenes from glTF 2.0 files.
//!
//! Every node with a mesh is one object; its triangle primitives are joined, and
//! instances share one mesh. A node that an animation moves, itself or by a
//! parent, is dynamic. `extras.role` on the node says "occluder" (hides only),
//! "occludee" (is only tested) or "both", which is the default.
//!
//! The first perspective camera that an animation moves is the path, at 30 frames a
//! second; else the first perspective camera, standing still. Without one the path
//! is an orbit inside the bounds, at the height of their centre, with a radius of
//! 0.35 times the smaller of width and depth, looking ahead.
//!
//! A file is taken whole or refused: nothing is half loaded.

use std::collections::HashMap;
use std::f32::consts::TAU;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::camera::rh::{proj::directx, view::look_to_mat4};
use glam::{Affine3A, Mat4, Quat, Vec3};
use gltf::accessor::{DataType, Dimensions};
use gltf::animation::{Interpolation, Property};

use crate::world::{Animation, Camera, FRAME_SECONDS, GridHint, Mesh, Motion, Object, Shape, World};

/// Frames of a path that the file does not give.
const OWN_FRAMES: usize = 150;
/// Cells along the longest axis of the grid that is asked for.
const CELLS: f32 = 128.0;

/// Why a file was refused.
#[derive(Debug, thiserror::Error)]
#[error("{}: {why}", path.display())]
pub struct ImportError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub why: Trouble,
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Trouble {
    /// It cannot be read.
    #[error("cannot be read: {0}")]
    Read(#[from] std::io::Error),
    /// It is no glTF 2.0, or breaks its rules.
    #[error("is not a valid glTF 2.0 file: {0}")]
    Format(#[from] gltf::Error),
    /// A buffer that it names is missing.
    #[error("buffer {buffer} is missing: {why}")]
    Buffer {
        /// Index of the buffer.
        buffer: usize,
        /// Why.
        why: String,
    },
    /// A buffer is shorter than the file says.
    #[error("buffer {buffer} has {held} bytes, but {needed} are needed")]
    ShortBuffer {
        /// Index of the buffer.
        buffer: usize,
        /// Bytes there.
        held: usize,
        /// Bytes needed.
        needed: usize,
    },
    /// An accessor has a form that is not read.
    #[error("accessor {accessor} ({what}) is {why}")]
    Accessor {
        /// Index of the accessor.
        accessor: usize,
        /// What it holds.
        what: &'static str,
        /// What is not read about it.
        why: &'static str,
    },
    /// A triangle names a vertex that does not exist.
    #[error("mesh {mesh} names vertex {vertex} of {vertices}")]
    Vertex {
        /// Index of the mesh.
        mesh: usize,
        /// The vertex.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// A coordinate or transform is not finite.
    #[error("{0} is not finite")]
    NotFinite(String),
    /// Nodes are their own ancestors, or have two parents.
    #[error("node {0} is reached twice: nodes must form trees")]
    NotATree(usize),
    /// There is nothing to show.
    #[error("holds no triangles in any node")]
    NoTriangles,
}

/// Loads a scene from a `.glb` file, or from a `.gltf` file with its buffers in files beside it.
///
/// # Errors
/// Says what is wrong with a file that cannot be taken whole.
pub fn load(path: &Path) -> Result<World, ImportError> {
    let name = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    std::fs::read(path)
        .map_err(Trouble::from)
        .and_then(|bytes| read(&name, &bytes, path.parent()))
        .map_err(|why| ImportError { path: path.to_owned(), why })
}

/// Reads a scene from the bytes of a file; buffers in other files are looked for in `folder`.
///
/// # Errors
/// As [`load`].
pub fn read(name: &str, bytes: &[u8], folder: Option<&Path>) -> Result<World, Trouble> {
    check_header(bytes)?;
    let gltf::Gltf { document, mut blob } = gltf::Gltf::from_slice_without_validation(bytes)?;
    check_rules(&document)?;
    let mut buffers = Vec::new();
    for buffer in document.buffers() {
        let index = buffer.index();
        let fail = |why: &str| Trouble::Buffer { buffer: index, why: why.to_owned() };
        let data = match buffer.source() {
            gltf::buffer::Source::Bin => blob.take().ok_or_else(|| fail("the file has no binary chunk"))?,
            gltf::buffer::Source::Uri(uri) if uri.starts_with("data:") => {
                return Err(fail("data URIs are not read; pack the file as .glb"));
            }
            gltf::buffer::Source::Uri(uri) => {
                let folder = folder.ok_or_else(|| fail("it lies in another file"))?;
                std::fs::read(folder.join(uri)).map_err(|e| fail(&format!("{uri}: {e}")))?
            }
        };
        if data.len() < buffer.length() {
            return Err(Trouble::ShortBuffer { buffer: index, held: data.len(), needed: buffer.length() });
        }
        buffers.push(data);
    }
    Reader { buffers }.world(name, &document)
}

/// Refuses a .glb that claims to be shorter than its header; the parser takes this for granted.
fn check_header(bytes: &[u8]) -> Result<(), gltf::Error> {
    let Some(length) = bytes.strip_prefix(b"glTF").and_then(|rest| rest.get(4..8)) else { return Ok(()) };
    let length = length.iter().rev().fold(0, |n, &byte| n << 8 | u32::from(byte));
    if length >= 12 {
        return Ok(());
    }
    Err(gltf::Error::Binary(gltf::binary::Error::Length { length, length_read: bytes.len() }))
}

/// Validates a document, with the rules that the validation of the glTF crate leaves out but takes for granted.
fn check_rules(document: &gltf::Document) -> Result<(), gltf::Error> {
    use gltf::json::Path;
    use gltf::json::camera::Type;
    use gltf::json::validation::{Checked, Error, Validate};
    let root = document.as_json();
    let at = |list: &str, index: usize| Path::new().field(list).index(index);
    let mut errors = Vec::new();
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let path = || at("meshes", m).field("primitives").index(p).field("attributes");
            primitive.attributes.validate(root, path, &mut |path, error| errors.push((path(), error)));
        }
    }
    for (a, animation) in root.animations.iter().enumerate() {
        for (c, channel) in animation.channels.iter().enumerate() {
            let path = || at("animations", a).field("channels").index(c).field("target");
            channel.target.validate(root, path, &mut |path, error| errors.push((path(), error)));
        }
    }
    for (i, camera) in root.cameras.iter().enumerate() {
        let missing = match camera.type_ {
            Checked::Valid(Type::Perspective) => camera.perspective.is_none(),
            Checked::Valid(Type::Orthographic) => camera.orthographic.is_none(),
            Checked::Invalid => true,
        };
        if missing {
            errors.push((at("cameras", i), Error::Missing));
        }
    }
    // Only now: it looks up the positions of meshes unchecked.
    if errors.is_empty() {
        root.validate(root, Path::new, &mut |path, error| errors.push((path(), error)));
    }
    if errors.is_empty() { Ok(()) } else { Err(gltf::Error::Validation(errors)) }
}

/// A key-framed property of a node.
#[derive(Debug, Clone)]
struct Track<T> {
    times: Vec<f32>,
    values: Vec<T>,
    interpolation: Interpolation,
}

trait Mix: Copy {
    fn mix(a: Self, b: Self, t: f32) -> Self;
    /// The cubic Hermite spline of glTF: values, and tangents times the interval.
    fn spline(a: Self, out: Self, into: Self, b: Self, t: f32, dt: f32) -> Self;
}

impl Mix for Vec3 {
    fn mix(a: Self, b: Self, t: f32) -> Self {
        a.lerp(b, t)
    }

    fn spline(a: Self, out: Self, into: Self, b: Self, t: f32, dt: f32) -> Self {
        let [p, m, q, n] = hermite(t, dt);
        a * p + out * m + b * q + into * n
    }
}

impl Mix for Quat {
    fn mix(a: Self, b: Self, t: f32) -> Self {
        a.slerp(b, t)
    }

    fn spline(a: Self, out: Self, into: Self, b: Self, t: f32, dt: f32) -> Self {
        let [p, m, q, n] = hermite(t, dt);
        (a * p + out * m + b * q + into * n).normalize()
    }
}

fn hermite(t: f32, dt: f32) -> [f32; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [2.0 * t3 - 3.0 * t2 + 1.0, dt * (t3 - 2.0 * t2 + t), 3.0 * t2 - 2.0 * t3, dt * (t3 - t2)]
}

impl<T: Mix> Track<T> {
    fn at(&self, time: f32) -> Option<T> {
        let last = self.times.len().checked_sub(1)?;
        let cubic = self.interpolation == Interpolation::CubicSpline;
        let value = |i: usize| self.values.get(if cubic { 3 * i + 1 } else { i }).copied();
        let next = self.times.partition_point(|&t| t <= time);
        if next == 0 || next > last {
            return value(next.min(last));
        }
        let (i, j) = (next - 1, next);
        let dt = self.times[j] - self.times[i];
        let t = if dt > 0.0 { ((time - self.times[i]) / dt).clamp(0.0, 1.0) } else { 0.0 };
        let (a, b) = (value(i)?, value(j)?);
        Some(match self.interpolation {
            Interpolation::Step => a,
            Interpolation::Linear => T::mix(a, b, t),
            Interpolation::CubicSpline => {
                T::spline(a, *self.values.get(3 * i + 2)?, *self.values.get(3 * j)?, b, t, dt)
            }
        })
    }
}

#[derive(Debug, Clone, Default)]
struct Tracks {
    translation: Option<Track<Vec3>>,
    rotation: Option<Track<Quat>>,
    scale: Option<Track<Vec3>>,
}

/// A node: its rest pose, what moves it, and its parent, which comes before it.
#[derive(Debug, Clone)]
struct Node {
    parent: Option<usize>,
    rest: (Vec3, Quat, Vec3),
    /// Where the file gives a matrix instead of a pose.
    matrix: Option<Mat4>,
    tracks: Tracks,
    moves: bool,
}

impl Node {
    fn local(&self, time: f32) -> Affine3A {
        if let Some(matrix) = self.matrix.filter(|_| !self.moves) {
            return Affine3A::from_mat4(matrix);
        }
        let at =
            |track: &Option<Track<Vec3>>, rest: Vec3| track.as_ref().and_then(|t| t.at(time)).unwrap_or(rest);
        let rotation = self.tracks.rotation.as_ref().and_then(|t| t.at(time)).unwrap_or(self.rest.1);
        Affine3A::from_scale_rotation_translation(
            at(&self.tracks.scale, self.rest.2),
            rotation.normalize(),
            at(&self.tracks.translation, self.rest.0),
        )
    }
}

/// All nodes, parents first.
#[derive(Debug, Clone)]
struct Nodes(Vec<Node>);

impl Nodes {
    fn global(&self, node: usize, time: f32) -> Affine3A {
        let mut transform = self.0[node].local(time);
        let mut at = self.0[node].parent;
        while let Some(parent) = at {
            transform = self.0[parent].local(time) * transform;
            at = self.0[parent].parent;
        }
        transform
    }

    fn moves(&self, node: usize) -> bool {
        std::iter::successors(Some(node), |&n| self.0[n].parent).any(|n| self.0[n].moves)
    }
}

struct Reader {
    buffers: Vec<Vec<u8>>,
}

impl Reader {
    /// Makes sure that an accessor lies inside its buffer and has the form expected.
    fn check(
        &self,
        accessor: &gltf::Accessor,
        what: &'static str,
        dimensions: Dimensions,
        types: &[DataType],
    ) -> Result<(), Trouble> {
        let fail = |why| Err(Trouble::Accessor { accessor: accessor.index(), what, why });
        if accessor.sparse().is_some() {
            return fail("sparse, which is not read");
        }
        if accessor.dimensions() != dimensions || !types.contains(&accessor.data_type()) {
            return fail("of a type that is not read");
        }
        let Some(view) = accessor.view() else { return fail("without data") };
        let (size, count) = (accessor.size(), accessor.count());
        if count == 0 {
            return fail("empty");
        }
        let stride = view.stride().unwrap_or(size);
        if stride < size {
            return fail("packed closer than its elements are long");
        }
        let length = (count - 1)
            .checked_mul(stride)
            .and_then(|n| n.checked_add(size))
            .and_then(|n| n.checked_add(accessor.offset()));
        if length.is_none_or(|n| n > view.length()) {
            return fail("longer than its buffer view");
        }
        let buffer = view.buffer().index();
        let held = self.buffers.get(buffer).map_or(0, Vec::len);
        match view.offset().checked_add(view.length()) {
            Some(needed) if needed <= held => Ok(()),
            needed => Err(Trouble::ShortBuffer { buffer, held, needed: needed.unwrap_or(usize::MAX) }),
        }
    }

    fn world(&self, name: &str, document: &gltf::Document) -> Result<World, Trouble> {
        let (nodes, order) = nodes_of(document)?;
        let mut nodes = Nodes(nodes);
        let clip = self.animate(document, &mut nodes, &order)?;

        let mut meshes: HashMap<usize, Option<Arc<Mesh>>> = HashMap::new();
        let mut objects = Vec::new();
        let mut moving = Vec::new();
        for (place, &index) in order.iter().enumerate() {
            let Some(node) = document.nodes().nth(index) else { continue };
            let Some(mesh) = node.mesh() else { continue };
            let mesh = match meshes.get(&mesh.index()) {
                Some(known) => known.clone(),
                None => {
                    let read = self.mesh(&mesh)?.map(Arc::new);
                    meshes.insert(mesh.index(), read.clone());
                    read
                }
            };
            let Some(mesh) = mesh else { continue };
            let role = role_of(&node);
            let transform = nodes.global(place, 0.0);
            let dynamic = nodes.moves(place);
            if dynamic {
                moving.push(Moving { object: objects.len(), node: place, mesh: mesh.clone() });
            }
            objects.push(Object {
                name: node.name().unwrap_or("").to_owned(),
                shape: Shape::Mesh { mesh, transform },
                motion: if dynamic { Motion::Dynamic { max_speed: 0.0 } } else { Motion::Static },
                occludes: role != Some("occludee".to_owned()),
                tested: role != Some("occluder".to_owned()),
            });
        }
        if objects.is_empty() {
            return Err(Trouble::NoTriangles);
        }

        // Both ends of the clip are frames.
        let clip_frames = (f64::from(clip) / FRAME_SECONDS).round().clamp(0.0, 1e5) as usize + 1;
        let camera = camera_of(document, &nodes, &order);
        let frames = match &camera {
            Some(c) if nodes.moves(c.node) => clip_frames,
            _ => OWN_FRAMES,
        };
        let mut animation = FilePath { nodes, moving, camera, orbit: (Vec3::ZERO, 0.0), frames };
        let (min, max) = animation.settle(&mut objects)?;
        let margin = (max - min).max_element().max(1e-3) * 1e-3;
        let (min, max) = (min - margin, max + margin);
        let cell = (max - min).max_element() / CELLS;
        Ok(World {
            name: name.to_owned(),
            objects,
            grid: GridHint { min, max, cell },
            frames,
            animation: Box::new(animation),
        })
    }

    /// Reads all animations onto their nodes; gives the length of the longest.
    fn animate(&self, document: &gltf::Document, nodes: &mut Nodes, order: &[usize]) -> Result<f32, Trouble> {
        let mut clip = 0f32;
        for channel in document.animations().flat_map(|a| a.channels().collect::<Vec<_>>()) {
            let target = channel.target();
            let Some(place) = order.iter().position(|&i| i == target.node().index()) else { continue };
            let dimensions = match target.property() {
                Property::Translation | Property::Scale => Dimensions::Vec3,
                Property::Rotation => Dimensions::Vec4,
                Property::MorphTargetWeights => continue,
            };
            let sampler = channel.sampler();
            let (input, output) = (sampler.input(), sampler.output());
            self.check(&input, "animation times", Dimensions::Scalar, &[DataType::F32])?;
            self.check(&output, "animation values", dimensions, &[DataType::F32])?;
            let interpolation = sampler.interpolation();
            let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
            let unfit = |why| Trouble::Accessor { accessor: output.index(), what: "animation values", why };
            if input.count() == 0 || output.count() != input.count() * per_key {
                return Err(unfit("not as long as its times"));
            }
            let reader = channel.reader(|b| self.buffers.get(b.index()).map(Vec::as_slice));
            let times: Vec<f32> = reader.read_inputs().ok_or_else(|| unfit("unreadable"))?.collect();
            if times.iter().any(|t| !t.is_finite()) || !times.is_sorted() {
                return Err(Trouble::NotFinite("an animation time, or their order,".to_owned()));
            }
            clip = clip.max(times[times.len() - 1]);
            let tracks = &mut nodes.0[place].tracks;
            use gltf::animation::util::ReadOutputs;
            let finite = |ok: bool| {
                if ok { Ok(()) } else { Err(Trouble::NotFinite("an animation value".to_owned())) }
            };
            match reader.read_outputs().ok_or_else(|| unfit("unreadable"))? {
                ReadOutputs::Translations(v) => {
                    let values: Vec<Vec3> = v.map(Vec3::from_array).collect();
                    finite(values.iter().all(|v| v.is_finite()))?;
                    tracks.translation = Some(Track { times, values, interpolation });
                }
                ReadOutputs::Scales(v) => {
                    let values: Vec<Vec3> = v.map(Vec3::from_array).collect();
                    finite(values.iter().all(|v| v.is_finite()))?;
                    tracks.scale = Some(Track { times, values, interpolation });
                }
                ReadOutputs::Rotations(v) => {
                    let values: Vec<Quat> = v.into_f32().map(Quat::from_array).collect();
                    finite(values.iter().all(|v| v.is_finite()))?;
                    tracks.rotation = Some(Track { times, values, interpolation });
                }
                ReadOutputs::MorphTargetWeights(_) => {}
            }
            nodes.0[place].moves = true;
        }
        Ok(clip)
    }

    /// Joins the triangles of a mesh; `None` if it has none.
    fn mesh(&self, mesh: &gltf::Mesh) -> Result<Option<Mesh>, Trouble> {
        use gltf::mesh::Mode;
        let mut joined = Mesh::default();
        for primitive in mesh.primitives() {
            let mode = primitive.mode();
            if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
                continue;
            }
            let Some(positions) = primitive.get(&gltf::Semantic::Positions) else { continue };
            self.check(&positions, "positions", Dimensions::Vec3, &[DataType::F32])?;
            if let Some(indices) = primitive.indices() {
                let types = [DataType::U8, DataType::U16, DataType::U32];
                self.check(&indices, "indices", Dimensions::Scalar, &types)?;
            }
            let reader = primitive.reader(|b| self.buffers.get(b.index()).map(Vec::as_slice));
            let unreadable =
                || Trouble::Accessor { accessor: positions.index(), what: "positions", why: "unreadable" };
            let points: Vec<Vec3> =
                reader.read_positions().ok_or_else(unreadable)?.map(Vec3::from_array).collect();
            if points.iter().any(|p| !p.is_finite()) {
                return Err(Trouble::NotFinite(format!("a position of mesh {}", mesh.index())));
            }
            let indices: Vec<u32> = match primitive.indices() {
                Some(_) => reader.read_indices().ok_or_else(unreadable)?.into_u32().collect(),
                None => (0..points.len() as u32).collect(),
            };
            let vertices = points.len();
            if let Some(&vertex) = indices.iter().find(|&&v| v as usize >= vertices) {
                return Err(Trouble::Vertex { mesh: mesh.index(), vertex, vertices });
            }
            let base = joined.positions.len() as u32;
            let mut add = |a: u32, b: u32, c: u32| joined.triangles.push([a + base, b + base, c + base]);
            match mode {
                Mode::TriangleStrip => {
                    for (i, w) in indices.windows(3).enumerate() {
                        if i % 2 == 0 { add(w[0], w[1], w[2]) } else { add(w[1], w[0], w[2]) }
                    }
                }
                Mode::TriangleFan => {
                    for w in indices.get(1..).unwrap_or(&[]).windows(2) {
                        add(indices[0], w[0], w[1]);
                    }
                }
                _ => indices.chunks_exact(3).for_each(|t| add(t[0], t[1], t[2])),
            }
            joined.positions.extend(points);
        }
        Ok((!joined.triangles.is_empty()).then_some(joined))
    }
}

/// The nodes of the file, parents first, and the index of each in the file.
fn nodes_of(document: &gltf::Document) -> Result<(Vec<Node>, Vec<usize>), Trouble> {
    let all: Vec<gltf::Node> = document.nodes().collect();
    let mut is_child = vec![false; all.len()];
    for node in &all {
        for child in node.children() {
            if std::mem::replace(&mut is_child[child.index()], true) {
                return Err(Trouble::NotATree(child.index()));
            }
        }
    }
    // With a default scene only its nodes count.
    let scene = document.default_scene().or_else(|| document.scenes().next());
    let roots: Vec<usize> = match scene {
        Some(scene) => scene.nodes().map(|n| n.index()).collect(),
        None => (0..all.len()).filter(|&i| !is_child[i]).collect(),
    };
    let mut nodes = Vec::new();
    let mut order = Vec::new();
    let mut seen = vec![false; all.len()];
    let mut todo: Vec<(usize, Option<usize>)> = roots.into_iter().rev().map(|i| (i, None)).collect();
    while let Some((index, parent)) = todo.pop() {
        if std::mem::replace(&mut seen[index], true) {
            return Err(Trouble::NotATree(index));
        }
        let node = &all[index];
        let matrix = match node.transform() {
            gltf::scene::Transform::Matrix { matrix } => Some(Mat4::from_cols_array_2d(&matrix)),
            gltf::scene::Transform::Decomposed { .. } => None,
        };
        if matrix.is_some_and(|m| !m.is_finite()) {
            return Err(Trouble::NotFinite(format!("the matrix of node {index}")));
        }
        let (t, r, s) = match matrix {
            Some(m) => {
                let (s, r, t) = m.to_scale_rotation_translation();
                (t, r, s)
            }
            None => {
                let (t, r, s) = node.transform().decomposed();
                (Vec3::from_array(t), Quat::from_array(r), Vec3::from_array(s))
            }
        };
        if matrix.is_none() && !(t.is_finite() && r.is_finite() && s.is_finite() && r.length() > 1e-6) {
            return Err(Trouble::NotFinite(format!("the pose of node {index}")));
        }
        let place = nodes.len();
        nodes.push(Node { parent, rest: (t, r, s), matrix, tracks: Tracks::default(), moves: false });
        order.push(index);
        todo.extend(node.children().map(|c| (c.index(), Some(place))));
    }
    Ok((nodes, order))
}

fn role_of(node: &gltf::Node) -> Option<String> {
    let extras = node.extras().as_ref()?;
    let value: serde_json::Value = serde_json::from_str(extras.get()).ok()?;
    value.get("role")?.as_str().map(str::to_owned)
}

#[derive(Debug, Clone)]
struct FileCamera {
    node: usize,
    fov_y: f32,
    near: f32,
    far: Option<f32>,
}

fn camera_of(document: &gltf::Document, nodes: &Nodes, order: &[usize]) -> Option<FileCamera> {
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

struct Moving {
    object: usize,
    node: usize,
    mesh: Arc<Mesh>,
}

/// The motion that a file gives.
struct FilePath {
    nodes: Nodes,
    moving: Vec<Moving>,
    camera: Option<FileCamera>,
    /// Centre and radius of the path where the file gives none.
    orbit: (Vec3, f32),
    frames: usize,
}

fn time_of(frame: usize) -> f32 {
    (frame as f64 * FRAME_SECONDS) as f32
}

fn bounds_of(mesh: &Mesh, transform: &Affine3A) -> (Vec3, Vec3) {
    let corners = mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize]);
    corners
        .map(|p| transform.transform_point3(p))
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)))
}

impl FilePath {
    /// Goes through all frames: finds speeds and bounds, and refuses what is not finite.
    fn settle(&mut self, objects: &mut [Object]) -> Result<(Vec3, Vec3), Trouble> {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A .glb with one triangle and a camera that moves from x = 0 to x = 2 in two seconds.
    fn small_file() -> Vec<u8> {
        small_file_with("", "")
    }

    /// The same with a part of its JSON replaced.
    fn small_file_with(old: &str, new: &str) -> Vec<u8> {
        let floats: [f32; 9 + 2 + 6] =
            [0.0, 0.0, -5.0, 1.0, 0.0, -5.0, 0.0, 1.0, -5.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0];
        let bin: Vec<u8> = floats.iter().flat_map(|f| f.to_le_bytes()).collect();
        let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
            "nodes":[{"mesh":0,"name":"leaf","extras":{"role":"occludee"}},{"camera":0}],
            "cameras":[{"type":"perspective","perspective":{"yfov":1.0,"znear":0.1}}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
            "animations":[{"channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}],
                "samplers":[{"input":1,"output":2}]}],
            "accessors":[
                {"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,-5],"max":[1,1,-5]},
                {"bufferView":1,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[2]},
                {"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"}],
            "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":8},
                {"buffer":0,"byteOffset":44,"byteLength":24}],
            "buffers":[{"byteLength":68}]}"#;
        assert!(json.contains(old), "{old}");
        let mut json = json.replacen(old, new, 1).into_bytes();
        while !json.len().is_multiple_of(4) {
            json.push(b' ');
        }
        let mut file = Vec::new();
        let total = 12 + 8 + json.len() + 8 + bin.len();
        for word in [0x4654_6c67, 2, total as u32, json.len() as u32, 0x4e4f_534a] {
            file.extend(word.to_le_bytes());
        }
        file.extend(&json);
        for word in [bin.len() as u32, 0x004e_4942] {
            file.extend(word.to_le_bytes());
        }
        file.extend(&bin);
        file
    }

    #[test]
    fn reads_meshes_roles_and_the_camera_path() {
        let world = read("small", &small_file(), None).unwrap();
        assert_eq!((world.objects.len(), world.frames), (1, 61));
        let leaf = &world.objects[0];
        assert!(leaf.name == "leaf" && leaf.tested && !leaf.occludes && leaf.motion == Motion::Static);
        let eye = world.camera(30, 1.5).eye;
        assert!((eye - Vec3::X).length() < 1e-5, "{eye}");
    }

    #[test]
    fn broken_files_are_refused_whole() {
        let file = small_file();
        for length in 0..file.len() {
            assert!(read("cut", &file[..length], None).is_err(), "cut at {length}");
        }
        let mut state = 3u32;
        let mut next = |n: usize| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as usize % n
        };
        for _ in 0..20_000 {
            let mut broken = file.clone();
            for _ in 0..1 + next(3) {
                let at = next(broken.len());
                broken[at] ^= 1 << next(8);
            }
            // Either way is fine; it must not panic.
            let _ = read("flipped", &broken, None);
        }
        assert!(matches!(
            load(Path::new("/no/such/file.glb")).err().expect("no such file").why,
            Trouble::Read(_)
        ));
    }

    #[test]
    fn what_the_parser_takes_for_granted_is_checked() {
        for (old, new) in [
            (r#""path":"translation""#, r#""path":"colour""#),
            (r#""target":{"node":1"#, r#""target":{"node":9"#),
            (r#""type":"perspective""#, r#""type":"orthographic""#),
            (r#""count":3"#, r#""count":0"#),
            (r#""count":2"#, r#""count":0"#),
            (r#""count":3"#, r#""count":18446744073709551615"#),
            (r#""POSITION":0"#, r#""POSITION":7"#),
            (r#"{"camera":0}"#, r#"{"camera":0,"children":[1]}"#),
        ] {
            let refused = read("bad", &small_file_with(old, new), None);
            println!("{new}: {}", refused.err().unwrap_or_else(|| panic!("{new} was taken")));
        }
        let mut short = small_file();
        short[8..12].copy_from_slice(&11u32.to_le_bytes());
        assert!(matches!(read("short", &short, None), Err(Trouble::Format(gltf::Error::Binary(_)))));
    }

    #[test]
    fn deep_trees_need_no_deep_stack() {
        // A chain of nodes, with the camera at its end.
        let depth = 30_000;
        let mut nodes = String::from(r#"{"camera":0,"children":[2]}"#);
        for i in 3..depth {
            nodes += &format!(r#",{{"children":[{i}]}}"#);
        }
        nodes += r#",{"mesh":0}"#;
        let world = read("deep", &small_file_with(r#"{"camera":0}"#, &nodes), None).unwrap();
        assert!(world.objects[1].motion != Motion::Static);
    }

    #[test]
    fn reads_the_real_scenes() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/scenes");
        for (file, objects, triangles) in [
            ("sponza.glb", 339, 262_267),
            ("sponza-parts.glb", 1444, 262_267),
            ("kitchen-parts.glb", 757, 56_939),
            ("cornell.glb", 8, 36),
        ] {
            let path = folder.join(file);
            if !path.exists() {
                println!("skipped: {file} is not here");
                continue;
            }
            let world = load(&path).unwrap();
            let found: usize = world
                .objects
                .iter()
                .map(|o| match &o.shape {
                    Shape::Mesh { mesh, .. } => mesh.triangles.len(),
                    _ => 0,
                })
                .sum();
            assert_eq!((world.objects.len(), found, world.frames), (objects, triangles, 300), "{file}");
        }
    }
}
