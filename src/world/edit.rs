//! Changing the objects of a world one by one.

use glam::{Affine3A, DVec3};

use crate::error::Error;
use crate::id::ObjectId;
use crate::object::{Bounds, ObjectDesc, Occluder};
use crate::scene::origin::check_place;
use crate::world::World;
use crate::world::page::{PageId, check};
use crate::world::source::ObjectSource;

impl World {
    /// Inserts an object at a place. Its shapes are relative to that, in world units; a transform
    /// ([`ObjectDesc::placed`]) leads from the space of the shapes to the one around the place. It
    /// belongs to the world and not to a page: for what moves through it.
    ///
    /// Costs as [`Scene::insert`](crate::Scene::insert), at once; twice that while the origin
    /// moves.
    ///
    /// # Errors
    /// As [`Scene::insert`](crate::Scene::insert); also refuses a place that is not finite or
    /// farther than 2^60 world units from the origin.
    pub fn insert(&mut self, desc: ObjectDesc, at: DVec3) -> Result<ObjectId, Error> {
        check_place("the place", at)?;
        check(&desc)?;
        self.commit(desc, at, None)
    }

    /// Takes an object in that was checked.
    pub(super) fn commit(
        &mut self,
        mut desc: ObjectDesc,
        at: DVec3,
        page: Option<PageId>,
    ) -> Result<ObjectId, Error> {
        let source = ObjectSource::of(&mut desc, at, page);
        (desc.bounds, desc.occluder) = source.at(self.origin());
        let id = self.scene.insert_checked(desc, None)?;
        if self.sources.len() <= id.index() {
            self.sources.resize_with(id.index() + 1, || None);
        }
        if let Some(next) = &mut self.next {
            next.inserted(&self.scene, id, &source);
        }
        self.sources[id.index()] = Some(source);
        Ok(id)
    }

    /// Takes an object out, of a page or not. Costs as [`Scene::remove`](crate::Scene::remove);
    /// twice that while the origin moves.
    ///
    /// # Errors
    /// Refuses an id that names no object of this world.
    pub fn remove(&mut self, id: ObjectId) -> Result<(), Error> {
        self.scene.remove(id)?;
        if let Some(next) = &mut self.next {
            next.removed(id);
        }
        self.sources[id.index()] = None;
        Ok(())
    }

    /// Moves an object to another place, with its shapes as they are. An object of a page still
    /// goes with its page.
    ///
    /// Costs as [`Scene::update`](crate::Scene::update), and the placing of its shapes; twice that
    /// while the origin moves. Like that it is the report of an object that is reported on expiry.
    ///
    /// # Errors
    /// Refuses an id that names no object of this world, and places as [`World::insert`].
    pub fn set_place(&mut self, id: ObjectId, at: DVec3) -> Result<(), Error> {
        check_place("the place", at)?;
        self.change(id, |source| {
            source.place = at;
            Ok(())
        })
    }

    /// Moves an object to another place and gives it another transform there, which leads from the
    /// space of its shapes to the one around the place. Costs as [`World::set_place`].
    ///
    /// # Errors
    /// As [`World::set_place`], and for transforms as
    /// [`Scene::set_transform`](crate::Scene::set_transform); instances of meshes have their own
    /// ([`Error::PlacedTwice`]). The object then stays as it is.
    pub fn set_transform(&mut self, id: ObjectId, at: DVec3, transform: Affine3A) -> Result<(), Error> {
        check_place("the place", at)?;
        self.change(id, |source| {
            source.place = at;
            source.transform = Some(Box::new(transform));
            source.check()
        })
    }

    /// Gives an object other shapes, relative to its place and under its transform if it has one.
    /// Costs as [`World::set_place`].
    ///
    /// # Errors
    /// Refuses an id that names no object of this world, and shapes as [`World::insert`]. The
    /// object then stays as it is.
    pub fn set_shapes(
        &mut self,
        id: ObjectId,
        bounds: impl Into<Bounds>,
        occluder: Option<Occluder>,
    ) -> Result<(), Error> {
        let bounds = bounds.into();
        self.change(id, |source| {
            (source.bounds, source.occluder) = (bounds, occluder);
            source.check()
        })
    }

    /// Gives an object another number: see [`Scene::user_data`](crate::Scene::user_data).
    ///
    /// # Errors
    /// Refuses an id that names no object of this world.
    pub fn set_user_data(&mut self, id: ObjectId, user_data: u64) -> Result<(), Error> {
        self.scene.set_user_data(id, user_data)?;
        if let Some(next) = &mut self.next {
            // It may not be there yet: then it comes with its number.
            let _ = next.scene_mut().set_user_data(id, user_data);
        }
        Ok(())
    }

    /// Puts an object on other layers: see [`Scene::set_layers`](crate::Scene::set_layers).
    ///
    /// # Errors
    /// Refuses an id that names no object of this world.
    pub fn set_layers(&mut self, id: ObjectId, mask: u64) -> Result<(), Error> {
        self.scene.set_layers(id, mask)?;
        if let Some(next) = &mut self.next {
            // It may not be there yet: then it comes with its layers.
            let _ = next.scene_mut().set_layers(id, mask);
        }
        Ok(())
    }

    /// Changes the description of an object and reports it; if the change is refused, it stays.
    fn change(
        &mut self,
        id: ObjectId,
        edit: impl FnOnce(&mut ObjectSource) -> Result<(), Error>,
    ) -> Result<(), Error> {
        self.scene.find(id)?;
        let origin = self.origin();
        let Some(own) = self.sources[id.index()].as_mut() else { return Err(Error::UnknownObject(id)) };
        let before = own.clone();
        if let Err(why) = edit(own) {
            *own = before;
            return Err(why);
        }
        let (bounds, occluder) = own.at(origin);
        self.scene.report_checked(id, bounds, occluder);
        if let Some(next) = &mut self.next {
            next.reported(id, own);
        }
        Ok(())
    }
}
