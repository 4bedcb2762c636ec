//! Scenes.

use std::collections::HashSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use casca::glam::DVec3;
use casca::{Bounds, Instance, ObjectDesc, ObjectId, Occluder};
use wasm_bindgen::prelude::*;

use crate::arrays::{affines, boxes, refused, refused_at, same_length, spheres};
use crate::mesh::Mesh;
use crate::view::View;

/// Objects on a grid.
#[wasm_bindgen]
pub struct Scene {
    pub(crate) scene: casca::Scene,
    /// The number of the scene in its highest bits, where keys of objects have zeros: ids are keys
    /// xor these, so that those of other scenes are refused.
    pub(crate) salt: u64,
}

/// Numbers of scenes.
static NEXT: AtomicU32 = AtomicU32::new(0);

/// What is the same for all objects of a call.
struct How {
    moves: bool,
    layers: u64,
}

impl How {
    fn new(moves: Option<bool>, layers: Option<u64>) -> Self {
        Self { moves: moves.unwrap_or(false), layers: layers.unwrap_or(1) }
    }
}

impl Scene {
    /// Inserts objects, all or none.
    fn insert(
        &mut self,
        shapes: impl IntoIterator<Item = (Bounds, Option<Occluder>)>,
        how: &How,
    ) -> Result<Vec<u64>, JsError> {
        let mut ids = Vec::new();
        for (index, (bounds, occluder)) in shapes.into_iter().enumerate() {
            let desc = if how.moves { ObjectDesc::dynamic(bounds) } else { ObjectDesc::fixed(bounds) };
            let mut desc = desc.layers(how.layers);
            if let Some(occluder) = occluder {
                desc = desc.occluder(occluder);
            }
            match self.scene.insert(desc) {
                Ok(id) => ids.push(id),
                Err(why) => {
                    // They were inserted just now.
                    ids.into_iter().for_each(|id| _ = self.scene.remove(id));
                    return Err(refused_at(index, why));
                }
            }
        }
        keys(self, ids)
    }

    /// Moves objects to other shapes, up to the first that is refused. What hides by a box or
    /// sphere hides by the new one; what hides by a mesh hides no more, since a box covers more
    /// than it.
    fn update<S: Into<Bounds> + Into<Occluder> + Copy>(
        &mut self,
        ids: &[ObjectId],
        shapes: &[S],
    ) -> Result<(), JsError> {
        same_length(ids.len(), shapes.len())?;
        for (index, (&id, &shape)) in ids.iter().zip(shapes).enumerate() {
            let old = self.scene.occluder(id).map_err(|why| refused_at(index, why))?;
            let (hid, is_solid) =
                (old.is_some(), matches!(old, Some(Occluder::Box(_) | Occluder::Sphere(_))));
            let moved = self.scene.update(id, shape, hid.then(|| shape.into()));
            moved.map_err(|why| refused_at(index, why))?;
            if hid && !is_solid {
                self.scene.set_occluder(id, None).map_err(|why| refused_at(index, why))?;
            }
        }
        Ok(())
    }
}

#[wasm_bindgen]
impl Scene {
    /// An empty scene, with cells of this edge length in world units.
    #[wasm_bindgen(constructor)]
    pub fn new(cell: f32) -> Result<Scene, JsError> {
        let salt = u64::from(NEXT.fetch_add(1, Ordering::Relaxed)).reverse_bits();
        Ok(Self { scene: casca::Scene::new(cell).map_err(refused)?, salt })
    }

    /// Inserts boxes, 6 numbers each: the least corner and the greatest. Whether they hide others,
    /// whether they will move (default: not), and the layers that they are on (default: 1n).
    #[wasm_bindgen(js_name = insertBoxes)]
    pub fn insert_boxes(
        &mut self,
        boxes: &[f32],
        occludes: bool,
        moves: Option<bool>,
        layers: Option<u64>,
    ) -> Result<Vec<u64>, JsError> {
        let shapes = self::boxes(boxes)?.into_iter();
        self.insert(shapes.map(|b| (b.into(), occludes.then_some(b.into()))), &How::new(moves, layers))
    }

    /// Inserts spheres, 4 numbers each: the centre and the radius.
    #[wasm_bindgen(js_name = insertSpheres)]
    pub fn insert_spheres(
        &mut self,
        spheres: &[f32],
        occludes: bool,
        moves: Option<bool>,
        layers: Option<u64>,
    ) -> Result<Vec<u64>, JsError> {
        let shapes = self::spheres(spheres)?.into_iter();
        self.insert(shapes.map(|s| (s.into(), occludes.then_some(s.into()))), &How::new(moves, layers))
    }

