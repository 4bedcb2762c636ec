//! Scenes from glTF 2.0 files.
//!
//! - **Nodes**: the default scene, else the first, else all nodes. Every node with a
//!   mesh is one object; nodes share meshes. `EXT_mesh_gpu_instancing` makes each
//!   instance an object, named "node#0", "node#1" and so on. `extras.role` on the node says
//!   "occluder" (hides only), "occludee" (is only tested) or "both", which is the default.
//! - **Meshes**: the triangles, strips and fans of a mesh are joined, points and lines are
//!   left out. Positions are floats, or integers as by `KHR_mesh_quantization`.
//!   Only [`load_lit`] looks at materials: all triangles are opaque, and seen from both sides, so
//!   that a node that mirrors its mesh keeps the order of corners.
//! - **Motion**: a node that an animation moves, itself or by a parent, is dynamic. All
//!   animations play together from time 0; of those for one property of a node the first
//!   in the file is used. The greatest speed of an object bounds the way of each of its
//!   points from any frame to any other. Skins and morph targets in use are refused,
//!   because they move the surface in ways that the node does not tell.
//! - **Path**: the first perspective camera that an animation moves, at 30 frames a
//!   second, for as long as the longest animation (at most 100,000 frames); else the first
//!   perspective camera, standing still for 150 frames. Orthographic cameras are passed over.
//! - **Walk**, where that leaves no camera: 150 frames on a circle inside the bounds, at the
//!   height of their centre, with a radius of 0.35 times the smaller of width and depth,
//!   looking ahead. A side shorter than a hundredth of the longest counts as a tenth of it:
//!   one walks above a bare floor and around a bare wall.
//! - **Buffers**: the binary chunk, data URIs in base64, and files by relative URIs.
//!   Accessors may be sparse.
//!
//! A file is taken whole or refused: nothing is half loaded. Accessors may share bytes, and may
//! have none, but a file that unfolds to more than four elements a byte of its buffers and a million
//! more is refused. Nodes may be nested in any depth.

mod accessors;
mod buffers;
mod instances;
mod looks;
mod meshes;
mod nodes;
mod path;
#[cfg(test)]
mod tests;
mod tracks;

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Affine3A;

use crate::lit::LitScene;
use crate::world::{FRAME_SECONDS, GridHint, Mesh, Motion, Object, Shape, World};
use accessors::{Buffers, Components};
use buffers::buffers_of;
pub use looks::read_lit;

use instances::{INSTANCING, instances_of};
use meshes::Meshes;
use nodes::{check_rigid, nodes_of, role_of, wrong};
use path::{FilePath, Moving, camera_of};
use tracks::animate;

/// Frames of a path that the file does not give.
const OWN_FRAMES: usize = 150;
/// Frames after the first of a path that the file gives.
const MOST_FRAMES: f64 = 99_999.0;
/// Bytes of the name of an instance that count as an element of a buffer.
const NAME_OF_AN_ELEMENT: usize = 16;
/// By triangle: a material, as [`Meshes::mesh`] numbers them.
type Looks = Arc<[u32]>;

/// Cells along the longest axis of the grid that is asked for.
const CELLS: f32 = 128.0;
const QUANTIZATION: &str = "KHR_mesh_quantization";
/// Extensions that a file may require.
const UNDERSTOOD: [&str; 2] = [QUANTIZATION, INSTANCING];
/// What the names of extensions start with that change no geometry, only what it looks like.
const COLOURS: [&str; 7] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_dds",
    "KHR_lights_punctual",
    "EXT_lights_image_based",
    "KHR_xmp",
];

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
    /// A buffer that it names cannot be had.
    #[error("buffer {buffer} cannot be read: {why}")]
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
    /// It requires extensions that are not read.
    #[error("requires extensions that are not read: {0}")]
    Extensions(String),
    /// The corners of a primitive make no whole triangles.
    #[error("primitive {primitive} of mesh {mesh} has {corners} corners, which make no whole triangles")]
    Corners {
        /// Index of the mesh.
        mesh: usize,
        /// Index of the primitive in the mesh.
        primitive: usize,
        /// How many corners there are.
        corners: usize,
    },
    /// A mesh has more vertices than can be numbered.
    #[error("mesh {0} has too many vertices")]
    TooManyVertices(usize),
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
    /// A node breaks the rules, or is of a kind that is not read.
    #[error("node {node} ({name:?}) {why}")]
    Node {
        /// Index of the node.
        node: usize,
        /// Its name; may be empty.
        name: String,
        /// What is wrong with it.
        why: String,
    },
    /// Nodes are their own ancestors, or have two parents.
    #[error("node {0} is reached twice: nodes must form trees")]
    NotATree(usize),
    /// There is nothing to show.
    #[error("holds no triangles in any node")]
    NoTriangles,
}

/// Loads a scene from a `.glb` or `.gltf` file; buffers in other files are looked for from its folder.
///
/// # Errors
/// Says what is wrong with a file that cannot be taken whole.
pub fn load(path: &Path) -> Result<World, ImportError> {
    open(path, read)
}

/// Loads a scene with its materials and lights from such a file; see [`read_lit`].
///
/// # Errors
/// As [`load`].
pub fn load_lit(path: &Path) -> Result<LitScene, ImportError> {
    open(path, read_lit)
}

fn open<T>(
    path: &Path,
    read: impl FnOnce(&str, &[u8], Option<&Path>) -> Result<T, Trouble>,
) -> Result<T, ImportError> {
    let name = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    std::fs::read(path)
        .map_err(Trouble::from)
        .and_then(|bytes| read(&name, &bytes, path.parent()))
        .map_err(|why| ImportError { path: path.to_owned(), why })
}

