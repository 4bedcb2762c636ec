//! Puts a test scene into the library and keeps it up to date.

use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::Arc;

use casca::{
    Aabb, Bounds, Error, Facing, Instance, MeshOptions, ObjectDesc, ObjectId, Occluder, Pvs, Scene, Sphere,
    TriMesh, View, cell_for,
};
use casca_cache::MeshCache;
use glam::{Affine3A, Vec3};

use crate::world::{Camera, Mesh, Motion, Object, Shape, World, turn_of};

/// An object as the scene is told of it: its id, its bounds, and its occluder if it has one.
pub type Report = (ObjectId, Bounds, Option<Occluder>);

/// A scene of the library that follows a [`World`].
#[derive(Clone)]
pub struct Driver {
    /// The scene.
    pub scene: Scene,
    ids: Vec<ObjectId>,
    shaper: Shaper,
}

/// Outlines of patches may leave those of static triangles by this share of a cell.
const TOLERANCE: f32 = 1.0 / 60.0;

/// A mesh as prepared: what it is tested by, and what of it hides.
#[derive(Clone)]
struct Prepared {
    bounds: Arc<TriMesh>,
    hiding: Option<Arc<TriMesh>>,
}

/// Of a mesh: its address, whether it occludes, and whether a transform mirrors its fronts.
type Key = (*const Mesh, bool, bool);

/// The objects that share a mesh.
#[derive(Default, Clone)]
struct Users {
    count: usize,
    /// The greatest scale of their transforms.
    scale: f32,
}

/// Makes shapes of the library.
#[derive(Clone)]
struct Shaper {
    /// Meshes of instances, each prepared once for a use. They are found by address, and kept so
    /// that no other mesh gets the same address.
    prepared: HashMap<Key, (Arc<Mesh>, Prepared)>,
    users: HashMap<*const Mesh, Users>,
    how: MeshOptions,
    cache: Option<Arc<MeshCache>>,
}

/// Static objects that share a mesh are instances of it, as in a game, but for transforms that
/// stretch it a lot; objects that move always are instances. These are at most this many times
/// as long as wide, seen from their mesh: trees and rocks of a game are, but not walls made of a
/// unit cube.
const STRETCH: f32 = 4.0;

/// The same for meshes that hide from their front: casca takes those in an instance only where all
/// axes are scaled alike.
const STRETCH_OF_FRONTS: f32 = 1.0 + 1e-6;

/// What takes the mirror out of a transform, where the mesh is mirrored as well.
const MIRROR: Vec3 = Vec3::new(-1.0, 1.0, 1.0);

/// The lengths of the axes of a transform, from the least to the greatest.
fn scales(transform: &Affine3A) -> (f32, f32) {
    let m = transform.matrix3;
    let lengths = Vec3::new(m.x_axis.length(), m.y_axis.length(), m.z_axis.length());
    (lengths.min_element(), lengths.max_element())
}

impl Shaper {
    fn new(cell: f32, objects: &[Object], cache: Option<Arc<MeshCache>>) -> Self {
        let mut users: HashMap<*const Mesh, Users> = HashMap::new();
        for object in objects {
            if let Shape::Mesh { mesh, transform } = &object.shape {
                let users = users.entry(Arc::as_ptr(mesh)).or_default();
                users.count += 1;
                users.scale = users.scale.max(scales(transform).1);
            }
        }
        let how = MeshOptions::default().tolerance(cell * TOLERANCE);
        Self { prepared: HashMap::new(), users, how, cache }
    }

    /// Whether an object is an instance of its mesh.
    fn is_instance(&self, object: &Object, mesh: &Arc<Mesh>, transform: &Affine3A) -> bool {
        let shared = self.users.get(&Arc::as_ptr(mesh)).is_some_and(|users| users.count > 1);
        let (least, most) = scales(transform);
        let alike = most <= least * if mesh.sides.is_empty() { STRETCH } else { STRETCH_OF_FRONTS };
        object.motion != Motion::Static || shared && alike
    }

