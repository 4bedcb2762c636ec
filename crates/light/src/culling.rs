//! A scene of the library for a lit scene, on the grid of its voxels.

use casca::{Aabb, Error, Query, Sight, View};
use casca_scenes::drive::Driver;
use casca_scenes::lit::LitScene;
use casca_scenes::world::{Motion, Object, Shape};
use casca_stage::camera::Camera;
use glam::{Affine3A, Vec3};

use crate::volume::Volume;

/// Follows a lit scene, and says which boxes a camera may see.
pub struct Culling {
    driver: Driver,
    objects: Vec<Object>,
    query: Query,
}

impl Culling {
    /// The objects of a scene, all of which hide others.
    ///
    /// # Errors
    /// As [`casca::Scene::insert`].
    pub fn new(scene: &LitScene, volume: &Volume) -> Result<Self, Error> {
        let object = |o: &casca_scenes::lit::LitObject| Object {
            name: o.name.clone(),
            shape: Shape::Mesh { mesh: o.mesh.clone(), transform: o.transform },
            motion: if o.moves { Motion::Dynamic { max_speed: f32::MAX } } else { Motion::Static },
            occludes: true,
            tested: true,
        };
        let objects: Vec<Object> = scene.objects.iter().map(object).collect();
        let driver = Driver::with(&objects, &volume.spec(), |_, desc| desc, |_| ())?;
        Ok(Self { driver, objects, query: Query::new() })
    }

    /// Moves an object; one that does not exist is left out.
    ///
    /// # Errors
    /// As [`casca::Scene::update`].
    pub fn move_object(&mut self, object: usize, to: Affine3A) -> Result<(), Error> {
        let Some(Object { shape: Shape::Mesh { transform, .. }, .. }) = self.objects.get_mut(object) else {
            return Ok(());
        };
        *transform = to;
        self.driver.update(&self.objects, &[object])
    }

    /// Looks from a camera. Ask [`may_see`] about parts of the scene afterwards.
    ///
    /// # Errors
    /// As [`View::perspective`].
    pub fn look(&mut self, camera: &Camera) -> Result<Option<Sight<'_>>, Error> {
        let view = View::perspective(camera.eye, camera.view_projection())?;
        self.query.run(&self.driver.scene, &view);
        Ok(self.query.sight(&self.driver.scene))
    }
}

/// Whether a point of a box may be seen.
pub fn may_see(sight: &Sight<'_>, (min, max): (Vec3, Vec3)) -> bool {
    sight.may_see_box(&Aabb::new(min, max))
}
