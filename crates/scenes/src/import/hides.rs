//! What of a file hides what is behind it: only what is drawn opaque in each case, from the side
//! from which it is drawn. See the table of [`super`].

use std::collections::BTreeSet;

use gltf::material::AlphaMode;
use serde_json::Value;

use super::warnings::Warnings;
use crate::world::Sides;

/// Extensions of materials that let no light through. One that is not known may do so.
pub const OPAQUE: [&str; 10] = [
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_unlit",
    "KHR_xmp_json_ld",
];
const TRANSMISSION: &str = "KHR_materials_transmission";
const VARIANTS: &str = "KHR_materials_variants";
pub(super) const VISIBILITY: &str = "KHR_node_visibility";
const POINTER: &str = "KHR_animation_pointer";
const LEVELS: &str = "MSFT_lod";
const SPLATS: &str = "KHR_gaussian_splatting";

/// What animations change beside the poses of nodes and the weights of their meshes.
#[derive(Debug, Default)]
pub(super) struct Changes {
    materials: BTreeSet<usize>,
    /// Nodes that are shown and hidden.
    shown: BTreeSet<usize>,
    /// Nodes that are moved, or whose mesh is deformed, in a way that is not read.
    moved: BTreeSet<usize>,
    /// Meshes that are deformed so.
    deformed: BTreeSet<usize>,
}

impl Changes {
    /// What the pointers of `KHR_animation_pointer` lead to. They are looked for in the JSON
    /// itself: their channels have no node.
    pub(super) fn of(json: &[u8]) -> Self {
        let mut changes = Self::default();
        let named = json.windows(POINTER.len()).any(|part| part == POINTER.as_bytes());
        let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
        let Some(root) = named.then(|| serde_json::from_slice::<Value>(json).ok()).flatten() else {
            return changes;
        };
        let list = |value: &Value, name: &str| value[name].as_array().cloned().unwrap_or_default();
        for channel in list(&root, "animations").iter().flat_map(|a| list(a, "channels")) {
            let pointer = &channel["target"]["extensions"][POINTER]["pointer"];
            let mut path = pointer.as_str().unwrap_or("").split('/').skip(1);
            let (what, index) = (path.next(), path.next().and_then(|i| i.parse().ok()));
            let Some(index) = index else { continue };
            match (what, path.next()) {
                (Some("materials"), _) => changes.materials.insert(index),
                (Some("nodes"), Some("extensions")) if path.next() == Some(VISIBILITY) => {
                    changes.shown.insert(index)
                }
                (Some("nodes"), Some("translation" | "rotation" | "scale" | "matrix" | "weights")) => {
                    changes.moved.insert(index)
                }
                (Some("meshes"), Some("weights")) => changes.deformed.insert(index),
                _ => false,
            };
        }
        changes
    }

    /// From where a primitive hides, whichever of its materials it has.
    pub(super) fn sides_of(
        &self,
        document: &gltf::Document,
        primitive: &gltf::Primitive,
        warnings: &Warnings,
    ) -> Sides {
        let mappings = primitive.extension_value(VARIANTS).and_then(|v| v["mappings"].as_array());
        let others = mappings.into_iter().flatten().map(|mapping| {
            let index = mapping["material"].as_u64().and_then(|i| usize::try_from(i).ok());
            index.and_then(|i| document.materials().nth(i))
        });
        let own = self.sides(&primitive.material(), warnings);
        others.fold(own, |sides, other| match (sides, other.map(|m| self.sides(&m, warnings))) {
            (Sides::Neither, _) | (_, None | Some(Sides::Neither)) => Sides::Neither,
            (Sides::Both, Some(Sides::Both)) => Sides::Both,
            _ => Sides::Front,
        })
    }

    fn sides(&self, material: &gltf::Material, warnings: &Warnings) -> Sides {
        let changes = material.index().is_some_and(|i| self.materials.contains(&i));
        if material.alpha_mode() != AlphaMode::Opaque || changes {
            return Sides::Neither;
        }
        for (name, value) in material.extensions().into_iter().flatten() {
            let factor = value["transmissionFactor"].as_f64().unwrap_or(0.0);
            let passes = factor != 0.0 || value.get("transmissionTexture").is_some();
            match name.as_str() {
                TRANSMISSION if !passes => {}
                name if OPAQUE.contains(&name) => {}
                name => {
                    let (number, own) = (material.index().unwrap_or(0), material.name().unwrap_or(""));
                    if !name.starts_with("KHR_materials_") {
                        let what = format!("has {name}, which is not read: what it is on hides nothing");
                        warnings.add(format!("material {number} ({own:?})"), &what);
                    }
                    return Sides::Neither;
                }
            }
        }
        if material.double_sided() { Sides::Both } else { Sides::Front }
    }

    /// Whether a node is surely drawn as it is, its children aside; `None` if it is hidden.
    pub(super) fn draws(&self, node: &gltf::Node) -> Option<bool> {
        let visible = node.extension_value(VISIBILITY).and_then(|v| v["visible"].as_bool()).unwrap_or(true);
        let changes = self.shown.contains(&node.index());
        (visible || changes).then(|| !changes && node.extension_value(LEVELS).is_none())
    }

    /// Whether a node is moved, or its mesh deformed, in a way that is not read; its parents aside.
    pub(super) fn moves(&self, node: &gltf::Node) -> bool {
        // As KHR_physics_rigid_bodies and its like have it.
        let by_physics = |value: &Value| value["motion"].is_object() && value["motion"]["type"] != "static";
        self.moved.contains(&node.index())
            || node.mesh().is_some_and(|mesh| self.deformed.contains(&mesh.index()))
            || node.extensions().into_iter().flatten().any(|(_, value)| by_physics(value))
    }
}

/// The nodes in whose place a node may be drawn, farther away; `None` stands for one that is not there.
pub(super) fn levels_of<'a>(
    document: &'a gltf::Document,
    node: &gltf::Node,
) -> impl Iterator<Item = Option<gltf::Node<'a>>> {
    let ids = node.extension_value(LEVELS).and_then(|levels| levels["ids"].as_array());
    let level = |id: &Value| document.nodes().nth(usize::try_from(id.as_u64()?).ok()?);
    ids.into_iter().flatten().map(level)
}

/// Whether points of a mesh stand for more than points.
pub(super) fn has_splats(mesh: &gltf::Mesh) -> bool {
    mesh.primitives().any(|p| p.extension_value(SPLATS).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pointers_of_animations_are_found_in_the_json() {
        let channel = |pointer: &str| {
            let extension = serde_json::json!({ POINTER: { "pointer": pointer } });
            serde_json::json!({ "sampler": 0, "target": { "path": "pointer", "extensions": extension } })
        };
        let pointers = [
            "/nodes/3/extensions/KHR_node_visibility/visible",
            "/nodes/4/rotation",
            "/nodes/5/weights",
            "/meshes/8/weights/0",
            "/materials/6/pbrMetallicRoughness/baseColorFactor",
            "/cameras/7/perspective/yfov",
            "/nodes/x/scale",
            "",
        ];
        let channels: Vec<Value> = pointers.iter().map(|p| channel(p)).collect();
        let json = serde_json::json!({ "animations": [{ "channels": channels }] }).to_string();
        let changes = Changes::of(format!("\u{feff}{json}").as_bytes());
        let found = [&changes.shown, &changes.moved, &changes.materials, &changes.deformed];
        assert_eq!(found, [&[3].into(), &[4, 5].into(), &[6].into(), &[8].into()]);
        assert!(Changes::of(b"no JSON, KHR_animation_pointer").moved.is_empty());
    }
}
