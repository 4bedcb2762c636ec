//! Files whose materials, nodes and variants let one see through: what the importer makes of them,
//! against a truth that reads the file by itself.

use std::sync::Arc;

use casca::Query;
use casca_scenes::drive::{Driver, view_of};
use casca_scenes::import;
use casca_scenes::world::{Camera, Mesh, Shape, World};
use casca_truth::oracle::{Oracle, OracleOptions, Seen};
use glam::Vec3;
use parts::{bytes_of, glb};
use serde_json::{Value, json};

#[path = "../../scenes/src/import/tests/parts.rs"]
mod parts;

/// How far lanes are apart, in metres: more than one sees of the next.
const APART: f32 = 60.0;

/// A sheet of 6 m across z = 0 whose front is at +z, with a cube 3 m before it and one 3 m behind.
#[derive(Clone)]
struct Lane {
    name: &'static str,
    primitives: Vec<Value>,
    materials: Vec<Value>,
    /// What is said of its node.
    node: Value,
    /// Whether the cube behind is hidden from before the front, and the one before from behind.
    hides: [bool; 2],
    /// The same, as casca finds it: where it is doubtful, less is hidden.
    found: [bool; 2],
}

const NONE: [bool; 2] = [false; 2];
const FRONT: [bool; 2] = [true, false];
const BACK: [bool; 2] = [false, true];
const BOTH: [bool; 2] = [true; 2];

fn lane(name: &'static str, material: Value, hides: [bool; 2]) -> Lane {
    let primitives = vec![json!({ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 })];
    Lane { name, primitives, materials: vec![material], node: json!({}), hides, found: hides }
}

fn extension(name: &str, value: Value) -> Value {
    json!({ "doubleSided": true, "extensions": { name: value } })
}

fn transmission(value: Value) -> Value {
    extension("KHR_materials_transmission", value)
}

/// Two halves of a sheet with a material each.
fn halves(name: &'static str, second: Value, hides: [bool; 2]) -> Lane {
    let half = |i: usize| json!({ "attributes": { "POSITION": 0 }, "indices": 4 + i, "material": i });
    let materials = vec![json!({ "doubleSided": true }), second];
    Lane { primitives: vec![half(0), half(1)], materials, ..lane(name, json!({}), hides) }
}

fn of_materials() -> Vec<Lane> {
    let both = json!({ "doubleSided": true });
    let blend = json!({ "alphaMode": "BLEND", "doubleSided": true });
    let mut plain = lane("default material", json!({}), FRONT);
    plain.primitives[0].as_object_mut().unwrap().remove("material");
    let mut faded = lane("a vertex colour with alpha 0, but OPAQUE", both.clone(), BOTH);
    faded.primitives[0]["attributes"]["COLOR_0"] = json!(6);
    let mut variants = lane("a variant of glass", both.clone(), NONE);
    let mappings = json!([{ "material": 1, "variants": [0] }]);
    variants.primitives[0]["extensions"] = json!({ "KHR_materials_variants": { "mappings": mappings } });
    variants.materials.push(blend.clone());
    let doubtful = |name, material| Lane { found: NONE, ..lane(name, material, BOTH) };
    let factor = json!({ "diffuseTransmissionFactor": 0.2 });
    vec![
        plain,
        lane("double sided", both, BOTH),
        lane("single sided", json!({}), FRONT),
        lane("BLEND", blend.clone(), NONE),
        lane("MASK", json!({ "alphaMode": "MASK", "doubleSided": true }), NONE),
        lane("transmission", transmission(json!({ "transmissionFactor": 0.5 })), NONE),
        lane("transmission of 0", transmission(json!({ "transmissionFactor": 0 })), BOTH),
        lane("diffuse transmission", extension("KHR_materials_diffuse_transmission", factor), NONE),
        lane("unlit", extension("KHR_materials_unlit", json!({})), BOTH),
        faded,
        halves("half glass", blend, NONE),
        halves("half from both sides, half from the front", json!({}), FRONT),
        variants,
        doubtful("a volume alone", extension("KHR_materials_volume", json!({}))),
        doubtful("an extension nobody knows", extension("ACME_ghost", json!({}))),
        doubtful("a texture of transmission", transmission(json!({ "transmissionTexture": { "index": 0 } }))),
    ]
}