    /// The mesh of instances, prepared when it is first asked for.
    fn prepared(&mut self, mesh: &Arc<Mesh>, occludes: bool, mirrors: bool) -> Result<Prepared, Error> {
        let key = (Arc::as_ptr(mesh), occludes, mirrors);
        if let Some((_, prepared)) = self.prepared.get(&key) {
            return Ok(prepared.clone());
        }
        let mut how = self.how;
        // The tolerance is meant in world space.
        let scale = self.users.get(&key.0).map_or(0.0, |users| users.scale);
        how.tolerance = how.tolerance.map(|t| t / scale).filter(|t| t.is_finite());
        let mut positions = mesh.positions.clone();
        if mirrors {
            positions.iter_mut().for_each(|p| *p *= MIRROR);
        }
        let new = self.make(positions, mesh, how.occludes(occludes), mirrors)?;
        self.prepared.insert(key, (mesh.clone(), new.clone()));
        Ok(new)
    }

    /// The shapes of an object as the library takes them.
    fn shapes(&mut self, object: &Object) -> Result<(Bounds, Option<Occluder>), Error> {
        let (bounds, occluder): (Bounds, Option<Occluder>) = match &object.shape {
            Shape::Sphere { center, radius } => {
                let s = Sphere::new(*center, *radius);
                (s.into(), Some(s.into()))
            }
            Shape::Box { min, max } => {
                let b = Aabb::new(*min, *max);
                (b.into(), Some(b.into()))
            }
            Shape::Mesh { mesh, transform } => {
                let has_fronts = !mesh.sides.is_empty();
                let turned = if has_fronts { turn_of(transform) } else { 1.0 };
                let (mirrors, occludes) = (turned < 0.0, object.occludes && turned != 0.0);
                if self.is_instance(object, mesh, transform) {
                    let made = self.prepared(mesh, occludes, mirrors)?;
                    let mirror = if mirrors { MIRROR } else { Vec3::ONE };
                    let place = |mesh| Instance::new(mesh, *transform * Affine3A::from_scale(mirror));
                    (place(made.bounds)?.into(), made.hiding.map(place).transpose()?.map(Occluder::from))
                } else {
                    let positions: Vec<Vec3> =
                        mesh.positions.iter().map(|&p| transform.transform_point3(p)).collect();
                    let made = self.make(positions, mesh, self.how.occludes(occludes), mirrors)?;
                    (made.bounds.into(), made.hiding.map(Occluder::from))
                }
            }
        };
        Ok((bounds, occluder.filter(|_| object.occludes)))
    }

