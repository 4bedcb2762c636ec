//! Documents: parsed, mended, and checked against the rules of the format.

use std::path::Path;

use gltf::json::{self, Root};
use serde_json::{Error, Map, Value, from_slice, from_value};

use super::accessors::Buffers;
use super::buffers::buffers_of;
use super::container::chunks;
use super::draco::{DRACO, unpack_primitives};
use super::error::Trouble;
use super::hides::VISIBILITY;
use super::instances::INSTANCING;
use super::mend::mend;
use super::nodes::Place;
use super::packed::{MESHOPT, unpack};
use super::warnings::Warnings;

/// Coordinates may be integers.
pub const QUANTIZATION: &str = "KHR_mesh_quantization";
/// Extensions that a file may require.
const UNDERSTOOD: [&str; 7] =
    [QUANTIZATION, INSTANCING, "KHR_animation_pointer", VISIBILITY, MESHOPT[0], MESHOPT[1], DRACO];
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
/// Faults of a file that are told one by one.
const TOLD: usize = 3;

/// A file that was parsed.
pub struct File<'a> {
    /// The text of the document, as it was.
    pub json: &'a [u8],
    /// What it says, mended and checked.
    pub document: gltf::Document,
    /// Its bytes.
    pub buffers: Buffers,
    /// By node: where it says that it is, as exactly as the text does.
    pub places: Vec<Place>,
}

/// Parses a file.
pub fn parse<'a>(bytes: &'a [u8], folder: Option<&Path>, warnings: &Warnings) -> Result<File<'a>, Trouble> {
    let (json, binary) = chunks(bytes)?;
    let mut root: Map<String, Value> =
        from_slice(json).map_err(|why| Trouble::Format(format!("its JSON: {why}")))?;
    mend(&mut root, warnings)?;
    let nodes = root.get("nodes").and_then(Value::as_array);
    let places = nodes.into_iter().flatten().map(Place::of).collect();
    let document = gltf::Document::from_json_without_validation(root_of(root)?);
    check_extensions(&document)?;
    check_rules(document.as_json())?;
    let mut buffers = unpack(&document, buffers_of(&document, binary.map(<[u8]>::to_vec), folder)?)?;
    let document = unpack_primitives(document, &mut buffers, warnings)?;
    Ok(File { json, document, buffers, places })
}

/// The typed parts of a document; what cannot be had is named by its place.
fn root_of(mut root: Map<String, Value>) -> Result<Root, Trouble> {
    let root = &mut root;
    let whole = |root: &mut Map<String, Value>, name: &str| root.remove(name).unwrap_or_default();
    Ok(Root {
        // Its version was checked, and nothing else of it is read.
        asset: json::Asset::default(),
        scene: part("scene", whole(root, "scene"), from_value)?,
        extensions: part("extensions", whole(root, "extensions"), from_value)?,
        extensions_used: list(root, "extensionsUsed", from_value)?,
        extensions_required: list(root, "extensionsRequired", from_value)?,
        accessors: list(root, "accessors", from_value)?,
        animations: list(root, "animations", from_value)?,
        buffers: list(root, "buffers", from_value)?,
        buffer_views: list(root, "bufferViews", from_value)?,
        cameras: list(root, "cameras", from_value)?,
        images: list(root, "images", from_value)?,
        materials: list(root, "materials", from_value)?,
        meshes: list(root, "meshes", from_value)?,
        nodes: list(root, "nodes", from_value)?,
        samplers: list(root, "samplers", from_value)?,
        scenes: list(root, "scenes", from_value)?,
        skins: list(root, "skins", from_value)?,
        textures: list(root, "textures", from_value)?,
        extras: None,
    })
}

fn list<T>(
    root: &mut Map<String, Value>,
    name: &str,
    read: fn(Value) -> Result<T, Error>,
) -> Result<Vec<T>, Trouble> {
    match root.remove(name) {
        None => Ok(Vec::new()),
        Some(Value::Array(items)) => {
            let item = |(i, value)| part(&format!("{name}[{i}]"), value, read);
            items.into_iter().enumerate().map(item).collect()
        }
        Some(_) => Err(Trouble::Format(format!("{name} is no list"))),
    }
}

fn part<T>(place: &str, value: Value, read: fn(Value) -> Result<T, Error>) -> Result<T, Trouble> {
    read(value).map_err(|why| Trouble::Format(format!("{place}: {why}")))
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
fn check_rules(root: &Root) -> Result<(), Trouble> {
    use gltf::json::Path;
    use gltf::json::validation::{Error, Validate};
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
    // Only now: it looks up the positions of meshes unchecked.
    if errors.is_empty() {
        root.validate(root, Path::new, &mut |path, error| errors.push((path(), error)));
    }
    errors.retain(|(path, error)| match error {
        // Extensions are checked on their own: the crate knows none of those that are read here.
        Error::Unsupported => false,
        // Boxes, positions and bytes that are not there are no fault.
        Error::Missing => {
            ![".min", ".max", ".bufferView", "[\"POSITION\"]"].iter().any(|end| path.0.ends_with(end))
        }
        Error::Invalid => !path.0.ends_with(".byteStride"),
        _ => true,
    });
    if errors.is_empty() {
        return Ok(());
    }
    let told: Vec<String> =
        errors.iter().take(TOLD).map(|(path, error)| format!("{path}: {error}")).collect();
    let more = match errors.len().saturating_sub(TOLD) {
        0 => String::new(),
        more => format!("; and {more} more"),
    };
    Err(Trouble::Format(told.join("; ") + &more))
}
