//! What other programs write and the crate `gltf` refuses, or takes for granted and panics at: it
//! is mended in the JSON, or left out, before that crate sees it. What is not read here may be
//! broken.

use std::collections::HashSet;

use gltf::json::extensions::scene::khr_lights_punctual::{Light, Type as LightType};
use gltf::json::validation::Checked;
use gltf::json::{Accessor, Camera, Material, camera};
use serde_json::{Error, Map, Value, from_value, json};

use super::error::Trouble;
use super::instances::INSTANCING;
use super::warnings::Warnings;

type Object = Map<String, Value>;

const LIGHTS: &str = "KHR_lights_punctual";

/// How textures repeat; the crate refuses other numbers.
const WRAPS: [u64; 3] = [33_071, 33_648, 10_497];
/// Attributes that are read, by how their names start; the first is needed.
const POSITION: &str = "POSITION";
const ATTRIBUTES: [&str; 5] = ["COLOR_", "TEXCOORD_", "JOINTS_", "WEIGHTS_", "_"];

/// Mends a document, as far as that changes nothing of what it shows.
pub(super) fn mend(root: &mut Object, warnings: &Warnings) -> Result<(), Trouble> {
    check_version(root)?;
    root.retain(|_, value| !value.is_null());
    root.values_mut().for_each(tidy);
    let views = each(root, "bufferViews", |_, view| {
        if let Some(members) = object(view) {
            // A stride of zero says nothing.
            members.retain(|name, value| name != "target" && (name != "byteStride" || *value != json!(0)));
        }
        true
    });
    let needed = needed(root);
    let accessors = each(root, "accessors", |i, accessor| {
        let sound = is_accessor(accessor, &views);
        // One that is needed is refused with its place.
        if !sound && !needed.contains(&i) {
            *accessor = json!({ "componentType": 5121, "type": "SCALAR", "count": 0 });
            warnings.add(format!("accessor {i}"), "is broken and left out");
        }
        sound
    });
    mend_looks(root, &views, warnings);
    each(root, "meshes", |_, mesh| mend_mesh(mesh, &accessors));
    each(root, "skins", |_, skin| object(skin).is_some_and(|skin| skin.remove("skeleton").is_some()));
    each(root, "scenes", |_, scene| {
        object(scene).is_some_and(|scene| scene.entry("nodes").or_insert(json!([])).is_array())
    });
    mend_nodes(root, warnings);
    mend_animations(root);
    Ok(())
}

/// Refuses versions other than 2.
fn check_version(root: &Object) -> Result<(), Trouble> {
    let text = |member: &str| match root.get("asset").and_then(|asset| asset.get(member)) {
        Some(Value::String(text)) => Some(text.clone()),
        Some(Value::Number(number)) => Some(format!("{:.1}", number.as_f64().unwrap_or(0.0))),
        _ => None,
    };
    // Its lists had names instead of numbers; its asset could be left away.
    let is_first =
        ["nodes", "meshes", "accessors"].iter().any(|l| root.get(*l).is_some_and(Value::is_object));
    let version = if is_first { Some("1.0".to_owned()) } else { text("version") };
    let least = text("minVersion").filter(|least| least != "2.0");
    match version {
        Some(version) if !version.starts_with("2.") && version != "2" => Err(Trouble::Version(version)),
        Some(_) => least.map_or(Ok(()), |least| Err(Trouble::Version(least))),
        None => Err(Trouble::Format("it has no asset with a version: is it glTF?".to_owned())),
    }
}

/// The items of a list; none if there is no such list.
fn list<'a>(root: &'a mut Object, name: &str) -> &'a mut [Value] {
    root.get_mut(name).and_then(Value::as_array_mut).map_or(&mut [], |items| items)
}

/// Mends each item of a list; says of which the answer was yes.
fn each(root: &mut Object, name: &str, mut mend: impl FnMut(usize, &mut Value) -> bool) -> Vec<bool> {
    list(root, name).iter_mut().enumerate().map(|(i, item)| mend(i, item)).collect()
}

fn object(value: &mut Value) -> Option<&mut Object> {
    value.as_object_mut()
}

/// Whether a value is the number of a sound item of a list.
fn is_one(value: &Value, sound: &[bool]) -> bool {
    value.as_u64().and_then(|i| sound.get(usize::try_from(i).ok()?)) == Some(&true)
}

/// Whether a member is such a number.
fn names(value: &Value, member: &str, sound: &[bool]) -> bool {
    value.get(member).is_some_and(|index| is_one(index, sound))
}

/// Whether a member is missing, or such a number.
fn may_name(value: &Value, member: &str, sound: &[bool]) -> bool {
    value.get(member).is_none() || names(value, member, sound)
}

