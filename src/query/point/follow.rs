//! A run that goes on after static objects came, went or changed.
//!
//! The buffers of the run before stay. Where an occluder is gone, the tiles around its box are
//! opened, that box grown by the reach; the occluders of other objects that reach into them are
//! drawn again, and the walk finds the objects that come into sight. Objects that are new are
//! tested, and their occluders drawn, like any others.
//!
//! Nothing visible is lost: let a pixel be covered that was not opened. Every ray that it hides,
//! from any eye within reach, met a solid, a patch or a box of opaque cells. A ray that ends in a
//! pixel that was not opened passes no point of an occluder that is gone: otherwise the ray from
//! the middle to the same end would pass within the reach of that point. So the ray met others,
//! which are there; also in a box of cells, each of which solids fill that are there or that the
//! ray does not meet. Occluders that were never offered need no hole: no free ray reached them.
//!
//! Open pixels are not refined, since the lists of occluders in the buffers name some that are
//! gone.

use casca_slots::Slot;
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::method::PointOptions;
use crate::query::point::PointWalk;
use crate::query::point::offered::Offered;

/// What a run must be told of the changes since the one before.
#[derive(Debug, Default)]
pub(crate) struct StaticChanges {
    /// The slots of static objects that came or changed.
    pub(crate) fresh: Vec<Slot>,
    /// The slots of the objects in the set that stayed as they are.
    pub(crate) known: Vec<Slot>,
    /// Around the occluders that are gone, those that changed among them.
    pub(crate) gone: SmallVec<[Block; 4]>,
}

impl PointOptions {
    /// The same options, but open pixels are not refined.
    pub(crate) fn unrefined(self) -> Self {
        Self { refine_squares: 0, refine_patches: 0, coherent: false, ..self }
    }
}

impl PointWalk<'_> {
    /// Goes on with the buffers of the last run, which was of the same view. `offered` are the
    /// objects that they rest on and that stayed. Fills the set with the objects that are not
    /// known. Returns the share of the pixels that were opened.
    pub(crate) fn follow(mut self, changes: &StaticChanges, offered: &Offered) -> f64 {
        changes.known.iter().for_each(|&slot| {
            self.marks.decide(slot);
        });
        let pixels = self.drawing.buffers().pixels().max(1) as f64;
        let holes = self.drawing.buffers_mut().reopen(&changes.gone);
        if !holes.is_empty() {
            for slot in offered.slots() {
                let block = self.run.scene.living_at(slot).and_then(|o| o.occluder()).map(|o| o.block());
                if block.is_some_and(|block| self.drawing.buffers().reaches_into(&block, &holes)) {
                    self.drawing.draw(slot);
                }
            }
        }
        changes.fresh.iter().for_each(|&slot| self.find(slot));
        self.settle();
        self.drawing.draw_all_patches(i32::MAX);
        if !holes.is_empty() {
            self.find_all();
        }
        self.decide();
        self.pvs.stats = self.drawing.stats;
        holes.iter().map(|hole| hole.pixels() as f64).sum::<f64>() / pixels
    }
}
