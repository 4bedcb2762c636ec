//! A character as a file: an animal with colours by vertex, an image, materials and a walk.

use std::io::Cursor;

use crate::error::Error;
use crate::mesh::Mesh;
use crate::skin::{Channel, Skeleton};
use casca_scenes::export::container;
use glam::{Vec2, Vec3};
use image::{ImageFormat, RgbImage};
use serde_json::{Value, json};

use super::animals::{Animal, Rig};

/// Texels along a side of the image.
const SIDE: u32 = 512;

/// Keys of the walk.
const KEYS: u16 = 16;

/// Component types of glTF.
const BYTE: u32 = 5121;
const SHORT: u32 = 5123;
const WORD: u32 = 5125;
const FLOAT: u32 = 5126;

/// The .glb of an animal, as a modelling program may write it: colours by vertex (`COLOR_0`),
/// stripes and a red collar as an image, lengths of fur as `_FURLENGTH`, a skin and a walk. The
/// material "coat" has fur; "eyes", which is that of the nose, too, is to be bald, but the file
/// does not say so. Seeds and details as [`Animal::new`].
///
/// # Errors
/// As [`Animal::new`].
pub fn character_glb(seed: u64, detail: u32) -> Result<Vec<u8>, Error> {
    let animal = Animal::new(seed, detail)?;
    let (mesh, rig) = (&animal.levels()[0], animal.rig());
    let mut file = File::default();
    let bare = |t: &&[u32; 3]| t.iter().all(|&v| mesh.coats()[v as usize].length < 0.1);
    let (eyes, coat): (Vec<&[u32; 3]>, Vec<&[u32; 3]>) = mesh.triangles().iter().partition(bare);
    let coat_part = file.primitive(mesh, rig, &coat, true);
    let eyes_part = file.primitive(mesh, rig, &eyes, false);
    let image = file.view(&png(mesh, rig));
    let (skin, nodes) = file.skeleton(&rig.skeleton);
    let mut all = vec![json!({"name": "character", "mesh": 0, "skin": 0})];
    all.extend(nodes);
    let (samplers, channels) = file.walk(rig);
    let document = json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": all,
        "meshes": [{"primitives": [coat_part, eyes_part]}],
        "materials": [
            {"name": "coat", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}},
            {"name": "eyes", "pbrMetallicRoughness": {"baseColorFactor": [0.01, 0.012, 0.015, 1.0]}}],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"wrapS": 33071, "wrapT": 33071}],
        "images": [{"bufferView": image, "mimeType": "image/png"}],
        "skins": [skin],
        "animations": [{"name": "walk", "samplers": samplers, "channels": channels}],
        "accessors": file.accessors,
        "bufferViews": file.views,
        "buffers": [{"byteLength": file.bytes.len()}],
    });
    let (what, count, max) = ("bytes of a file", file.bytes.len() as f64, u32::MAX as usize);
    container(document, file.bytes).ok_or(Error::TooMany { what, count, max })
}

/// The side of an animal on the image: seen from the side, head to the right. Both sides show the
/// same, so that there is no seam.
fn place(mesh: &Mesh, p: Vec3) -> Vec2 {
    let (lo, hi) = (mesh.aabb().min, mesh.aabb().max);
    Vec2::new((p.x - lo.x) / (hi.x - lo.x), 1.0 - (p.y - lo.y) / (hi.y - lo.y))
}

/// Stripes and a red collar.
fn png(mesh: &Mesh, rig: &Rig) -> Vec<u8> {
    let (lo, hi) = (mesh.aabb().min, mesh.aabb().max);
    // The neck is highest in front among the joints that hang from the trunk.
    let hangs = rig.skeleton.joints().iter().filter(|joint| joint.parent == Some(0));
    let neck = hangs.map(|joint| joint.rest.translation).max_by(|a, b| (a.x + a.y).total_cmp(&(b.x + b.y)));
    let neck = neck.unwrap_or_default();
    let image = RgbImage::from_fn(SIDE, SIDE, |x, y| {
        let uv = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / SIDE as f32;
        let p = Vec3::new(lo.x + uv.x * (hi.x - lo.x), hi.y - uv.y * (hi.y - lo.y), 0.0);
        let along = (p - neck).dot(Vec3::new(0.8, 0.6, 0.0));
        if (0.02..0.09).contains(&along) && p.y > neck.y - 0.25 {
            return image::Rgb([205, 20, 25]);
        }
        // No finer than the triangles of a coarse level, whose vertices have these colours.
        let wave = (15.0 * p.x + 1.2 * (5.0 * p.y).sin() + 0.5 * (11.0 * p.y + 3.0 * p.x).sin()).sin();
        if wave > 0.45 { image::Rgb([52, 40, 34]) } else { image::Rgb([255, 250, 240]) }
    });
    let mut bytes = Cursor::new(Vec::new());
    // Writing to memory fails for no picture of this size.
    image.write_to(&mut bytes, ImageFormat::Png).map_or(Vec::new(), |()| bytes.into_inner())
}