    /// A mesh with its positions where they are wanted; `mirrors` says whether they mirror it.
    fn make(
        &self,
        positions: Vec<Vec3>,
        mesh: &Mesh,
        how: MeshOptions,
        mirrors: bool,
    ) -> Result<Prepared, Error> {
        let whole = |positions| self.prepare(positions, mesh.triangles.clone(), how.occludes(false));
        let Some((hiding, front)) = mesh.hiding().filter(|_| how.occludes) else {
            return Ok(Prepared { bounds: whole(positions)?, hiding: None });
        };
        let bounds = match hiding {
            Cow::Borrowed(_) => None,
            Cow::Owned(_) => Some(whole(positions.clone())?),
        };
        let mut triangles = hiding.into_owned();
        if front && mirrors {
            // Corners that ran counter-clockwise run clockwise now.
            triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        let facing = if front { Facing::Front } else { Facing::Both };
        let hiding = self.prepare(positions, triangles, how.facing(facing))?;
        Ok(Prepared { bounds: bounds.unwrap_or_else(|| hiding.clone()), hiding: Some(hiding) })
    }

    fn prepare(
        &self,
        positions: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
        how: MeshOptions,
    ) -> Result<Arc<TriMesh>, Error> {
        let go_on = &mut |_| ControlFlow::Continue(());
        let prepared = match &self.cache {
            Some(cache) => cache.prepare(positions, triangles, &how, go_on),
            None => TriMesh::prepare(positions, triangles, &how, go_on),
        };
        prepared.map(Arc::new)
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

/// The edge length of cells that casca recommends for the region and the number of objects of a
/// scene.
///
/// # Errors
/// As [`cell_for`].
pub fn fitted_cell(world: &World) -> Result<f32, Error> {
    cell_for(Aabb::new(world.grid.min, world.grid.max), world.objects.len())
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
    pub fn new(world: &World, cell: f32, progress: impl FnMut(usize)) -> Result<Self, Error> {
        Self::with(&world.objects, cell, None, |_, desc| desc, progress)
    }

    /// Inserts objects with what `adapt` makes of their descriptions; `progress` as above. Meshes
    /// are read from a cache if they are in it, and else written to it.
    ///
    /// # Errors
    /// As [`Scene::new`] and [`Scene::insert`].
    pub fn with(
        objects: &[Object],
        cell: f32,
        cache: Option<Arc<MeshCache>>,
        adapt: impl Fn(&Object, ObjectDesc) -> ObjectDesc,
        mut progress: impl FnMut(usize),
    ) -> Result<Self, Error> {
        let mut shaper = Shaper::new(cell, objects, cache);
        let mut scene = Scene::new(cell)?;
        scene.reserve(objects.len());
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
        let reports = self.reports(objects, moved)?;
        self.tell(reports)
    }

    /// What is to be reported of some objects of the world, for [`Driver::tell`].
    ///
    /// # Errors
    /// As [`Driver::update`], for shapes that casca refuses.
    pub fn reports(&mut self, objects: &[Object], moved: &[usize]) -> Result<Vec<Report>, Error> {
        let report = |&i: &usize| {
            let (bounds, occluder) = self.shaper.shapes(&objects[i])?;
            Ok((self.ids[i], bounds, occluder))
        };
        moved.iter().map(report).collect()
    }

    /// Reports some objects.
    ///
    /// # Errors
    /// As [`casca::Scene::update`].
    pub fn tell(&mut self, reports: Vec<Report>) -> Result<(), Error> {
        reports.into_iter().try_for_each(|(id, bounds, occluder)| self.scene.update(id, bounds, occluder))
    }

    /// The id of an object of the world.
    pub fn id(&self, object: usize) -> ObjectId {
        self.ids[object]
    }

    /// Whether a result holds an object of the world.
    pub fn sees(&self, pvs: &Pvs, object: usize) -> bool {
        pvs.contains(self.ids[object])
    }

    /// The objects of the world that a result holds, ascending.
    pub fn found(&self, pvs: &Pvs) -> Vec<usize> {
        (0..self.ids.len()).filter(|&i| self.sees(pvs, i)).collect()
    }

    /// How many objects whose visibility is asked for a result holds.
    pub fn count(&self, pvs: &Pvs, objects: &[Object]) -> usize {
        self.ids.iter().zip(objects).filter(|(id, o)| o.tested && pvs.contains(**id)).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated::{SceneKind, SceneOptions, build};

    #[test]
    fn static_objects_share_a_mesh_unless_it_is_stretched() {
        let shared = |world: &World| {
            let driver = Driver::new(world, world.grid.cell, |_| ()).unwrap();
            let objects = driver.scene.iter().filter(|o| matches!(o.1.motion(), casca::Motion::Static));
            objects.filter(|o| matches!(o.1.bounds(), Bounds::Instance(_))).count()
        };
        let mut world = build(SceneKind::Rocks, &SceneOptions { scale: 0.1, ..SceneOptions::default() });
        assert_eq!(shared(&world), 25, "rocks of any size");
        let Shape::Mesh { transform, .. } = &mut world.objects[1].shape else { panic!("a rock") };
        *transform *= Affine3A::from_scale(Vec3::new(9.0, 1.0, 1.0));
        assert_eq!(shared(&world), 24, "all but the long one");
    }
}
