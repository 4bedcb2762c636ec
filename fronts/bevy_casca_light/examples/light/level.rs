//! Two rooms with a door between them and a lamp in the first, as a glTF file.

use std::error::Error;

use bevy::camera::primitives::{Aabb, CubemapFrusta};
use bevy::camera::visibility::{CubemapVisibleEntities, VisibilityClass};
use bevy::gltf::{GltfExtras, GltfMaterialName, GltfMeshName, GltfSceneExtras};
use bevy::light::{IrradianceVolume, LightProbe};
use bevy::math::vec3;
use bevy::pbr::Lightmap;
use bevy::prelude::*;
use bevy::transform::components::TransformTreeChanged;
use casca_scenes::export::container;
use serde_json::{Value, json};

/// The corners of a quad, counter-clockwise seen from its front.
type Quad = [Vec3; 4];

/// Where the door is when it is open: within the wall.
pub const OPEN: Vec3 = vec3(0.0, 0.0, -1.05);

/// The faces of a box, seen from outside.
fn cuboid(a: Vec3, b: Vec3) -> Vec<Quad> {
    let at = |x: usize, y: usize, z: usize| vec3([a, b][x].x, [a, b][y].y, [a, b][z].z);
    let faces = [
        [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]],
        [[1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1]],
        [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]],
        [[0, 1, 0], [0, 1, 1], [1, 1, 1], [1, 1, 0]],
        [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]],
        [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
    ];
    faces.map(|face| face.map(|[x, y, z]| at(x, y, z))).to_vec()
}

/// A face of a box, seen from inside.
fn inside(a: Vec3, b: Vec3, face: usize) -> Vec<Quad> {
    let mut quad = cuboid(a, b)[face];
    quad.swap(1, 3);
    vec![quad]
}

/// The file. From x = -4 to 0 is the first room and from 0.2 to 4.2 the second, whose walls at the least and
/// the greatest z are red and green. The door has an animation, so that it gets no lightmap.
pub fn level() -> Result<Vec<u8>, Box<dyn Error>> {
    let (low, high, mid) = (vec3(-4.0, 0.0, 0.0), vec3(4.2, 2.5, 4.0), 0.1);
    let (first, second) = (vec3(mid, high.y, high.z), vec3(mid, low.y, low.z));
    let boxes: [(f32, Vec3, Vec3); 5] = [
        (0.7, vec3(0.0, 0.0, 0.0), vec3(0.2, 2.5, 1.5)),
        (0.7, vec3(0.0, 0.0, 2.5), vec3(0.2, 2.5, 4.0)),
        (0.7, vec3(0.0, 2.0, 1.5), vec3(0.2, 2.5, 2.5)),
        (0.5, vec3(-1.7, 0.0, 0.5), vec3(-1.2, 1.2, 1.0)),
        (0.5, vec3(3.2, 0.0, 2.7), vec3(3.9, 0.6, 3.6)),
    ];
    let (grey, red, green, blue) =
        (vec3(0.7, 0.7, 0.7), vec3(0.7, 0.05, 0.05), vec3(0.06, 0.6, 0.06), vec3(0.1, 0.15, 0.7));
    let mut parts = vec![
        ("floor", inside(low, high, 2), grey),
        ("ceiling", inside(low, high, 3), grey),
        ("far", inside(low, high, 0), grey),
        ("blue", inside(low, high, 1), blue),
        ("left", inside(low, first, 4), grey),
        ("right", inside(low, first, 5), grey),
        ("red", inside(second, high, 4), red),
        ("green", inside(second, high, 5), green),
    ];
    parts.extend(boxes.map(|(albedo, a, b)| ("box", cuboid(a, b), Vec3::splat(albedo))));
    parts.push(("door", cuboid(vec3(0.05, 0.0, 1.5), vec3(0.15, 2.0, 2.5)), vec3(0.5, 0.35, 0.2)));

    let mut file = File::default();
    let (mut meshes, mut nodes, mut materials) = (Vec::new(), Vec::new(), Vec::new());
    for (i, (name, quads, color)) in parts.iter().enumerate() {
        let of = |q: &Quad| [(q[1] - q[0]).cross(q[2] - q[0]).normalize(); 4];
        let normals: Vec<Vec3> = quads.iter().flat_map(of).collect();
        let corners = |q: u32| [0, 1, 2, 0, 2, 3].map(|c| 4 * q + c);
        let indices: Vec<u8> = (0..quads.len() as u32).flat_map(corners).flat_map(u32::to_le_bytes).collect();
        let (position, normal) = (file.vectors(quads.as_flattened()), file.vectors(&normals));
        let indices = file.accessor(&indices, 5125, "SCALAR", 4, json!({}));
        meshes.push(json!({"primitives": [{"attributes": {"POSITION": position, "NORMAL": normal},
            "indices": indices, "material": i}]}));
        materials.push(json!({"pbrMetallicRoughness": {"metallicFactor": 0.0,
            "baseColorFactor": color.extend(1.0).to_array()}}));
        nodes.push(json!({"mesh": i, "name": name}));
    }
    let door = nodes.len() - 1;
    nodes[door]["translation"] = json!(OPEN.to_array());
    let times: Vec<u8> = [0.0_f32, 1.0].iter().flat_map(|t| t.to_le_bytes()).collect();
    let input = file.accessor(&times, 5126, "SCALAR", 4, json!({"min": [0.0], "max": [1.0]}));
    let output = file.vectors(&[OPEN, Vec3::ZERO]);
    nodes.push(json!({"translation": [-2.0, 2.1, 3.7], "extensions": {"KHR_lights_punctual": {"light": 0}}}));
    let all: Vec<usize> = (0..nodes.len()).collect();
    let document = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": all}], "nodes": nodes, "meshes": meshes,
        "materials": materials, "accessors": file.accessors, "bufferViews": file.views,
        "buffers": [{"byteLength": file.bytes.len()}],
        "animations": [{"channels": [{"sampler": 0, "target": {"node": door, "path": "translation"}}],
            "samplers": [{"input": input, "output": output}]}],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 20.0}]}},
    });
    container(document, file.bytes).ok_or_else(|| "the level is too large".into())
}

