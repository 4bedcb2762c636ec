//! A scene that follows another one under the same ids, in other coordinates: objects are taken
//! over one by one while the other still answers queries.

use casca_slots::Slot;

use crate::error::Error;
use crate::id::ObjectId;
use crate::object::{Bounds, ObjectDesc, Occluder};
use crate::scene::Scene;
use crate::scene::object::Object;

impl Scene {
    /// Inserts an object whose description was checked elsewhere, in other coordinates.
    ///
    /// # Errors
    /// Refuses more than 2^31 objects.
    pub(crate) fn insert_checked(&mut self, desc: ObjectDesc) -> Result<ObjectId, Error> {
        let user_data = desc.user_data;
        let (object, occluder) = self.object_of(desc);
        let slot = self.slots.insert(object).ok_or(Error::SceneFull(self.slots.len()))?;
        self.user_data.set(slot, user_data);
        self.changes.changed();
        self.note_report(slot);
        self.note_static(slot);
        self.exchange_occluder(slot, occluder);
        self.list(slot);
        Ok(self.id(slot))
    }

    /// Takes over an object of another scene under its id, with its shapes in the coordinates of
    /// this one. The place of one that is reported on expiry is not known until it is reported.
    pub(crate) fn take_over(
        &mut self,
        from: &Self,
        id: ObjectId,
        bounds: Bounds,
        occluder: Option<Occluder>,
    ) {
        let Ok(object) = from.find(id) else { return };
        let user_data = from.user_data.get(id.slot());
        let desc = ObjectDesc {
            bounds,
            occluder,
            motion: object.motion(),
            contradicts: false,
            user_data,
            layers: object.layers,
            transform: None,
        };
        let (object, occluder) = self.object_of(desc);
        let slot = id.slot();
        if !self.slots.take_over(id.0, object) {
            return;
        }
        self.changes.changed();
        self.user_data.set(slot, user_data);
        self.reports.forget(slot);
        self.note_static(slot);
        self.exchange_occluder(slot, occluder);
        self.list(slot);
    }

    fn object_of(&self, mut desc: ObjectDesc) -> (Object, Option<Occluder>) {
        let occluder = desc.occluder.take();
        (Object::new(desc, None, self.changes.moves), occluder)
    }

    /// A slot of another scene, whose objects this one takes over, holds no object.
    pub(crate) fn skip(&mut self, from: &Self, slot: Slot) {
        self.slots.skip(slot, &from.slots);
    }

    /// Sets the clock to that of another scene.
    pub(crate) fn set_clock(&mut self, from: &Self) {
        self.now = from.now;
    }

    /// Gives out ids where another scene ends, all of whose objects were taken over.
    pub(crate) fn succeed(&mut self, from: &mut Self) {
        self.slots.succeed(&mut from.slots);
    }

    /// As [`Scene::update`], with shapes that were checked elsewhere, in other coordinates.
    pub(crate) fn report_checked(&mut self, id: ObjectId, bounds: Bounds, occluder: Option<Occluder>) {
        if self.contains(id) {
            self.report(id.slot(), bounds, occluder);
        }
    }

    /// Roughly what it costs to insert or to remove an object, in bricks of 8x8x8 cells: those on
    /// the surface of its box, as far as that lies in the grid; 1 at least.
    pub(crate) fn bricks_around(&self, id: ObjectId) -> usize {
        let Ok(object) = self.find(id) else { return 1 };
        let block = object.bounds().block();
        let (lo, hi) = self.grid.cover(block.min, block.max);
        let Some((lo, hi)) = self.grid.clip(lo, hi) else { return 1 };
        let sides = ((hi >> 3i32) - (lo >> 3i32) + 1).to_array().map(|side| side as usize);
        let inside: usize = sides.iter().map(|side| side.saturating_sub(2)).product();
        sides.iter().product::<usize>() - inside
    }

    /// Brings the boxes that close seams up to date with the static solids inserted and removed.
    pub(crate) fn refresh(&mut self) {
        self.opacity.refresh();
    }
}