/// Takes away what says nothing, members that are null and names that are no text, and writes whole
/// numbers as such: the crate takes no 5126.0 for 5126.
fn tidy(value: &mut Value) {
    match value {
        Value::Object(members) => {
            members.retain(|name, value| !value.is_null() && (name != "name" || value.is_string()));
            members.iter_mut().filter(|(name, _)| *name != "extras").for_each(|(_, value)| tidy(value));
        }
        Value::Array(items) => items.iter_mut().for_each(tidy),
        Value::Number(number) if number.is_f64() => {
            let float = number.as_f64().unwrap_or(0.5);
            // The numbers that a double counts without gaps.
            if float.fract() == 0.0 && (0.0..9e15).contains(&float) {
                *value = (float as u64).into();
            }
        }
        _ => {}
    }
}

/// Whether an item can be read alone, and its parts are known.
fn reads<T>(value: &Value, read: fn(Value) -> Result<T, Error>, is_known: impl Fn(&T) -> bool) -> bool {
    read(value.clone()).is_ok_and(|item| is_known(&item))
}

/// The accessors that a scene cannot do without: where things are, and how they move.
fn needed(root: &Object) -> HashSet<usize> {
    fn items(value: Option<&Value>) -> impl Iterator<Item = &Value> {
        value.and_then(Value::as_array).into_iter().flatten()
    }
    let primitives = items(root.get("meshes")).flat_map(|mesh| items(mesh.get("primitives")));
    let shapes = primitives.flat_map(|p| {
        let targets = items(p.get("targets")).map(|target| target.get(POSITION));
        targets.chain([p.pointer("/attributes/POSITION"), p.get("indices")])
    });
    let samplers = items(root.get("animations")).flat_map(|clip| items(clip.get("samplers")));
    let keys = samplers.flat_map(|sampler| [sampler.get("input"), sampler.get("output")]);
    let skins = items(root.get("skins")).map(|skin| skin.get("inverseBindMatrices"));
    let instances = items(root.get("nodes")).flat_map(|node| {
        let all = node.get("extensions").and_then(|e| e.get(INSTANCING)?.get("attributes")?.as_object());
        all.into_iter().flat_map(Object::values).map(Some)
    });
    let all = shapes.chain(keys).chain(skins).chain(instances).flatten();
    all.filter_map(|index| usize::try_from(index.as_u64()?).ok()).collect()
}

fn is_accessor(accessor: &mut Value, views: &[bool]) -> bool {
    if let Some(members) = object(accessor) {
        // Boxes are found from what is there.
        members.remove("min");
        members.remove("max");
    }
    let sparse = |part: &str| {
        let sparse = accessor.get("sparse");
        sparse.is_none_or(|sparse| sparse.get(part).is_some_and(|part| names(part, "bufferView", views)))
    };
    let is_known = |accessor: &Accessor| {
        let kinds = (&accessor.component_type, &accessor.type_);
        let indices = accessor.sparse.as_ref().map(|sparse| &sparse.indices.component_type);
        matches!(kinds, (Checked::Valid(_), Checked::Valid(_)))
            && indices.is_none_or(|kind| matches!(kind, Checked::Valid(_)))
    };
    may_name(accessor, "bufferView", views)
        && sparse("indices")
        && sparse("values")
        && reads(accessor, from_value::<Accessor>, is_known)
}

/// Images, textures and materials. An image without a source has an empty address, and so has the
/// one that textures without an image get.
fn mend_looks(root: &mut Object, views: &[bool], warnings: &Warnings) {
    let mut images = each(root, "images", |_, image| {
        let kind = image.get("mimeType").and_then(Value::as_str).unwrap_or("").to_owned();
        let name = image.get("name").cloned().unwrap_or(json!(""));
        let source = match image.get("uri").and_then(Value::as_str) {
            Some(uri) => json!({ "uri": uri, "name": name }),
            None if names(image, "bufferView", views) => {
                json!({ "bufferView": image["bufferView"], "mimeType": kind, "name": name })
            }
            None => json!({ "uri": "", "name": name }),
        };
        *image = source;
        true
    });
    let samplers = each(root, "samplers", |_, sampler| {
        let wrap = |way: &str| {
            let number = sampler.get(way).and_then(Value::as_u64).filter(|n| WRAPS.contains(n));
            number.unwrap_or(WRAPS[2])
        };
        *sampler = json!({ "wrapS": wrap("wrapS"), "wrapT": wrap("wrapT") });
        true
    });
    let none = images.len();
    let textures = each(root, "textures", |_, texture| {
        let own = Some(&*texture).filter(|texture| names(texture, "source", &images));
        let others = texture.get("extensions").and_then(Value::as_object);
        let other = || others.into_iter().flat_map(Object::values).find(|e| names(e, "source", &images));
        let source = own.or_else(other).map_or(json!(none), |from| from["source"].clone());
        let sampler = names(texture, "sampler", &samplers).then(|| texture["sampler"].clone());
        *texture = json!({ "source": source });
        if let (Some(sampler), Some(members)) = (sampler, object(texture)) {
            members.insert("sampler".to_owned(), sampler);
        }
        true
    });
    if !textures.is_empty() {
        images.push(true);
        let all = root.entry("images").or_insert(json!([]));
        all.as_array_mut().into_iter().for_each(|all| all.push(json!({ "uri": "" })));
    }
    each(root, "materials", |i, material| mend_material(i, material, &textures, warnings));
}

