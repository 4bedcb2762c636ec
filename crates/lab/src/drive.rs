//! Puts a test scene into the library and keeps it up to date.

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::Arc;

use casca::{
    Aabb, Bounds, Error, GridSpec, Instance, MeshOptions, ObjectDesc, ObjectId, Occluder, Pvs, Scene, Sphere,
    TriMesh, View,
};
use glam::{UVec3, Vec3};

use crate::world::{Camera, GridHint, Mesh, Motion, Object, Shape, World};

/// A scene of the library that follows a [`World`].
pub struct Driver {
    /// The scene.
    pub scene: Scene,
    ids: Vec<ObjectId>,
    shaper: Shaper,
}

/// Outlines of patches may leave those of static triangles by this share of a cell.
const TOLERANCE: f32 = 1.0 / 60.0;

/// A mesh, and the same as prepared.
type Prepared = (Arc<Mesh>, Arc<TriMesh>);

/// Makes shapes of the library.
struct Shaper {
    /// Meshes that move are prepared once, with and without what hides; they are kept so that none takes the place
    /// of another.
    moving: HashMap<(*const Mesh, bool), Prepared>,
    how: MeshOptions,
}

impl Shaper {
    fn new(grid: &GridSpec) -> Self {
        let mut how = MeshOptions::default();
        how.tolerance = Some(grid.cell * TOLERANCE);
        Self { moving: HashMap::new(), how }
    }

    /// The shapes of an object as the library takes them.
    fn shapes(&mut self, object: &Object) -> Result<(Bounds, Option<Occluder>), Error> {
        let (bounds, occluder): (Bounds, Occluder) = match &object.shape {
            Shape::Sphere { center, radius } => {
                let s = Sphere::new(*center, *radius);
                (s.into(), s.into())
            }
            Shape::Box { min, max } => {
                let b = Aabb::new(*min, *max);
                (b.into(), b.into())
            }
            Shape::Mesh { mesh, transform } if object.motion == Motion::Static => {
                let positions: Vec<Vec3> =
                    mesh.positions.iter().map(|&p| transform.transform_point3(p)).collect();
                let mut how = self.how;
                how.occludes = object.occludes;
                let mesh = TriMesh::prepare(positions, mesh.triangles.clone(), &how, &mut |_| {
                    ControlFlow::Continue(())
                })?;
                let mesh = Arc::new(mesh);
                (mesh.clone().into(), mesh.into())
            }
            Shape::Mesh { mesh, transform } => {
                let key = (Arc::as_ptr(mesh), object.occludes);
                let prepared = match self.moving.get(&key) {
                    Some((_, prepared)) => prepared.clone(),
                    None => {
                        let prepare = if object.occludes { TriMesh::new } else { TriMesh::bounds_only };
                        let new = Arc::new(prepare(mesh.positions.clone(), mesh.triangles.clone())?);
                        self.moving.insert(key, (mesh.clone(), new.clone()));
                        new
                    }
                };
                let instance = Instance::new(prepared, *transform)?;
                (instance.clone().into(), instance.into())
            }
        };
        Ok((bounds, Some(occluder).filter(|_| object.occludes)))
    }

    fn describe(&mut self, object: &Object) -> Result<ObjectDesc, Error> {
        let (bounds, occluder) = self.shapes(object)?;
        let desc = match object.motion {
            Motion::Static => ObjectDesc::fixed(bounds),
            Motion::Dynamic { max_speed } => ObjectDesc::dynamic(bounds).max_speed(max_speed),
        };
        Ok(match occluder {
            Some(occluder) => desc.occluder(occluder),
            None => desc,
        })
    }
}

/// The grid for a scene: as it asks, or with `dims` cells whose size fits all axes.
///
/// # Errors
/// As [`GridSpec::covering`].
pub fn grid_for(hint: &GridHint, dims: Option<UVec3>) -> Result<GridSpec, Error> {
    match dims {
        None => GridSpec::covering(Aabb::new(hint.min, hint.max), hint.cell),
        Some(dims) => {
            let cell = ((hint.max - hint.min) / dims.as_vec3()).max_element();
            Ok(GridSpec { min: hint.min, cell, dims })
        }
    }
}

/// The view of a camera.
///
/// # Errors
/// As [`View::perspective`].
pub fn view_of(camera: &Camera) -> Result<View, Error> {
    View::perspective(camera.eye, camera.view_projection())
}

impl Driver {
    /// Inserts every object of the world as it is now; `progress` is told
    /// the number inserted.
    ///
    /// # Errors
    /// As [`Scene::new`] and [`Scene::insert`].
    pub fn new(world: &World, grid: &GridSpec, progress: impl FnMut(usize)) -> Result<Self, Error> {
        Self::with(&world.objects, grid, |_, desc| desc, progress)
    }

    /// Inserts objects with what `adapt` makes of their descriptions; `progress` as above.
    ///
    /// # Errors
    /// As [`Scene::new`] and [`Scene::insert`].
    pub fn with(
        objects: &[Object],
        grid: &GridSpec,
        adapt: impl Fn(&Object, ObjectDesc) -> ObjectDesc,
        mut progress: impl FnMut(usize),
    ) -> Result<Self, Error> {
        let mut scene = Scene::new(grid)?;
        let mut shaper = Shaper::new(grid);
        let mut ids = Vec::with_capacity(objects.len());
        for object in objects {
            ids.push(scene.insert(adapt(object, shaper.describe(object)?))?);
            progress(ids.len());
        }
        Ok(Self { scene, ids, shaper })
    }

    /// Reports the objects that moved.
    ///
    /// # Errors
    /// As [`Scene::update`].
    pub fn update(&mut self, objects: &[Object], moved: &[usize]) -> Result<(), Error> {
        for &i in moved {
            let (bounds, occluder) = self.shaper.shapes(&objects[i])?;
            self.scene.update(self.ids[i], bounds, occluder)?;
        }
        Ok(())
    }

    /// The id of an object of the world.
    pub fn id(&self, object: usize) -> ObjectId {
        self.ids[object]
    }

    /// Whether a result holds an object of the world.
    pub fn sees(&self, pvs: &Pvs, object: usize) -> bool {
        pvs.contains(self.ids[object])
    }

    /// How many objects whose visibility is asked for a result holds.
    pub fn count(&self, pvs: &Pvs, objects: &[Object]) -> usize {
        self.ids.iter().zip(objects).filter(|(id, o)| o.tested && pvs.contains(**id)).count()
    }
}
