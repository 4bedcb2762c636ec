//! Scenes.

use std::path::PathBuf;
use std::sync::Arc;

use casca::glam::DVec3;
use casca::{Aabb, Bounds, Instance, ObjectDesc, ObjectId, Occluder};
use casca_scenes::drive::Driver;
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::world::World;
use numpy::{IntoPyArray, PyArray1, PyArray3};
use pyo3::exceptions::{PyOSError, PyTypeError};
use pyo3::prelude::*;

use crate::arrays::{self, Flags, Keys, place};
use crate::error::{check, refused, refused_at, warn};
use crate::forms::{Given, Rule, frame, layers, seed, whole};
use crate::mesh::{Mesh, Progress, Told};
use crate::query::Query;
use crate::view::View;

/// Objects on a grid.
#[pyclass(module = "casca")]
pub struct Scene {
    pub(crate) scene: casca::Scene,
    /// The scene that it was made of, with its path of the camera.
    world: Option<World>,
}

/// The names of generated scenes.
pub fn names() -> Vec<&'static str> {
    SceneKind::ALL.iter().map(|kind| kind.name()).collect()
}

impl Scene {
    /// A scene with the objects of a test scene.
    fn of(py: Python, world: World, cell: Option<f32>, progress: Progress) -> PyResult<Self> {
        let cell = cell.unwrap_or(world.grid.cell);
        let scene = py.detach(|| {
            let mut told = Told::new(progress);
            let count = world.objects.len().max(1);
            let made = Driver::new(&world, cell, |n| {
                // A callback that raised is not called again.
                if told.raised.is_none() {
                    let _ = told.tell(n as f32 / count as f32);
                }
            });
            told.raised.map_or_else(|| made.map(|driver| driver.scene).map_err(refused), Err)
        })?;
        Ok(Self { scene, world: Some(world) })
    }

