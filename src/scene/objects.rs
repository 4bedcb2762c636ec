//! Reading the objects of a scene: one by its id, or all of them.

use std::fmt;

use casca_slots::Slot;
use glam::{Affine3A, DVec3};

use crate::error::Error;
use crate::id::ObjectId;
use crate::object::{Bounds, Motion, Occluder, transform_of_instances};
use crate::scene::Scene;
use crate::scene::object::Object;
use crate::scene::state::State;

/// An object of a scene, to read. [`Scene::iter`] gives them.
#[derive(Debug, Clone, Copy)]
pub struct ObjectRef<'a> {
    object: &'a Object,
    user_data: u64,
}

impl<'a> ObjectRef<'a> {
    /// The shape that is tested for visibility, as last reported.
    pub fn bounds(&self) -> &'a Bounds {
        self.object.bounds()
    }

    /// The shape that hides others, if it has one.
    pub fn occluder(&self) -> Option<&'a Occluder> {
        self.object.given_occluder()
    }

    /// Whether it moves, and how.
    pub fn motion(&self) -> Motion {
        self.object.motion()
    }

    /// The layers that it is on: see [`crate::ObjectDesc::layers`].
    pub fn layers(&self) -> u64 {
        self.object.layers
    }

    /// The number that the application gave it: see [`Scene::user_data`].
    pub fn user_data(&self) -> u64 {
        self.user_data
    }
}

impl fmt::Debug for Scene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Scene({} objects in {:?})", self.len(), self.grid())
    }
}

impl Scene {
    /// Whether an id names an object of this scene. Costs one look-up.
    pub fn contains(&self, id: ObjectId) -> bool {
        self.find(id).is_ok()
    }

    /// The ids of all objects, in the order of [`ObjectId::index`]. Costs a look at each index ever
    /// given.
    pub fn ids(&self) -> impl Iterator<Item = ObjectId> {
        self.living().map(|(slot, _)| self.id(slot))
    }

    /// All objects with their ids, in the order of [`ObjectId::index`]. Costs a look at each index
    /// ever given.
    ///
    /// ```
    /// use casca::{GridSpec, ObjectDesc, Scene, Sphere};
    /// use glam::{UVec3, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// let mut scene = Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(16) })?;
    /// let ball = Sphere::new(Vec3::splat(4.0), 1.0);
    /// let id = scene.insert(ObjectDesc::fixed(ball).occluder(ball).user_data(7))?;
    /// scene.insert(ObjectDesc::dynamic(ball))?;
    /// let hiding: Vec<_> = scene.iter().filter(|(_, object)| object.occluder().is_some()).collect();
    /// assert_eq!(hiding.len(), 1);
    /// assert_eq!((hiding[0].0, hiding[0].1.user_data()), (id, 7));
    /// # Ok(())
    /// # }
    /// ```
    pub fn iter(&self) -> impl Iterator<Item = (ObjectId, ObjectRef<'_>)> {
        self.living()
            .map(|(slot, object)| (self.id(slot), ObjectRef { object, user_data: self.user_data.get(slot) }))
    }

    /// The shape by which an object's visibility is tested, as last reported.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn bounds(&self, id: ObjectId) -> Result<&Bounds, Error> {
        self.find(id).map(Object::bounds)
    }

    /// The shape by which an object hides others, if it has one.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn occluder(&self, id: ObjectId) -> Result<Option<&Occluder>, Error> {
        self.find(id).map(Object::given_occluder)
    }

    /// The transform of an object that [`Scene::set_transform`] moves, as last reported; `None` for
    /// other objects.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn transform(&self, id: ObjectId) -> Result<Option<Affine3A>, Error> {
        let object = self.find(id)?;
        let own = object.placed().map(|placed| placed.transform);
        Ok(own.or_else(|| transform_of_instances(object.bounds(), object.given_occluder())))
    }

    /// The corners of the temporal bounding volume that an object is in, in world units; `None` if
    /// it is in none.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn tbv(&self, id: ObjectId) -> Result<Option<(DVec3, DVec3)>, Error> {
        Ok(match self.find(id)?.state() {
            State::Hidden(hidden) => Some((hidden.tbv.block.min, hidden.tbv.block.max)),
            _ => None,
        })
    }

    /// The layers that an object is on, a bit for each: see [`crate::ObjectDesc::layers`].
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn layers(&self, id: ObjectId) -> Result<u64, Error> {
        self.find(id).map(|object| object.layers)
    }

    /// The number that the application gave an object, 0 if it gave none: an index into its own
    /// tables, or the handle of an entity. The scene does nothing with it.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn user_data(&self, id: ObjectId) -> Result<u64, Error> {
        self.find(id).map(|_| self.user_data.get(id.slot()))
    }

    /// An id in 64 bits, for tables and interfaces that have no room for an [`ObjectId`]: its
    /// [index](ObjectId::index) in the low 32 bits, and the generation of that index in the high
    /// ones.
    ///
    /// A key leaves out the scene. It names one object of one scene for ever: no key is given twice
    /// in the life of a scene. In another scene the same key may name another object, and nothing
    /// tells it apart there; in a clone it names the same object if that was there when the clone
    /// was made. Where ids of several scenes may be mixed up, keep the [`ObjectId`]: 64 bits cannot
    /// tell scenes, indices and generations apart for certain.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn key(&self, id: ObjectId) -> Result<u64, Error> {
        self.find(id)?;
        Ok(u64::from(id.generation()) << 32 | u64::from(id.slot().get()))
    }

    /// The id that a [key](Scene::key) of this scene stands for. Costs one look-up.
    ///
    /// ```
    /// # use casca::{Error, GridSpec, ObjectDesc, Scene, Sphere};
    /// # use glam::{UVec3, Vec3};
    /// # fn main() -> Result<(), Error> {
    /// # let mut scene = Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(16) })?;
    /// # let id = scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::splat(4.0), 1.0)))?;
    /// let key: u64 = scene.key(id)?;
    /// assert_eq!(scene.id_from_key(key)?, id);
    /// scene.remove(id)?;
    /// assert_eq!(scene.id_from_key(key), Err(Error::UnknownKey(key)));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Refuses a key that names no object of this scene, such as that of one that was removed.
    pub fn id_from_key(&self, key: u64) -> Result<ObjectId, Error> {
        let (slot, generation) = (Slot::new(key as u32), (key >> 32) as u32);
        let living = self.slots.of_generation(slot, generation);
        living.map(|_| self.id(slot)).ok_or(Error::UnknownKey(key))
    }
}
