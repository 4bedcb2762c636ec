//! Occluders around the eye and before the near plane: through those one sees.

use casca_slots::Slot;
use glam::DVec3;

use crate::geometry::Block;
use crate::grid::cell_box::{CellBox, volume};
use crate::object::Occluder;
use crate::scene::Scene;
use crate::shape::Shape;
use crate::view::{View, cut};

/// Beyond this many cells before the near plane all occluders are asked instead.
const MOST_CELLS: u64 = 4096;

/// After this many questions to the objects of single bricks, all objects are asked once instead.
const MOST_ASKED: usize = 4096;

impl Scene {
    /// Whether a point may lie inside an occluder that is in the matrices and that views of some
    /// layers show.
    pub(crate) fn inside_occluder(&self, point: DVec3, layers: u64) -> bool {
        let cell = self.grid.cell_of(point);
        let around = Block { min: point, max: point };
        let contains = |slot| {
            let occluder = self.shown_occluder(slot, layers);
            occluder.is_some_and(|o| o.block().may_meet(&around) && o.contains_point(point))
        };
        if self.always().iter().copied().any(contains) {
            return true;
        }
        if self.grid.contains(cell) {
            return self.is_opaque(cell, layers) || self.ids.in_brick(cell >> 3i32).any(contains);
        }
        self.any_overhanging(&around, contains)
    }

    /// Whether an object that reaches beyond the grid and may meet a box passes a test.
    fn any_overhanging(&self, around: &Block, mut test: impl FnMut(Slot) -> bool) -> bool {
        let mut found = false;
        self.members.overhang.slots_where(|block| block.may_meet(around), |slot| found = found || test(slot));
        found
    }

    /// The occluder of an object that views of some layers show.
    fn shown_occluder(&self, slot: Slot, layers: u64) -> Option<&Occluder> {
        let object = self.object(slot);
        object.occluder().filter(|_| object.layers & layers != 0)
    }

    /// Whether an occluder, or an opaque cell, that the view `region` shows may touch it. `region`
    /// is convex and lies inside the box `around`.
    pub(crate) fn occluder_touches(&self, region: &View, around: &Block) -> bool {
        let layers = region.layers();
        let touches =
            |slot: Slot| self.shown_occluder(slot, layers).is_some_and(|o| cut::may_meet(o, region, around));
        // Cells tell nothing about what reaches beyond the grid.
        let always =
            || self.always().iter().any(|&slot| touches(slot)) || self.any_overhanging(around, touches);
        let (lo, hi) = self.grid.cover(around.min, around.max);
        let Some((lo, hi)) = self.grid.clip(lo, hi) else { return always() };
        let anywhere = || self.living().any(|(slot, _)| touches(slot));
        if volume(lo, hi) > MOST_CELLS {
            return anywhere();
        }
        if always() {
            return true;
        }
        let mut asked = 0;
        let opaque =
            |c| self.is_opaque(c, layers) && region.may_see_block(&Block::new(self.grid.cell_bounds(c)));
        if (CellBox { lo, hi }).cells().any(opaque) {
            return true;
        }
        for brick in (CellBox { lo: lo >> 3i32, hi: hi >> 3i32 }).cells() {
            if self.ids.in_brick(brick).inspect(|_| asked += 1).any(touches) {
                return true;
            }
            // Objects that share many of these bricks would be asked again in each.
            if asked > self.len().max(MOST_ASKED) {
                return anywhere();
            }
        }
        false
    }
}