fn mend_material(number: usize, material: &mut Value, textures: &[bool], warnings: &Warnings) -> bool {
    if let Some(members) = object(material) {
        let is_sound = |i: &Value| names(i, "index", textures) && i.get("texCoord").is_none_or(Value::is_u64);
        let unused = ["normalTexture", "occlusionTexture"];
        members
            .retain(|name, i| !unused.contains(&name.as_str()) && (name != "emissiveTexture" || is_sound(i)));
        if let Some(pbr) = members.get_mut("pbrMetallicRoughness").and_then(object) {
            pbr.retain(|name, info| !name.ends_with("Texture") || is_sound(info));
        }
    }
    let is_known = |material: &Material| matches!(material.alpha_mode, Checked::Valid(_));
    let sound = reads(material, from_value::<Material>, is_known);
    if !sound {
        let name = material.get("name").cloned().unwrap_or(json!(""));
        // What is not known to be opaque is not.
        *material = json!({ "alphaMode": "BLEND", "name": name });
        warnings.add(format!("material {number} ({name})"), "is broken, and is taken as transparent");
    }
    sound
}

fn mend_mesh(mesh: &mut Value, accessors: &[bool]) -> bool {
    let Some(mesh) = object(mesh) else { return false };
    let primitives = mesh.entry("primitives").or_insert(json!([]));
    for primitive in primitives.as_array_mut().into_iter().flatten().filter_map(object) {
        let attributes = primitive.entry("attributes").or_insert(json!({}));
        if let Some(attributes) = object(attributes) {
            attributes.retain(|name, index| {
                let set = ATTRIBUTES.iter().find_map(|start| name.strip_prefix(start));
                let is_read = set.is_some_and(|set| name.starts_with('_') || set.parse::<u32>().is_ok());
                name == POSITION || is_read && is_one(index, accessors)
            });
        }
        let targets = primitive.get_mut("targets").and_then(Value::as_array_mut);
        for target in targets.into_iter().flatten().filter_map(object) {
            target.retain(|name, _| name == POSITION);
        }
    }
    true
}

fn mend_nodes(root: &mut Object, warnings: &Warnings) {
    let cameras = each(root, "cameras", |i, camera| {
        let is_known = |camera: &Camera| match camera.type_ {
            Checked::Valid(camera::Type::Perspective) => camera.perspective.is_some(),
            Checked::Valid(camera::Type::Orthographic) => camera.orthographic.is_some(),
            Checked::Invalid => false,
        };
        let sound = reads(camera, from_value::<Camera>, is_known);
        if !sound {
            *camera = json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 1 } });
            warnings.add(format!("camera {i}"), "is broken and left out");
        }
        sound
    });
    let lights = mend_lights(root, warnings);
    each(root, "nodes", |_, node| {
        let has_camera = may_name(node, "camera", &cameras);
        let Some(node) = object(node) else { return false };
        if !has_camera {
            node.remove("camera");
        }
        if let Some(extensions) = node.get_mut("extensions").and_then(object) {
            extensions.retain(|name, value| name != LIGHTS || names(value, "light", &lights));
        }
        true
    });
}

fn mend_lights(root: &mut Object, warnings: &Warnings) -> Vec<bool> {
    let Some(extensions) = root.get_mut("extensions").and_then(object) else { return Vec::new() };
    let Some(lights) = extensions.get_mut(LIGHTS).and_then(object) else {
        extensions.remove(LIGHTS);
        return Vec::new();
    };
    let is_known = |light: &Light| match light.type_ {
        Checked::Valid(LightType::Spot) => light.spot.is_some(),
        Checked::Valid(_) => true,
        Checked::Invalid => false,
    };
    if !lights.get("lights").is_some_and(Value::is_array) {
        lights.insert("lights".to_owned(), json!([]));
    }
    each(lights, "lights", |i, light| {
        let sound = reads(light, from_value::<Light>, is_known);
        if !sound {
            *light = json!({ "type": "point" });
            warnings.add(format!("light {i}"), "is broken and left out");
        }
        sound
    })
}

/// Leaves out channels without a node: [`Changes`](super::hides::Changes) asks what they change.
fn mend_animations(root: &mut Object) {
    each(root, "animations", |_, animation| {
        let Some(animation) = object(animation) else { return false };
        animation.entry("samplers").or_insert(json!([]));
        let channels = animation.entry("channels").or_insert(json!([]));
        let Some(channels) = channels.as_array_mut() else { return false };
        channels.retain(|channel| {
            let target = channel.get("target").and_then(Value::as_object);
            target.is_none_or(|t| t.contains_key("node") && t.get("path") != Some(&json!("pointer")))
        });
        true
    });
}
