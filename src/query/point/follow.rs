//! A run that goes on after static objects came, went or changed.
//!
//! The buffers of the run before stay. What an occluder that is gone covered lies in the pixels around its box: the tiles
//! there are opened, the occluders of other objects that reach into them are drawn again, and the walk finds the objects
//! that come into sight. Objects that are new are tested, and their occluders drawn, like any others. All that is drawn is
//! there, and all that was covered by something that is gone is open: so nothing visible is lost.
//!
//! Open pixels are not refined, since the lists of occluders in the buffers name some that are gone.

use smallvec::SmallVec;

use crate::geometry::Block;
use crate::grid::cell_box::CellBox;
use crate::method::PointOptions;
use crate::query::point::Walk;
use crate::scene::Scene;

/// What a run must be told of the changes since the one before.
#[derive(Debug, Default)]
pub(crate) struct Changes {
    /// The slots of static objects that came or changed.
    pub(crate) fresh: Vec<u32>,
    /// The slots of the objects in the set that stayed as they are.
    pub(crate) known: Vec<u32>,
    /// Around the occluders that are gone, those that changed among them.
    pub(crate) gone: SmallVec<[Block; 4]>,
}

/// The occluders that a kept result rests on.
#[derive(Debug, Clone, Default)]
pub(crate) struct Drawn {
    /// The slots of objects whose occluders were drawn, in order, or that were looked at for it.
    slots: Vec<u32>,
    /// The boxes of opaque cells.
    boxes: Vec<CellBox>,
}

impl Drawn {
    /// Forgets the last run.
    pub(super) fn clear(&mut self) {
        self.slots.clear();
        self.boxes.clear();
    }

    pub(super) fn note(&mut self, slot: u32) {
        self.slots.push(slot);
    }

    pub(super) fn note_box(&mut self, cells: &CellBox) {
        self.boxes.push(*cells);
    }

    /// Puts the slots in order.
    pub(crate) fn settle(&mut self) {
        self.slots.sort_unstable();
        self.slots.dedup();
    }

    /// Whether the occluder of an object was drawn.
    pub(crate) fn has(&self, slot: u32) -> bool {
        self.slots.binary_search(&slot).is_ok()
    }

    /// Takes over the occluders of another run.
    pub(crate) fn append(&mut self, other: &Self) {
        self.slots.extend_from_slice(&other.slots);
        self.boxes.extend_from_slice(&other.boxes);
        self.settle();
    }

    /// Forgets objects, whose slots are in order.
    pub(crate) fn forget(&mut self, slots: &[u32]) {
        self.slots.retain(|slot| slots.binary_search(slot).is_err());
    }

    /// Forgets the boxes with cells that an occluder filled alone or with others. Lists where they are.
    pub(crate) fn forget_boxes(&mut self, scene: &Scene, gone: &Block, out: &mut SmallVec<[Block; 4]>) {
        self.boxes.retain(|cells| {
            let block = Block::new(scene.grid().range_bounds(cells.lo, cells.hi));
            let stays = !block.may_meet(gone);
            if !stays {
                out.push(block);
            }
            stays
        });
    }
}

impl PointOptions {
    /// The same options, but open pixels are not refined.
    pub(crate) fn unrefined(self) -> Self {
        Self { refine_squares: 0, refine_patches: 0, coherent: false, ..self }
    }
}

impl Walk<'_> {
    /// Goes on with the buffers of the last run, which was of the same view. `drawn` are the occluders that are in them and
    /// stayed. Fills the set with the objects that are not known. Returns the share of the pixels that were opened.
    pub(crate) fn follow(mut self, changes: &Changes, drawn: &Drawn) -> f64 {
        changes.known.iter().for_each(|&slot| {
            self.marks.decide(slot);
        });
        let pixels = self.scratch.buffers.pixels().max(1) as f64;
        let holes = self.scratch.buffers.reopen(&changes.gone);
        if !holes.is_empty() {
            for &slot in &drawn.slots {
                let block = self.scene.living_at(slot).and_then(|o| o.occluder()).map(|o| o.block());
                if block.is_some_and(|block| self.scratch.buffers.reaches_into(&block, &holes)) {
                    self.draw(slot);
                }
            }
        }
        changes.fresh.iter().for_each(|&slot| self.find(slot));
        self.settle();
        self.draw_all_patches(i32::MAX);
        if !holes.is_empty() {
            self.find_all();
        }
        self.decide();
        self.pvs.stats = self.stats;
        holes.iter().map(|hole| hole.pixels() as f64).sum::<f64>() / pixels
    }

    /// Draws occluders over the buffers of an earlier run, and gives how many.
    pub(crate) fn draw_over(mut self, slots: impl Iterator<Item = u32>) -> u32 {
        slots.for_each(|slot| self.draw(slot));
        self.draw_all_patches(i32::MAX);
        self.stats.occluders_drawn
    }
}
