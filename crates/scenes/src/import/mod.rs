//! Scenes from glTF 2.0 files.
//!
//! - **Nodes**: the default scene, else the first, else all nodes. Every node with a
//!   mesh is one object; nodes share meshes. `EXT_mesh_gpu_instancing` makes each
//!   instance an object, named "node#0", "node#1" and so on. `extras.role` on the node says
//!   "occluder" (hides only), "occludee" (is only tested) or "both", which is the default; any
//!   other role counts as that, with a warning.
//! - **Meshes**: the triangles, strips and fans of a mesh are joined to one object, and so are its
//!   points and lines, as triangles without area. Positions are floats, or integers as by
//!   `KHR_mesh_quantization`.
//! - **Motion**: a node that an animation moves, itself or by a parent, is dynamic. All
//!   animations play together from time 0; of those for one property of a node the first
//!   in the file is used. The greatest speed of an object bounds the way of each of its
//!   points from any frame to any other.
//! - **Path**: the first perspective camera that an animation moves, at 30 frames a
//!   second, for as long as the longest animation (at most 100,000 frames, and fewer, with a
//!   warning, where so much moves that a short file would take long); else the first perspective
//!   camera, standing still for 150 frames. Orthographic cameras are passed over; where there are
//!   no others, a warning names them.
//! - **Walk**, where that leaves no camera: 150 frames on a circle inside the bounds, at the
//!   height of their centre, with a radius of 0.35 times the smaller of width and depth,
//!   looking ahead. A side shorter than a hundredth of the longest counts as a tenth of it:
//!   one walks above a bare floor and around a bare wall.
//! - **Buffers**: the binary chunk, data URIs in base64, and files by relative URIs, escaped or as
//!   the file is called. Accessors may be sparse, need no box, and are zeros without a view. Views
//!   that `EXT_meshopt_compression` or `KHR_meshopt_compression` packs, as gltfpack does, are unpacked
//!   if their bytes are not there, and triangles that `KHR_draco_mesh_compression` packs are so if
//!   that is required, too: if not, the plain form is read where there is one, with a warning.
//! - **Far from the origin**: a scene that lies farther than 100 times its size from the origin of
//!   its file, such as in UTM, is moved to an origin of its own before numbers are rounded to
//!   single precision: [`Source::origin`](crate::world::Source::origin) is what to add to
//!   coordinates. The text says where nodes are in double precision; positions and keys in buffers
//!   are floats, and stay as coarse as these are.
//! - **Other writers**: a byte-order mark, chunks of other kinds and filled up otherwise, scenes
//!   without nodes, channels without a node, textures with a source in an extension, members that
//!   are null and what is broken but not read, such as normals, are no fault. Cameras, lights,
//!   materials and unused accessors that are broken are left out with a warning; such a material
//!   counts as transparent. glTF 1.0 is not read.
//!
//! # What hides
//!
//! **Only what is drawn opaque in each case hides, and only from the side from which it is drawn.
//! All that is drawn is looked for**, from both sides. What an object hides from is in
//! [`Mesh::sides`](crate::world::Mesh::sides); the rest of its mesh still counts as its bounds.
//! What is doubtful hides nothing.
//!
//! | in the file | what is done |
//! |---|---|
//! | `alphaMode` OPAQUE | hides; the alpha of textures, factors and vertex colours (`COLOR_0`) is not drawn, and does not count |
//! | `alphaMode` BLEND, MASK | hides nothing, whatever the alpha of texture, factor and vertex colour |
//! | `KHR_materials_transmission` | hides nothing if its factor is not 0, or if it has a texture |
//! | `KHR_materials_volume`, `_diffuse_transmission`, `_dispersion` and all extensions of materials that are not listed here | hide nothing; with a warning, if they are not Khronos' |
//! | `KHR_materials_anisotropy`, `_clearcoat`, `_emissive_strength`, `_ior`, `_iridescence`, `_pbrSpecularGlossiness`, `_sheen`, `_specular`, `_unlit` | hides as without |
//! | `doubleSided` | hides from both sides; without it, and without a material, from the front only |
//! | a node that mirrors | the front stays on the same side of the object, as glTF says |
//! | primitives with different materials | one object, of which each primitive hides as its material says |
//! | `KHR_materials_variants` | hides from where all of its materials do |
//! | points, lines | hide nothing |
//! | `KHR_node_visibility` false | neither it nor what hangs from it is read |
//! | `KHR_animation_pointer` to that, or to a material | what it may change hides nothing |
//! | `KHR_animation_pointer` to the pose of a node or the weights of its mesh, and a motion by physics | it and what hangs from it is left out, with a warning: always draw it |
//! | `EXT_mesh_gpu_instancing` | each instance hides as its mesh; one that mirrors by itself hides only if it is double sided, as programs differ in which side they draw |
//! | a skin | hides nothing, and counts as one box around all poses of all frames, with a warning; always draw it beyond those |
//! | morph targets with weights that are not 0, or animated | hides nothing, and counts as the box of all its weights, with a warning |
//! | skins and morph targets without such a box: splines of weights, weights that are none, joints that are not in the scene, instances of skins; `KHR_gaussian_splatting` | left out, with a warning: always draw it |
//! | `MSFT_lod` | a node and its levels hide nothing, and the node counts as the box of all, with a warning; left out if they are more than still meshes in one place |
//! | `extras.role` | "occludee" hides nothing; "occluder" and "both" hide as the table says |
//! | a texture that is missing | counts as there: only its name is read |
//!
//! Skins and animated morph targets are dynamic, so that bakes leave them to run time.
//! [`World::source`](crate::world::World::source) holds the warnings, which tools print.
//! The path tracer of `casca-radiosity` reads the same of materials by code of its own.
//!
//! What a scene cannot do without is taken whole or refused. Accessors may share bytes, and may
//! have none, but a file that unfolds to more than four elements a byte of its buffers and a
//! million more, or to more than one element for each byte that was packed, is refused. Nodes may be nested in any depth.