    /// Inserts objects, all or none.
    fn insert<'py>(
        &mut self,
        py: Python<'py>,
        shapes: impl IntoIterator<Item = (Bounds, Option<Occluder>)>,
        (moves, max_speed, layers): How,
    ) -> Keys<'py> {
        check(moves || max_speed.is_none(), || "only objects that move have a greatest speed".into())?;
        let mut ids = Vec::new();
        for (index, (bounds, occluder)) in shapes.into_iter().enumerate() {
            let mut desc = match moves {
                true => ObjectDesc::dynamic(bounds),
                false => ObjectDesc::fixed(bounds),
            };
            desc = desc.layers(layers);
            if let Some(speed) = max_speed {
                desc = desc.max_speed(speed);
            }
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
        arrays::keys(py, &self.scene, ids.into_iter())
    }

    /// The origin that the coordinates of its file got.
    fn of_file(&self) -> DVec3 {
        self.world.as_ref().map_or(DVec3::ZERO, |world| world.source.origin)
    }

    fn ids_or_all(&self, ids: Option<Bound<PyAny>>) -> PyResult<Vec<ObjectId>> {
        ids.map_or_else(|| Ok(self.scene.ids().collect()), |ids| arrays::ids(&self.scene, &ids))
    }

    /// Moves objects to other shapes. What hides by a box or sphere hides by the new one. What hides
    /// by a mesh hides no more: a box around it covers what the mesh does not.
    fn update<S: Into<Bounds> + Into<Occluder> + Copy>(
        &mut self,
        ids: &[ObjectId],
        shapes: &[S],
    ) -> PyResult<()> {
        same_length(ids.len(), shapes.len())?;
        for (index, (&id, &shape)) in ids.iter().zip(shapes).enumerate() {
            let old = self.scene.occluder(id).map_err(refused)?;
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

/// Refuses lists of two lengths.
fn same_length(ids: usize, shapes: usize) -> PyResult<()> {
    check(ids == shapes, || format!("{ids} ids do not fit {shapes} shapes"))
}

/// What is the same for all objects of a call: whether they move, how fast at most, and their layers.
type How = (bool, Option<f32>, u64);

#[pymethods]
impl Scene {
    #[new]
    fn new(cell: f32) -> PyResult<Self> {
        Ok(Self { scene: casca::Scene::new(cell).map_err(refused)?, world: None })
    }

    /// A scene from a glTF 2.0 file.
    #[staticmethod]
    #[pyo3(signature = (path, *, cell=None, progress=None))]
    fn from_gltf(py: Python, path: PathBuf, cell: Option<f32>, progress: Progress) -> PyResult<Self> {
        let mut world = py.detach(|| casca_scenes::import::load(&path)).map_err(|why| match &why.why {
            casca_scenes::import::Trouble::Read(_) => PyOSError::new_err(why.to_string()),
            _ => refused(&why),
        })?;
        let moved = world.source.about_origin();
        world.source.warnings.extend(moved.map(|line| format!("{}: {line} (Scene.origin)", path.display())));
        warn(py, &world)?;
        Self::of(py, world, cell, progress)
    }

    /// A generated test scene.
    #[staticmethod]
    #[pyo3(signature = (name, *, seed=1, scale=1.0, cell=None, progress=None))]
    fn generate(
        py: Python,
        name: &str,
        #[pyo3(from_py_with = seed)] seed: u64,
        scale: f32,
        cell: Option<f32>,
        progress: Progress,
    ) -> PyResult<Self> {
        let kind = SceneKind::ALL.into_iter().find(|kind| kind.name() == name);
        let kind =
            kind.ok_or_else(|| refused(format!("there is no scene {name:?}; there are {:?}", names())))?;
        check(scale > 0.0 && scale <= 100.0, || format!("scale must lie between 0 and 100, not {scale}"))?;
        let options = SceneOptions { seed, scale, ..SceneOptions::default() };
        let world = py.detach(|| build(kind, &options));
        Self::of(py, world, cell, progress)
    }

    /// Inserts boxes.
    #[pyo3(signature = (boxes, *, occludes=false, moves=false, max_speed=None, layers=1))]
    fn insert_boxes<'py>(
        &mut self,
        py: Python<'py>,
        boxes: Given,
        occludes: bool,
        moves: bool,
        max_speed: Option<f32>,
        #[pyo3(from_py_with = layers)] layers: u64,
    ) -> Keys<'py> {
        let shapes = arrays::boxes(boxes, Rule::Finite)?;
        let shapes = shapes.into_iter().map(|b| (b.into(), occludes.then_some(b.into())));
        self.insert(py, shapes, (moves, max_speed, layers))
    }

    /// Inserts spheres.
    #[pyo3(signature = (spheres, *, occludes=false, moves=false, max_speed=None, layers=1))]
    fn insert_spheres<'py>(
        &mut self,
        py: Python<'py>,
        spheres: Given,
        occludes: bool,
        moves: bool,
        max_speed: Option<f32>,
        #[pyo3(from_py_with = layers)] layers: u64,
    ) -> Keys<'py> {
        let shapes = arrays::spheres(spheres)?;
        let shapes = shapes.into_iter().map(|s| (s.into(), occludes.then_some(s.into())));
        self.insert(py, shapes, (moves, max_speed, layers))
    }

    /// Inserts a mesh under each of some transforms.
    #[pyo3(signature = (mesh, transforms, *, moves=false, max_speed=None, layers=1))]
    fn insert_meshes<'py>(
        &mut self,
        py: Python<'py>,
        mesh: &Mesh,
        transforms: Given,
        moves: bool,
        max_speed: Option<f32>,
        #[pyo3(from_py_with = layers)] layers: u64,
    ) -> Keys<'py> {
        let mut shapes = Vec::new();
        for (index, place) in arrays::affines(transforms)?.into_iter().enumerate() {
            let mesh = Instance::new(Arc::clone(&mesh.mesh), place).map_err(|why| refused_at(index, why))?;
            let occluder = mesh.mesh().occludes().then(|| mesh.clone().into());
            shapes.push((mesh.into(), occluder));
        }
        self.insert(py, shapes, (moves, max_speed, layers))
    }

    /// Moves many objects to other boxes.
    fn update_boxes(&mut self, ids: Given, boxes: Given) -> PyResult<()> {
        let ids = arrays::ids(&self.scene, ids)?;
        self.update(&ids, &arrays::boxes(boxes, Rule::Finite)?)
    }

    /// Moves many objects to other spheres.
    fn update_spheres(&mut self, ids: Given, spheres: Given) -> PyResult<()> {
        let ids = arrays::ids(&self.scene, ids)?;
        self.update(&ids, &arrays::spheres(spheres)?)
    }

    /// Gives many meshes other transforms.
    fn set_transforms(&mut self, ids: Given, transforms: Given) -> PyResult<()> {
        let ids = arrays::ids(&self.scene, ids)?;
        let transforms = arrays::affines(transforms)?;
        same_length(ids.len(), transforms.len())?;
        let moved = self.scene.set_transforms(ids.into_iter().zip(transforms));
        moved.map_err(|(id, why)| refused(format!("{id}: {why}")))
    }

    /// Removes objects.
    fn remove(&mut self, ids: Given) -> PyResult<()> {
        let ids = arrays::ids(&self.scene, ids)?;
        let mut known = std::collections::HashSet::new();
        let twice = ids.iter().position(|id| !known.insert(*id));
        check(twice.is_none(), || format!("ids[{}] comes twice", twice.unwrap_or_default()))?;
        ids.into_iter().try_for_each(|id| self.scene.remove(id)).map_err(refused)
    }

    /// Begins a frame at a time in seconds. Returns objects whose volumes expired.
    fn begin_frame<'py>(&mut self, py: Python<'py>, now: f64) -> Keys<'py> {
        let expired = self.scene.begin_frame(now).map_err(refused)?;
        arrays::keys(py, &self.scene, expired.into_iter())
    }

    /// Ends a frame with the queries that ran in it.
    fn end_frame(&mut self, queries: Vec<PyRef<Query>>) -> PyResult<()> {
        let sets = queries.iter().map(|query| query.query.pvs());
        self.scene.end_frame(sets).map(drop).map_err(refused)
    }

    /// The ids of all objects.
    #[getter]
    fn ids<'py>(&self, py: Python<'py>) -> Keys<'py> {
        arrays::keys(py, &self.scene, self.scene.ids())
    }

    /// The boxes around objects.
    #[pyo3(signature = (ids=None))]
    fn boxes<'py>(
        &self,
        py: Python<'py>,
        ids: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let ids = self.ids_or_all(ids)?;
        let mut numbers = Vec::with_capacity(6 * ids.len());
        for &id in &ids {
            let b = self.scene.bounds(id).map_err(refused)?.aabb();
            numbers.extend(b.min.to_array().into_iter().chain(b.max.to_array()));
        }
        let shaped = numpy::ndarray::Array3::from_shape_vec((ids.len(), 2, 3), numbers).map_err(refused)?;
        Ok(shaped.into_pyarray(py))
    }

    /// Which objects hide others.
    #[pyo3(signature = (ids=None))]
    fn occluders<'py>(&self, py: Python<'py>, ids: Option<Bound<'py, PyAny>>) -> Flags<'py> {
        let ids = self.ids_or_all(ids)?;
        let hides = |id: &ObjectId| Ok(self.scene.occluder(*id).map_err(refused)?.is_some());
        Ok(PyArray1::from_vec(py, ids.iter().map(hides).collect::<PyResult<_>>()?))
    }

    /// The frames of the path that came with the scene; 0 without one.
    #[getter]
    fn path_length(&self) -> usize {
        self.world.as_ref().map_or(0, |world| world.frames)
    }

    /// The camera of a frame of that path.
    #[pyo3(signature = (frame, *, aspect=16.0 / 9.0))]
    fn path_view(&self, #[pyo3(from_py_with = frame)] frame: usize, aspect: f32) -> PyResult<View> {
        let world = self.world.as_ref().filter(|world| frame < world.frames);
        let world = world
            .ok_or_else(|| refused(format!("the path has {} frames, not {frame}", self.path_length())))?;
        check(aspect > 0.0 && aspect.is_finite(), || format!("aspect must be positive, not {aspect}"))?;
        let camera = world.camera(frame, aspect);
        View::from_camera(camera.at((camera.eye.as_dvec3() - self.scene.origin()).as_vec3()))
    }

    /// What is added to all coordinates of this scene for those of the file or world.
    #[getter]
    fn origin(&self) -> [f64; 3] {
        (self.of_file() + self.scene.origin()).to_array()
    }

    #[setter]
    fn set_origin(&mut self, at: Given) -> PyResult<()> {
        let at: DVec3 = place("origin", at)?;
        self.scene.set_origin(at - self.of_file()).map_err(refused)
    }

    /// A view in coordinates relative to a place of the file or world.
    fn view(&self, at: Given, view: &View) -> PyResult<View> {
        let at = place::<f64, DVec3>("at", at)? - self.of_file();
        view.carried(at - self.scene.origin())
    }

    /// The corners of a box around all objects; None if there are none.
    #[getter]
    fn bounds(&self) -> Option<[[f32; 3]; 2]> {
        let boxes = self.scene.iter().map(|(_, object)| object.bounds().aabb());
        let all = boxes.reduce(|a, b| Aabb { min: a.min.min(b.min), max: a.max.max(b.max) });
        all.map(|all| [all.min.to_array(), all.max.to_array()])
    }

    fn __len__(&self) -> usize {
        self.scene.len()
    }

    fn __contains__(&self, id: Given) -> PyResult<bool> {
        let key = whole(id).ok_or_else(|| PyTypeError::new_err("an id is an integer"))?.extract();
        Ok(key.is_ok_and(|key| self.scene.id_from_key(key).is_ok()))
    }

    fn __repr__(&self) -> String {
        format!("Scene({} objects in cells of {})", self.scene.len(), self.scene.grid().cell_size() as f32)
    }
}
