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

mod nodes;
mod path;
#[cfg(test)]
mod tests;
mod tracks;

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{Quat, Vec3};
use gltf::accessor::{DataType, Dimensions};
use gltf::animation::{Interpolation, Property};

use crate::world::{FRAME_SECONDS, GridHint, Mesh, Motion, Object, Shape, World};
use nodes::{Nodes, nodes_of, role_of};
use path::{FilePath, Moving, camera_of};
use tracks::Track;

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