fn of_nodes() -> Vec<Lane> {
    // All but those with a mesh of their own share one.
    let with = |name, node: Value, hides| Lane { node, ..lane(name, json!({}), hides) };
    let own =
        |name: &'static str, node: Value, hides| Lane { node, ..lane(name, json!({ "name": name }), hides) };
    let visible = |visible: bool| json!({ "extensions": { "KHR_node_visibility": { "visible": visible } } });
    let moves = json!({ "moves": true });
    let mut levels = with("levels of detail", json!({ "extensions": { "MSFT_lod": { "ids": [] } } }), FRONT);
    levels.found = NONE;
    vec![
        with("hidden", visible(false), NONE),
        with("shown", visible(true), FRONT),
        // The front stays on the same side of the object, which z turns round.
        with("mirrored along z", json!({ "scale": [1, 1, -1] }), BACK),
        with("mirrored along x", json!({ "scale": [-1, 1, 1] }), FRONT),
        with("mirrored and turned", json!({ "scale": [1, 1, -1], "rotation": [0, 1, 0, 0] }), FRONT),
        with("mirrored, and smaller", json!({ "scale": [0.9, 0.9, -0.9] }), BACK),
        with("stretched", json!({ "scale": [2, 1, 1] }), FRONT),
        with("mirrored, and moves", json!({ "scale": [1, 1, -1], "extras": moves }), BACK),
        own("mirrored, and moves alone", json!({ "scale": [1, 1, -1], "extras": moves }), BACK),
        own("moves alone", json!({ "extras": moves }), FRONT),
        own("mirrored alone", json!({ "scale": [1, 1, -1] }), BACK),
        own("alone", json!({}), FRONT),
        levels,
        with("an occludee", json!({ "extras": { "role": "occludee" } }), NONE),
    ]
}

/// A file in the making.
#[derive(Default)]
struct File {
    bin: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    nodes: Vec<Value>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    channels: Vec<Value>,
    samplers: Vec<Value>,
}

