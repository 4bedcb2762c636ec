//! The volumes of hidden objects that a widened view may see.

use casca_slots::{Slot, SlotSet};
use glam::IVec3;

use crate::geometry::Block;
use crate::grid::cell_box::CellBox;
use crate::query::Query;
use crate::query::marks::Marks;
use crate::scene::Scene;
use crate::view::View;

/// The hidden objects whose volumes are watched: all others stay hidden as long as they stay in
/// their volumes.
#[derive(Debug, Clone, Default)]
pub(super) struct Watch {
    slots: SlotSet,
    /// The number of entries of the scene's journal when volumes were last tested; `None` before.
    heard: Option<u64>,
    /// The volumes that a test of all of them has been at.
    marks: Marks,
}

/// A widened view with the query that drew the static occluders for it.
#[derive(Clone, Copy)]
pub(super) struct Drawn<'a> {
    pub(super) scene: &'a Scene,
    pub(super) view: &'a View,
    pub(super) query: &'a Query,
}

impl Drawn<'_> {
    /// Whether the volume of an object must be watched.
    fn sees(&self, slot: Slot) -> bool {
        let Self { scene, view, query } = *self;
        scene.is_hidden(slot)
            && scene.object(slot).is_shown(view)
            && query.drawn().sees_volume(view, &scene.volume_block(slot))
    }

    /// Whether volumes with surface in a brick may be in sight.
    fn may_see_brick(&self, brick: IVec3) -> bool {
        let Self { scene, view, query } = *self;
        let Some(CellBox { lo, hi }) = scene.tbv_matrix().extent(brick) else { return false };
        let block = Block::new(scene.grid().range_bounds(lo, hi));
        view.may_see_volume(&block) && !query.drawn().hides(&block)
    }
}

impl Watch {
    /// The slots of the objects, some of which may have left their volumes.
    pub(super) fn slots(&self) -> &[Slot] {
        self.slots.as_slice()
    }

    /// Tests the volumes that are new since the last call, or all of them.
    pub(super) fn update(&mut self, drawn: &Drawn) {
        let journal = drawn.scene.journal();
        match self.heard.and_then(|heard| journal.since(heard)) {
            Some(new) => new.for_each(|slot| self.test(drawn, slot)),
            None => self.test_all(drawn),
        }
        self.heard = Some(journal.end());
    }

    fn test(&mut self, drawn: &Drawn, slot: Slot) {
        if drawn.sees(slot) {
            self.slots.insert(slot);
        } else {
            self.slots.remove(slot);
        }
    }

    fn test_once(&mut self, drawn: &Drawn, slot: Slot) {
        if self.marks.decide(slot) {
            self.test(drawn, slot);
        }
    }

    /// Tests all volumes, brick by brick.
    fn test_all(&mut self, drawn: &Drawn) {
        let scene = drawn.scene;
        self.slots = SlotSet::default();
        self.marks.begin(scene.slot_count());
        // Rays may start inside a volume. Parallel ones may enter it where no brick of the view is.
        match drawn.view.eye() {
            Some(eye) => {
                let around = scene.volumes_around(scene.grid().cell_of(eye));
                around.into_iter().for_each(|slot| self.test_once(drawn, slot));
            }
            None => Slot::below(scene.slot_count()).for_each(|slot| self.test_once(drawn, slot)),
        }
        for brick in scene.tbv_matrix().bricks().filter(|&brick| drawn.may_see_brick(brick)) {
            scene.tbv_matrix().ids(brick).for_each(|slot| self.test_once(drawn, slot));
        }
    }
}
