//! Changes of a scene: objects come, move and go.

use casca_slots::Slot;

use crate::error::Error;
use crate::geometry::Shape;
use crate::id::ObjectId;
use crate::object::{ObjectDesc, check_pair};
use crate::raster::touched;
use crate::scene::Scene;
use crate::scene::object::Object;
use crate::scene::state::State;

impl Scene {
    /// Adds an object. A dynamic one counts as visible until a frame ends without it. Costs the
    /// cells that its bounds touch: four bytes each, and 1.5 kB for each 8x8 cells that were empty;
    /// also the cells inside its occluder. An object that touches the border of the grid or leaves
    /// it, or touches more cells than twice the number around the grid, is looked at in every query
    /// instead.
    ///
    /// # Errors
    /// Refuses shapes that are not finite or inverted, or have a negative radius, occluders that
    /// stick out of the rectangle around their bounds by more than a thousandth of its diagonal,
    /// speeds that are not finite or negative, speeds of fixed objects, objects without speed that
    /// are reported on expiry, and more than 2^31 objects.
    pub fn insert(&mut self, desc: ObjectDesc) -> Result<ObjectId, Error> {
        desc.check()?;
        let object = Object::new(desc, self.now);
        let slot = self.slots.insert(object).ok_or(Error::SceneFull(self.slots.len()))?;
        self.revision += 1;
        self.list(slot);
        Ok(self.id(slot))
    }

    /// Moves an object or changes its shape: all of it, in world units. For an object that is
    /// reported on expiry this is the report, also where nothing changed.
    ///
    /// A hidden object that stays inside its temporal bounding volume costs a comparison. One that
    /// leaves its volume, as fast as it promised or faster, gets another one. Others cost the cells
    /// that they touched and touch, and those inside their occluders.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene, shapes as [`Scene::insert`], and an update
    /// without occluder of an object that has one (see [`Scene::set_occluder`]).
    pub fn update(
        &mut self,
        id: ObjectId,
        bounds: impl Into<Shape>,
        occluder: Option<Shape>,
    ) -> Result<(), Error> {
        let bounds = bounds.into();
        check_pair(&bounds, occluder.as_ref())?;
        if occluder.is_none() && self.find(id)?.occluder.is_some() {
            return Err(Error::OccluderMissing(id));
        }
        self.replace(id, bounds, occluder)
    }

    /// Gives an object another occluder, or takes away the one that it has. Its bounds stay. Costs
    /// as [`Scene::update`]; like that it is the report of an object that is reported on expiry: it
    /// says that the object is where its bounds are.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene, and shapes as [`Scene::insert`].
    pub fn set_occluder(&mut self, id: ObjectId, occluder: Option<Shape>) -> Result<(), Error> {
        let bounds = self.bounds(id)?.clone();
        check_pair(&bounds, occluder.as_ref())?;
        self.replace(id, bounds, occluder)
    }

    /// Gives an object another number: see [`Scene::user_data`]. Results keep holding.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn set_user_data(&mut self, id: ObjectId, user_data: u64) -> Result<(), Error> {
        self.find(id)?;
        if let Some(object) = self.slots.get_mut(id.slot()) {
            object.user_data = user_data;
        }
        Ok(())
    }

    /// Takes an object out. Costs the cells that it touches, and the other objects in them; those
    /// of the outline of its volume, if it is hidden.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn remove(&mut self, id: ObjectId) -> Result<(), Error> {
        self.find(id)?;
        self.take_out(id.slot());
        self.slots.remove(id.slot());
        self.revision += 1;
        Ok(())
    }

    /// Takes all objects out. Their ids are refused from now on; the grid and the clock stay.
    pub fn clear(&mut self) {
        let living: Vec<Slot> = self.slots.iter().map(|(slot, _)| slot).collect();
        // In reverse, so that the slots are given out again in their order.
        for slot in living.into_iter().rev() {
            self.take_out(slot);
            self.slots.remove(slot);
        }
        self.revision += 1;
    }

    fn replace(&mut self, id: ObjectId, bounds: Shape, occluder: Option<Shape>) -> Result<(), Error> {
        self.find(id)?;
        self.report(id.slot(), bounds, occluder);
        self.revision += 1;
        Ok(())
    }

    /// Enters an object that is in no matrix into the lists of its cells, or into the list of those
    /// that are in none, and fills the cells inside its occluder.
    pub(super) fn list(&mut self, slot: Slot) {
        let Some(object) = self.slots.get(slot) else { return };
        let (dynamic, on_expiry) = (object.mover.is_some(), object.on_expiry());
        if self.is_outer(&object.bounds) {
            self.push_outer(slot);
        } else {
            self.lists.insert(slot, &object.bounds, &self.grid);
        }
        self.fill(slot);
        if dynamic {
            self.listed.insert(slot);
            self.listed_on_expiry += u32::from(on_expiry);
            self.set_state(slot, State::Listed);
        }
    }

    /// Undoes [`Scene::list`].
    pub(super) fn unlist(&mut self, slot: Slot) {
        self.unfill(slot);
        let Some(object) = self.slots.get(slot) else { return };
        if object.mover.is_some() {
            self.listed.remove(slot);
            self.lost.remove(slot);
            self.listed_on_expiry -= u32::from(object.on_expiry());
        }
        if !self.take_outer(slot)
            && let Some(object) = self.slots.get(slot)
        {
            self.lists.remove(slot, &object.bounds, &self.grid);
        }
    }

    /// Adds an object to the list of those that are in no cells.
    fn push_outer(&mut self, slot: Slot) {
        self.outer.push(slot);
        let place = self.outer.len() as u32;
        self.slots.get_mut(slot).into_iter().for_each(|object| object.outer = place);
    }

    /// Takes an object out of that list; false if it is not in it.
    fn take_outer(&mut self, slot: Slot) -> bool {
        let place = self.slots.get_mut(slot).map_or(0, |object| std::mem::take(&mut object.outer));
        let Some(place) = place.checked_sub(1) else { return false };
        self.outer.swap_remove(place as usize);
        // Another object may have taken its place.
        if let Some(&other) = self.outer.get(place as usize)
            && let Some(other) = self.slots.get_mut(other)
        {
            other.outer = place + 1;
        }
        true
    }

    /// Whether a shape is in no lists of cells: it leaves the grid, or touches more cells than
    /// twice the number around the grid.
    pub(super) fn is_outer(&self, bounds: &Shape) -> bool {
        let (grid, block) = (&self.grid, bounds.block());
        if !grid.surrounds(block.min, block.max) {
            return true;
        }
        let most = 4 * (grid.dims().x + grid.dims().y) as u64;
        let mut cells = 0;
        touched(bounds, grid, &mut |_, xs| cells += xs.count() as u64);
        cells > most
    }
}