/// Registers what scenes of files are copied by: the feature `reflect_auto_register` of Bevy's, which most
/// apps have, would build another Bevy.
pub fn register(app: &mut App) {
    app.register_type::<Name>().register_type::<Children>().register_type::<ChildOf>();
    app.register_type::<Transform>()
        .register_type::<GlobalTransform>()
        .register_type::<TransformTreeChanged>();
    app.register_type::<Visibility>().register_type::<InheritedVisibility>();
    app.register_type::<ViewVisibility>().register_type::<VisibilityClass>();
    app.register_type::<Mesh3d>().register_type::<MeshMaterial3d<StandardMaterial>>().register_type::<Aabb>();
    app.register_type::<GltfMeshName>().register_type::<GltfMaterialName>();
    app.register_type::<GltfExtras>().register_type::<GltfSceneExtras>();
    app.register_type::<PointLight>().register_type::<CubemapFrusta>();
    app.register_type::<CubemapVisibleEntities>();
    app.register_type::<LightProbe>().register_type::<IrradianceVolume>().register_type::<Lightmap>();
}

#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl File {
    fn accessor(&mut self, bytes: &[u8], kind: u32, shape: &str, size: usize, more: Value) -> usize {
        self.views.push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend(bytes);
        let mut text = json!({"bufferView": self.views.len() - 1, "componentType": kind, "type": shape,
            "count": bytes.len() / size});
        for (name, value) in more.as_object().into_iter().flatten() {
            text[name] = value.clone();
        }
        self.accessors.push(text);
        self.accessors.len() - 1
    }

    fn vectors(&mut self, all: &[Vec3]) -> usize {
        let bytes: Vec<u8> = all.iter().flat_map(|v| v.to_array()).flat_map(f32::to_le_bytes).collect();
        let low = all.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = all.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        self.accessor(&bytes, 5126, "VEC3", 12, json!({"min": low.to_array(), "max": high.to_array()}))
    }
}
