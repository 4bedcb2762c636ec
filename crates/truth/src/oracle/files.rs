//! What of a glTF file stops rays, read from its JSON: nothing here shares code with the importer,
//! whose choice of what hides is judged by it.
//!
//! By the specification of glTF: a ray goes on through a material whose alpha mode is not OPAQUE,
//! through one with transmission, through the back of a single-sided one, and through lines and
//! points. Where materials, nodes or their places may change in ways that the objects do not
//! follow, rays go on.

use std::collections::HashMap;
use std::sync::Arc;

use serde_json::Value;

use casca_scenes::world::{FilePart, Mesh, Object, Shape, Sides, World};

/// The objects of a world as rays meet them: with the meshes of the importer, but with sides of
/// triangles that come from the file itself. Worlds that come from no file are as they are.
pub struct Seen {
    /// Empty if the world comes from no file.
    objects: Vec<Object>,
    /// By object; shorter if the world has more than its file.
    meshes: Vec<Option<Arc<Mesh>>>,
}

impl Seen {
    /// The objects of a world as they are now.
    pub fn of(world: &World) -> Self {
        let json = &*world.source.document;
        let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
        let Ok(root) = serde_json::from_slice::<Value>(json) else {
            return Self { objects: Vec::new(), meshes: Vec::new() };
        };
        let file = File::of(&root);
        let mut made: HashMap<(usize, *const Mesh), Arc<Mesh>> = HashMap::new();
        let (mut objects, mut meshes) = (world.objects.clone(), Vec::new());
        for (object, part) in objects.iter_mut().zip(&world.source.parts) {
            let Shape::Mesh { mesh, .. } = &mut object.shape else {
                meshes.push(None);
                continue;
            };
            // As the author says: it is looked for, but hides nothing.
            object.occludes = root["nodes"][part.node]["extras"]["role"] != "occludee";
            let known = made.entry((part.node, Arc::as_ptr(mesh)));
            *mesh = known.or_insert_with(|| Arc::new(file.mesh(mesh, part))).clone();
            meshes.push(Some(mesh.clone()));
        }
        Self { objects, meshes }
    }

    /// The same objects where they are now; `moved` are those with another shape than before.
    pub fn follow<'a>(&'a mut self, objects: &'a [Object], moved: &[usize]) -> &'a [Object] {
        if self.objects.is_empty() {
            return objects;
        }
        for &i in moved {
            self.objects[i].shape = match (&objects[i].shape, self.meshes.get(i)) {
                (Shape::Mesh { transform, .. }, Some(Some(mesh))) => {
                    Shape::Mesh { mesh: mesh.clone(), transform: *transform }
                }
                (shape, _) => shape.clone(),
            };
        }
        &self.objects
    }

    /// The objects where they are, or those given if the world comes from no file.
    pub fn objects<'a>(&'a self, objects: &'a [Object]) -> &'a [Object] {
        if self.objects.is_empty() { objects } else { &self.objects }
    }
}

/// The JSON of a file.
struct File<'a> {
    root: &'a Value,
    /// By node: whether it is always drawn.
    drawn: Vec<bool>,
    /// Materials that an animation changes.
    changing: Vec<u64>,
}

fn list<'a>(value: &'a Value, name: &str) -> &'a [Value] {
    value[name].as_array().map_or(&[], Vec::as_slice)
}

impl<'a> File<'a> {
    fn of(root: &'a Value) -> Self {
        let nodes = list(root, "nodes");
        let mut hidden: Vec<usize> = (0..nodes.len())
            .filter(|&i| nodes[i]["extensions"]["KHR_node_visibility"]["visible"] == false)
            .collect();
        let mut changing = Vec::new();
        let channels = list(root, "animations").iter().flat_map(|a| list(a, "channels"));
        for pointer in channels.map(|c| &c["target"]["extensions"]["KHR_animation_pointer"]["pointer"]) {
            let words: Vec<&str> = pointer.as_str().unwrap_or("").split('/').collect();
            match words[..] {
                ["", "materials", index, ..] => changing.extend(index.parse::<u64>()),
                ["", "nodes", index, ..] => hidden.extend(index.parse::<usize>()),
                _ => {}
            }
        }
        let mut drawn = vec![true; nodes.len()];
        while let Some(node) = hidden.pop() {
            if drawn.get(node) == Some(&true) {
                drawn[node] = false;
                hidden.extend(
                    list(&nodes[node], "children").iter().filter_map(Value::as_u64).map(|i| i as usize),
                );
            }
        }
        Self { root, drawn, changing }
    }

    /// The mesh of an object, with the sides from which it stops rays.
    fn mesh(&self, mesh: &Mesh, part: &FilePart) -> Mesh {
        let index = self.root["nodes"][part.node]["mesh"].as_u64().unwrap_or(u64::MAX) as usize;
        let primitives = &self.root["meshes"][index]["primitives"];
        let is_drawn = self.drawn.get(part.node) == Some(&true);
        let of = |triangle: usize| match part.primitives.get(triangle) {
            Some(&primitive) if is_drawn => self.sides(&primitives[primitive as usize]),
            _ => Sides::Neither,
        };
        let mut sides: Vec<Sides> = (0..mesh.triangles.len()).map(of).collect();
        if sides.iter().all(|&s| s == Sides::Both) {
            sides.clear();
        }
        Mesh { sides, ..mesh.clone() }
    }

    /// From where a primitive stops rays, whichever variant is shown.
    fn sides(&self, primitive: &Value) -> Sides {
        // Points and lines have modes below that of triangles.
        if primitive["mode"].as_u64().is_some_and(|mode| mode < 4) {
            return Sides::Neither;
        }
        let variants = list(&primitive["extensions"]["KHR_materials_variants"], "mappings");
        let all: Vec<Sides> =
            variants.iter().chain([primitive]).map(|by| self.material(&by["material"])).collect();
        match (all.contains(&Sides::Neither), all.contains(&Sides::Front)) {
            (true, _) => Sides::Neither,
            (false, true) => Sides::Front,
            _ => Sides::Both,
        }
    }

    fn material(&self, index: &Value) -> Sides {
        let Some(index) = index.as_u64() else { return Sides::Front };
        let material = &self.root["materials"][index as usize];
        let factor = |extension: &str, name: &str| {
            material["extensions"][extension][name].as_f64().unwrap_or(0.0) != 0.0
        };
        let passes = factor("KHR_materials_transmission", "transmissionFactor")
            || factor("KHR_materials_diffuse_transmission", "diffuseTransmissionFactor");
        let is_opaque = material["alphaMode"].as_str().is_none_or(|mode| mode == "OPAQUE");
        match material["doubleSided"].as_bool() {
            _ if passes || !is_opaque || self.changing.contains(&index) => Sides::Neither,
            Some(true) => Sides::Both,
            _ => Sides::Front,
        }
    }
}