    /// Inserts a mesh under each of some transforms, 16 numbers each as in `Matrix4.elements`. They
    /// hide others if the mesh was made so.
    #[wasm_bindgen(js_name = insertMeshes)]
    pub fn insert_meshes(
        &mut self,
        mesh: &Mesh,
        transforms: &[f32],
        moves: Option<bool>,
        layers: Option<u64>,
    ) -> Result<Vec<u64>, JsError> {
        let mut shapes = Vec::new();
        for (index, place) in affines(transforms)?.into_iter().enumerate() {
            let mesh = Instance::new(Arc::clone(&mesh.mesh), place).map_err(|why| refused_at(index, why))?;
            let occluder = mesh.mesh().occludes().then(|| mesh.clone().into());
            shapes.push((mesh.into(), occluder));
        }
        self.insert(shapes, &How::new(moves, layers))
    }

    /// Moves objects to other boxes. A mesh that is moved so hides no more.
    #[wasm_bindgen(js_name = updateBoxes)]
    pub fn update_boxes(&mut self, ids: &[u64], boxes: &[f32]) -> Result<(), JsError> {
        let ids = self::ids(self, ids)?;
        self.update(&ids, &self::boxes(boxes)?)
    }

    /// Moves objects to other spheres.
    #[wasm_bindgen(js_name = updateSpheres)]
    pub fn update_spheres(&mut self, ids: &[u64], spheres: &[f32]) -> Result<(), JsError> {
        let ids = self::ids(self, ids)?;
        self.update(&ids, &self::spheres(spheres)?)
    }

    /// Gives meshes other transforms.
    #[wasm_bindgen(js_name = setTransforms)]
    pub fn set_transforms(&mut self, ids: &[u64], transforms: &[f32]) -> Result<(), JsError> {
        let (ids, transforms) = (self::ids(self, ids)?, affines(transforms)?);
        same_length(ids.len(), transforms.len())?;
        let set = self.scene.set_transforms(ids.into_iter().zip(transforms));
        set.map_err(|(id, why)| refused(format!("{id}: {why}")))
    }

    /// Removes objects. Their ids are refused from then on.
    pub fn remove(&mut self, ids: &[u64]) -> Result<(), JsError> {
        let ids = self::ids(self, ids)?;
        let mut known = HashSet::new();
        if let Some(twice) = ids.iter().position(|id| !known.insert(*id)) {
            return Err(refused_at(twice, "the id comes twice"));
        }
        ids.into_iter().try_for_each(|id| self.scene.remove(id)).map_err(refused)
    }

    /// Begins a frame at a time in seconds. Returns objects that move and whose volumes expired:
    /// tell where they are.
    #[wasm_bindgen(js_name = beginFrame)]
    pub fn begin_frame(&mut self, now: f64) -> Result<Vec<u64>, JsError> {
        let expired = self.scene.begin_frame(now).map_err(refused)?;
        keys(self, expired)
    }

    /// The place of the origin of all coordinates, in double precision.
    #[wasm_bindgen(getter)]
    pub fn origin(&self) -> Vec<f64> {
        self.scene.origin().to_array().to_vec()
    }

    /// Puts the origin elsewhere. Objects stay; give all coordinates relative to it from then on.
    #[wasm_bindgen(js_name = setOrigin)]
    pub fn set_origin(&mut self, x: f64, y: f64, z: f64) -> Result<(), JsError> {
        self.scene.set_origin(DVec3::new(x, y, z)).map_err(refused)
    }

    /// A view that is relative to a place, such as the eye, in the coordinates of the scene.
    pub fn view(&self, x: f64, y: f64, z: f64, view: &View) -> Result<View, JsError> {
        Ok(View { view: self.scene.view(DVec3::new(x, y, z), &view.view).map_err(refused)? })
    }

    /// The ids of all objects.
    #[wasm_bindgen(getter)]
    pub fn ids(&self) -> Result<Vec<u64>, JsError> {
        keys(self, self.scene.ids())
    }

    /// How many objects there are.
    #[wasm_bindgen(getter)]
    pub fn length(&self) -> usize {
        self.scene.len()
    }

    /// Whether an id is that of an object of this scene.
    pub fn has(&self, id: u64) -> bool {
        self.scene.id_from_key(id ^ self.salt).is_ok_and(|id| self.scene.contains(id))
    }

    /// Bytes that the scene takes, without its meshes.
    #[wasm_bindgen(getter, js_name = memoryBytes)]
    pub fn memory_bytes(&self) -> usize {
        self.scene.memory().total()
    }
}

/// Ids of objects of a scene.
pub fn ids(scene: &Scene, keys: &[u64]) -> Result<Vec<ObjectId>, JsError> {
    let none = "no object of this scene has this id: it was removed, or is of another scene";
    let of = |key: u64| scene.scene.id_from_key(key ^ scene.salt);
    let id = |(index, &key)| of(key).map_err(|_| refused_at(index, none));
    keys.iter().enumerate().map(id).collect()
}

/// Ids as bigints.
pub fn keys(scene: &Scene, ids: impl IntoIterator<Item = ObjectId>) -> Result<Vec<u64>, JsError> {
    ids.into_iter().map(|id| Ok(scene.scene.key(id).map_err(refused)? ^ scene.salt)).collect()
}