/// Reads a scene from the bytes of a file; buffers in other files are looked for from `folder`.
///
/// # Errors
/// As [`load`].
pub fn read(name: &str, bytes: &[u8], folder: Option<&Path>) -> Result<World, Trouble> {
    let (document, buffers) = parse(bytes, folder)?;
    world(name, &document, &buffers).map(|(world, _)| world)
}

fn parse(bytes: &[u8], folder: Option<&Path>) -> Result<(gltf::Document, Buffers), Trouble> {
    check_header(bytes)?;
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice_without_validation(bytes)?;
    check_extensions(&document)?;
    check_rules(&document)?;
    let buffers = Buffers::new(buffers_of(&document, blob, folder)?);
    Ok((document, buffers))
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

/// Refuses files that cannot be read without extensions that are not understood.
fn check_extensions(document: &gltf::Document) -> Result<(), Trouble> {
    let known =
        |name: &str| UNDERSTOOD.contains(&name) || COLOURS.iter().any(|start| name.starts_with(start));
    let mut unknown: Vec<&str> = document.extensions_required().filter(|name| !known(name)).collect();
    if unknown.is_empty() {
        return Ok(());
    }
    unknown.dedup();
    Err(Trouble::Extensions(unknown.join(", ")))
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
    // Extensions are checked on their own: the crate knows none of those that are read here.
    errors.retain(|(_, error)| *error != Error::Unsupported);
    if errors.is_empty() { Ok(()) } else { Err(gltf::Error::Validation(errors)) }
}

/// The scene, and the materials of each object.
fn world(name: &str, document: &gltf::Document, buffers: &Buffers) -> Result<(World, Vec<Looks>), Trouble> {
    let mut nodes = nodes_of(document)?;
    let clip = animate(document, buffers, &mut nodes)?;
    let quantized =
        document.extensions_used().chain(document.extensions_required()).any(|e| e == QUANTIZATION);
    let mut reader = Meshes::new(buffers, if quantized { Components::Integers } else { Components::Floats });

    type Known = Option<(Arc<Mesh>, Looks)>;
    let mut meshes: HashMap<usize, Known> = HashMap::new();
    let mut objects = Vec::new();
    let mut materials = Vec::new();
    let mut moving = Vec::new();
    let (globals, moves) = (nodes.globals(), nodes.moving());
    for (place, item) in nodes.0.iter().enumerate() {
        let Some(node) = document.nodes().nth(item.index) else { continue };
        let Some(mesh) = node.mesh() else { continue };
        check_rigid(&node, &mesh, item.morphs)?;
        let (occludes, tested) = role_of(&node)?;
        let mesh = match meshes.get(&mesh.index()) {
            Some(known) => known.clone(),
            None => {
                let read = reader.mesh(&mesh)?.map(|(mesh, looks)| (Arc::new(mesh), looks.into()));
                meshes.insert(mesh.index(), read.clone());
                read
            }
        };
        let Some((mesh, looks)) = mesh else { continue };
        let name = node.name().unwrap_or("");
        let (transform, dynamic) = (globals[place], moves[place]);
        let mut add = |name: String, instance: Affine3A| {
            if dynamic {
                moving.push(Moving {
                    object: objects.len(),
                    node: place,
                    place: instance,
                    mesh: mesh.clone(),
                });
            }
            materials.push(looks.clone());
            objects.push(Object {
                name,
                shape: Shape::Mesh { mesh: mesh.clone(), transform: transform * instance },
                motion: if dynamic { Motion::Dynamic { max_speed: 0.0 } } else { Motion::Static },
                occludes,
                tested,
            });
        };
        match instances_of(document, buffers, &node)? {
            None => add(name.to_owned(), Affine3A::IDENTITY),
            Some(places) => {
                // Each gets the name.
                if !buffers.spend(places.len().saturating_mul(1 + name.len() / NAME_OF_AN_ELEMENT)) {
                    return Err(wrong(&node, "has too many instances for its name"));
                }
                for (i, instance) in places.into_iter().enumerate() {
                    add(format!("{name}#{i}"), instance);
                }
            }
        }
    }
    if objects.is_empty() {
        return Err(Trouble::NoTriangles);
    }

    // Both ends of the clip are frames.
    let clip_frames = (f64::from(clip) / FRAME_SECONDS).round().clamp(0.0, MOST_FRAMES) as usize + 1;
    let camera = camera_of(document, &nodes, &moves);
    let frames = match &camera {
        Some(c) if moves[c.node] => clip_frames,
        _ => OWN_FRAMES,
    };
    let mut animation = FilePath::new(nodes, moving, camera, frames);
    let (min, max) = animation.settle(&mut objects)?;
    let size = (max - min).max_element();
    // Far from the origin, cells that are too small could not be told apart.
    let margin = (size.max(1e-3) * 1e-3).max(min.abs().max(max.abs()).max_element() * 1e-5);
    let (min, max) = (min - margin, max + margin);
    let cell = (max - min).max_element() / CELLS;
    if !(min.is_finite() && max.is_finite() && cell.is_finite()) {
        return Err(Trouble::NotFinite("the size of the scene".to_owned()));
    }
    let world = World {
        name: name.to_owned(),
        objects,
        grid: GridHint { min, max, cell },
        frames,
        animation: Box::new(animation),
    };
    Ok((world, materials))
}