mod accessors;
mod animations;
mod buffers;
mod container;
mod contents;
mod deformed;
mod document;
mod draco;
mod error;
mod hides;
mod instances;
mod mend;
mod meshes;
mod nodes;
mod origin;
mod packed;
mod path;
#[cfg(test)]
mod tests;
mod track;
mod warnings;

use std::path::Path;

use crate::world::World;
use contents::contents;
use document::parse;
use warnings::Warnings;

pub use error::{ImportError, Trouble};

/// The parts of the reader, for those that read more than casca needs: materials and lights
/// (`casca-radiosity`), coats and skins (`casca-fur`).
pub mod parts {
    pub use super::accessors::{Buffers, Components, unfit};
    pub use super::animations::{Keys, keys_of};
    pub use super::buffers::{Known, beside, decoded};
    pub use super::document::{File, QUANTIZATION, parse};
    pub use super::meshes::{Meshes, materials_of};
    pub use super::nodes::{Node, Nodes, check_rigid, nodes_of, wrong};
    pub use super::{contents::contents, hides::OPAQUE, track::Track, warnings::Warnings};
    pub use crate::numeric::AFFINE;
}

/// Loads a scene from a `.glb` or `.gltf` file; buffers in other files are looked for from its
/// folder. Warnings name the file.
///
/// # Errors
/// The first fault of a file that cannot be taken whole.
pub fn load(path: &Path) -> Result<World, ImportError> {
    let mut world = open(path, read)?;
    for line in &mut world.source.warnings {
        *line = format!("{}: {line}", path.display());
    }
    Ok(world)
}

/// Opens a file for a reader, which is given the file's name without its ending, its bytes and its
/// folder.
///
/// # Errors
/// Those of the reader, with the path.
pub fn open<T>(
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
    let warnings = Warnings::default();
    let file = parse(bytes, folder, &warnings)?;
    contents(name, &file, &warnings)
}