impl File {
    fn put(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        self.views.push(json!({ "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len() }));
        self.accessors.push(json!({ "bufferView": self.views.len() - 1, "componentType": component,
            "type": kind, "count": count, "min": [-9, -9, -9], "max": [9, 9, 9] }));
        self.bin.extend(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.accessors.len() - 1
    }

    /// With a sheet, a cube and what else lanes name by number.
    fn new() -> Self {
        let mut file = Self::default();
        let cube = Mesh::cuboid(Vec3::splat(-0.3), Vec3::splat(0.3));
        let corners: Vec<f32> = cube.positions.iter().flat_map(|p| p.to_array()).collect();
        let triangles: Vec<u8> = cube.triangles.iter().flatten().map(|&v| v as u8).collect();
        let sheet = bytes_of(&[-3.0, -3.0, 0.0, 3.0, -3.0, 0.0, 3.0, 3.0, 0.0, -3.0, 3.0, 0.0]);
        file.put(&sheet, 5126, "VEC3", 4);
        file.put(&[0, 1, 2, 0, 2, 3], 5121, "SCALAR", 6);
        file.put(&bytes_of(&corners), 5126, "VEC3", 8);
        file.put(&triangles, 5121, "SCALAR", 36);
        file.put(&[0, 1, 2], 5121, "SCALAR", 3);
        file.put(&[0, 2, 3], 5121, "SCALAR", 3);
        file.put(&[255, 255, 255, 0].repeat(4), 5121, "VEC4", 4);
        file.accessors[6]["normalized"] = json!(true);
        file.put(&bytes_of(&[0.0, 10.0]), 5126, "SCALAR", 2);
        file.meshes.push(json!({ "primitives": [{ "attributes": { "POSITION": 2 }, "indices": 3 }] }));
        file
    }

    /// The mesh of a lane, with its materials; one that is there already is shared.
    fn mesh(&mut self, lane: &Lane) -> usize {
        let first = self.materials.windows(lane.materials.len()).position(|known| known == lane.materials);
        let first = first.unwrap_or(self.materials.len());
        if first == self.materials.len() {
            self.materials.extend(lane.materials.clone());
        }
        let mut primitives = lane.primitives.clone();
        let mapping = "/extensions/KHR_materials_variants/mappings/0/material";
        for primitive in &mut primitives {
            for at in ["/material", mapping] {
                if let Some(index) = primitive.pointer_mut(at) {
                    *index = json!(first + index.as_u64().unwrap() as usize);
                }
            }
        }
        let mesh = json!({ "primitives": primitives });
        let known = self.meshes.iter().position(|known| *known == mesh);
        known.unwrap_or_else(|| {
            self.meshes.push(mesh);
            self.meshes.len() - 1
        })
    }

    /// A lane, at the next place along x.
    fn lane(&mut self, lane: &Lane, x: f32) {
        for z in [-3, 3] {
            let name = format!("{} at {z}", lane.name);
            self.nodes.push(json!({ "mesh": 0, "translation": [x, 0, z], "name": name }));
        }
        let mut node = lane.node.clone();
        node["mesh"] = json!(self.mesh(lane));
        node["name"] = json!(lane.name);
        node["translation"] = json!([x, 0, 0]);
        if node["extras"]["moves"] == true {
            let output = self.put(&bytes_of(&[x, 0.0, 0.0, x + 1.0, 0.0, 0.0]), 5126, "VEC3", 2);
            let target = json!({ "node": self.nodes.len(), "path": "translation" });
            self.channels.push(json!({ "sampler": self.samplers.len(), "target": target }));
            self.samplers.push(json!({ "input": 7, "output": output }));
        }
        self.nodes.push(node);
    }

    fn bytes(&self) -> Vec<u8> {
        let all: Vec<usize> = (0..self.nodes.len()).collect();
        let mut json = json!({ "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": all }],
            "nodes": self.nodes, "meshes": self.meshes, "materials": self.materials,
            "accessors": self.accessors, "bufferViews": self.views,
            "textures": [{ "source": 0 }], "images": [{ "uri": "none.png" }],
            "buffers": [{ "byteLength": self.bin.len() }] });
        if !self.channels.is_empty() {
            json["animations"] = json!([{ "channels": self.channels, "samplers": self.samplers }]);
        }
        glb(&json.to_string(), &self.bin)
    }
}

/// The world of all lanes, side by side along x.
fn world(lanes: &[Lane]) -> World {
    let mut file = File::new();
    for (i, lane) in lanes.iter().enumerate() {
        file.lane(lane, i as f32 * APART);
    }
    import::read("lanes", &file.bytes(), None).unwrap()
}

fn options() -> OracleOptions {
    OracleOptions { width: 160, height: 90, samples_per_object: 8, ..OracleOptions::default() }
}

/// By lane, whether the farther cube is shown from the front and from the back: by casca and by the
/// truth. Also how many visible objects casca lacks in all.
fn look(world: &mut World, lanes: &[Lane]) -> (Vec<[[bool; 2]; 2]>, usize) {
    let moved = world.set_frame(30);
    // What is in the cell of the eye is not tested.
    let mut driver = Driver::new(world, 0.5, |_| ()).unwrap();
    driver.update(&world.objects, &moved).unwrap();
    let mut seen = Seen::of(world);
    let mut oracle = Oracle::new(seen.objects(&world.objects), options());
    let mut query = Query::new();
    let (mut all, mut lost) = (Vec::new(), 0);
    for (i, lane) in lanes.iter().enumerate() {
        let shown = [2.0, -2.0].map(|z| {
            let eye = Vec3::new(i as f32 * APART, 0.0, z);
            let camera = Camera::look_at(eye, eye - Vec3::Z * z, 40.0, 16.0 / 9.0, 0.05, 30.0);
            let pvs = query.run(&driver.scene, &view_of(&camera).unwrap());
            let objects = seen.follow(&world.objects, &moved);
            let verdict = oracle.frame(objects, &moved, &camera, &|object| driver.sees(pvs, object));
            lost += verdict.false_negatives.len();
            let name = format!("{} at {}", lane.name, -1.5 * z);
            let target = world.objects.iter().position(|o| o.name == name).unwrap();
            [driver.sees(pvs, target), verdict.exact.contains(&target)]
        });
        all.push(shown);
    }
    (all, lost)
}

#[test]
fn only_what_is_drawn_opaque_hides_and_only_from_where_it_is_drawn() {
    for lanes in [of_materials(), of_nodes()] {
        let (all, lost) = look(&mut world(&lanes), &lanes);
        let mut wrong = Vec::new();
        for (lane, shown) in lanes.iter().zip(all) {
            for (side, from) in ["front", "back"].into_iter().enumerate() {
                let wanted = [!lane.found[side], !lane.hides[side]];
                if shown[side] != wanted {
                    wrong.push((lane.name, from, shown[side], wanted));
                }
            }
        }
        assert!(wrong.is_empty(), "what casca and the truth show, and should: {wrong:#?}");
        assert_eq!(lost, 0);
    }
}

#[test]
fn the_truth_does_not_believe_an_importer_that_lets_all_hide() {
    for (lanes, least) in [(of_materials(), 9), (of_nodes(), 5)] {
        let mut world = world(&lanes);
        for object in &mut world.objects {
            let Shape::Mesh { mesh, .. } = &mut object.shape else { continue };
            *mesh = Arc::new(Mesh { sides: Vec::new(), ..Mesh::clone(mesh) });
            object.occludes = true;
        }
        let (_, lost) = look(&mut world, &lanes);
        assert!(lost >= least, "{lost}");
    }
}

#[test]
fn what_stands_behind_many_panes_is_seen_and_so_is_each_pane() {
    let mut file = File::new();
    file.lane(&lane("pane", json!({ "alphaMode": "BLEND" }), NONE), 0.0);
    for i in 1..8 {
        let mut pane = file.nodes[2].clone();
        pane["translation"] = json!([0, 0, -0.3 * f64::from(i)]);
        file.nodes.push(pane);
    }
    let world = import::read("panes", &file.bytes(), None).unwrap();
    let camera = Camera::look_at(Vec3::Z * 2.0, Vec3::ZERO, 40.0, 16.0 / 9.0, 0.05, 30.0);
    let seen = Seen::of(&world);
    let objects = seen.objects(&world.objects);
    let verdict = Oracle::new(objects, options()).frame(objects, &[], &camera, &|_| false);
    // All but the cube behind the eye.
    assert_eq!(verdict.exact, [0, 2, 3, 4, 5, 6, 7, 8, 9]);
    assert_eq!(verdict.false_negatives.len(), 9);
}
