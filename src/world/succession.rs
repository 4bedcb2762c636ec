//! The scene in the coordinates around the next origin, while objects are taken over.

use casca_slots::Slot;
use glam::DVec3;

use crate::error::Error;
use crate::id::ObjectId;
use crate::scene::Scene;
use crate::world::options::WorldOptions;
use crate::world::page::PageId;
use crate::world::source::ObjectSource;

/// This many slots without an object cost about as much as a brick.
const EMPTY_SLOTS: usize = 64;

/// The next scene of a world.
pub(super) struct NextScene {
    /// The page whose corner is the origin of its coordinates, and that corner.
    page: PageId,
    origin: DVec3,
    scene: Scene,
    /// All objects in slots below this were taken over.
    reached: usize,
}

impl NextScene {
    /// Without objects, at the time of the scene before.
    ///
    /// # Errors
    /// As [`Scene::new`].
    pub(super) fn new(from: &Scene, page: PageId, options: &WorldOptions) -> Result<Self, Error> {
        let (mut scene, origin) = (Scene::new(options.cell)?, page.corner(options.page_size()));
        scene.set_origin(origin)?;
        scene.set_clock(from);
        Ok(Self { page, origin, scene, reached: 0 })
    }

    pub(super) fn scene(&self) -> &Scene {
        &self.scene
    }

    pub(super) fn scene_mut(&mut self) -> &mut Scene {
        &mut self.scene
    }

    /// Takes over more objects, at the cost of about this many bricks; true once none is left.
    pub(super) fn step(&mut self, from: &Scene, sources: &[Option<ObjectSource>], bricks: usize) -> bool {
        let mut left = bricks.saturating_mul(EMPTY_SLOTS);
        while self.reached < from.slot_count() && left > 0 {
            let slot = Slot::new(self.reached as u32);
            self.reached += 1;
            let source = sources.get(slot.index()).and_then(Option::as_ref);
            let cost = match source.filter(|_| from.living_at(slot).is_some()) {
                Some(source) => {
                    let id = from.id(slot);
                    self.take_over(from, id, source);
                    self.scene.bricks_around(id).saturating_mul(EMPTY_SLOTS)
                }
                None => {
                    self.scene.skip(from, slot);
                    1
                }
            };
            left = left.saturating_sub(cost);
        }
        self.scene.refresh();
        self.reached >= from.slot_count()
    }

    /// An object is new in the scene before.
    pub(super) fn inserted(&mut self, from: &Scene, id: ObjectId, source: &ObjectSource) {
        // Others are reached later.
        if id.index() < self.reached {
            self.take_over(from, id, source);
        }
    }

    fn take_over(&mut self, from: &Scene, id: ObjectId, source: &ObjectSource) {
        let (bounds, occluder) = source.at(self.origin);
        self.scene.take_over(from, id, bounds, occluder);
    }

    /// An object was reported in the scene before.
    pub(super) fn reported(&mut self, id: ObjectId, source: &ObjectSource) {
        if self.scene.contains(id) {
            let (bounds, occluder) = source.at(self.origin);
            self.scene.report_checked(id, bounds, occluder);
        }
    }

    /// An object was removed from the scene before.
    pub(super) fn removed(&mut self, id: ObjectId) {
        // Those that were not reached are not there.
        let _ = self.scene.remove(id);
    }

    /// The scene and the page of its origin, once all objects of the one before were taken over.
    pub(super) fn finish(mut self, from: &mut Scene) -> (Scene, PageId) {
        self.scene.succeed(from);
        (self.scene, self.page)
    }
}