/// The parts of a file.
#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl File {
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.views.push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn accessor(&mut self, (component, kind): (u32, &str), count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let mut accessor =
            json!({"bufferView": view, "componentType": component, "count": count, "type": kind});
        if component == BYTE && kind == "VEC4" {
            accessor["normalized"] = json!(true);
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn floats(&mut self, kind: &str, count: usize, values: impl IntoIterator<Item = f32>) -> usize {
        let bytes: Vec<u8> = values.into_iter().flat_map(f32::to_le_bytes).collect();
        self.accessor((FLOAT, kind), count, &bytes)
    }

    /// Some triangles, with colours, lengths and places on the image if they are `painted`.
    fn primitive(&mut self, mesh: &Mesh, rig: &Rig, triangles: &[&[u32; 3]], painted: bool) -> Value {
        let mut used: Vec<u32> = triangles.iter().flat_map(|t| t.iter().copied()).collect();
        used.sort_unstable();
        used.dedup();
        let n = used.len();
        let indices: Vec<u8> = triangles
            .iter()
            .flat_map(|t| t.iter())
            .flat_map(|v| (used.binary_search(v).unwrap_or(0) as u32).to_le_bytes())
            .collect();
        let at = |v: &u32| mesh.vertices()[*v as usize].position;
        let (lo, hi) = used
            .iter()
            .map(at)
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
        let position = self.floats("VEC3", n, used.iter().flat_map(|v| at(v).to_array()));
        self.accessors[position]["min"] = json!(lo.to_array());
        self.accessors[position]["max"] = json!(hi.to_array());
        let weights = &rig.weights[0];
        let joints: Vec<u8> =
            used.iter().flat_map(|&v| weights.joints()[v as usize]).flat_map(u16::to_le_bytes).collect();
        let joints = self.accessor((SHORT, "VEC4"), n, &joints);
        let shares = self.floats("VEC4", n, used.iter().flat_map(|&v| weights.shares()[v as usize]));
        let mut attributes = json!({"POSITION": position, "JOINTS_0": joints, "WEIGHTS_0": shares});
        if painted {
            let coat = |v: &u32| mesh.coats()[*v as usize];
            let color = |v: &u32| coat(v).color.extend(1.0).to_array().map(|c| (255.0 * c).round() as u8);
            let colors: Vec<u8> = used.iter().flat_map(color).collect();
            attributes["COLOR_0"] = json!(self.accessor((BYTE, "VEC4"), n, &colors));
            attributes["_FURLENGTH"] = json!(self.floats("SCALAR", n, used.iter().map(|v| coat(v).length)));
            let places = used.iter().flat_map(|v| place(mesh, at(v)).to_array());
            attributes["TEXCOORD_0"] = json!(self.floats("VEC2", n, places));
        }
        let indices = self.accessor((WORD, "SCALAR"), 3 * triangles.len(), &indices);
        json!({"attributes": attributes, "indices": indices, "material": u32::from(!painted)})
    }

    /// The skin, and the nodes of its joints, which are those from 1 on.
    fn skeleton(&mut self, skeleton: &Skeleton) -> (Value, Vec<Value>) {
        let joints = skeleton.joints();
        let matrices = joints.iter().flat_map(|joint| glam::Mat4::from(joint.inverse_bind).to_cols_array());
        let matrices = self.floats("MAT4", joints.len(), matrices);
        let node = |number: usize| {
            let children: Vec<usize> = (0..joints.len())
                .filter(|&child| joints[child].parent == Some(number))
                .map(|c| c + 1)
                .collect();
            let rest = joints[number].rest;
            let mut node =
                json!({"translation": rest.translation.to_array(), "rotation": rest.rotation.to_array()});
            if !children.is_empty() {
                node["children"] = json!(children);
            }
            node
        };
        let of: Vec<usize> = (1..=joints.len()).collect();
        (json!({"joints": of, "inverseBindMatrices": matrices}), (0..joints.len()).map(node).collect())
    }

    fn walk(&mut self, rig: &Rig) -> (Vec<Value>, Vec<Value>) {
        let times = (0..=KEYS).map(|key| rig.walk.seconds() * f32::from(key) / f32::from(KEYS));
        let times: Vec<f32> = times.collect();
        let input = self.floats("SCALAR", times.len(), times.iter().copied());
        self.accessors[input]["min"] = json!([0.0]);
        self.accessors[input]["max"] = json!([rig.walk.seconds()]);
        let (mut samplers, mut channels) = (Vec::new(), Vec::new());
        for (joint, channel) in rig.walk.channels() {
            // Animals walk by turning their joints.
            let Channel::Rotation(track) = channel else { continue };
            let turns = times.iter().flat_map(|&time| track.at(time).to_array());
            let output = self.floats("VEC4", times.len(), turns);
            channels
                .push(json!({"sampler": samplers.len(), "target": {"node": joint + 1, "path": "rotation"}}));
            samplers.push(json!({"input": input, "output": output}));
        }
        (samplers, channels)
    }
}
