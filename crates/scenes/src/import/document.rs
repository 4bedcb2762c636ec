//! Documents: parsed, and checked against the rules of the format.

use std::path::Path;

use super::accessors::Buffers;
use super::buffers::buffers_of;
use super::error::Trouble;
use super::instances::INSTANCING;

/// Coordinates may be integers.
pub(super) const QUANTIZATION: &str = "KHR_mesh_quantization";
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

/// Parses a file.
pub(super) fn parse(bytes: &[u8], folder: Option<&Path>) -> Result<(gltf::Document, Buffers), Trouble> {
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

/// Validates a document, with the rules that the validation of the glTF crate leaves out but takes
/// for granted.
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
