//! Temporal bounding volumes: tested like objects, and opened when they are in sight.

use casca_slots::Slot;
use glam::DVec3;

use crate::geometry::Block;
use crate::grid::cell_box::CellBox;
use crate::query::point::PointWalk;

impl PointWalk<'_> {
    /// Reveals the volumes around the eye: their surface is not between the eye and the objects in
    /// them.
    pub(super) fn reveal_around(&mut self, eye: DVec3) {
        let scene = self.run.scene;
        let cell = scene.grid().cell_of(eye);
        if self.run.fixed_only || !scene.grid().contains(cell) {
            return;
        }
        let mut around = Vec::new();
        scene.volumes().holding(cell, |slot| around.push(slot));
        around.sort_unstable();
        around.into_iter().for_each(|slot| self.reveal(slot));
    }

    /// Tests the volumes of the bricks walked since the last call, after all objects as near are
    /// drawn.
    pub(super) fn test_volumes(&mut self) {
        let mut bricks = std::mem::take(&mut self.scratch.volumes);
        let scene = self.run.scene;
        for brick in bricks.drain(..) {
            let Some(CellBox { lo, hi }) = scene.tbv_matrix().extent(brick) else { continue };
            let mut ids = scene.tbv_matrix().ids(brick);
            if ids.all(|s| self.marks.is_revealed(s))
                || self.drawing.hides(&Block::new(scene.grid().range_bounds(lo, hi)))
            {
                continue;
            }
            for slot in scene.tbv_matrix().ids(brick) {
                self.test_volume(slot);
            }
        }
        self.scratch.volumes = bricks;
    }

    /// Tests the volumes that leave the grid, where the walk does not go.
    pub(super) fn test_outer_volumes(&mut self) {
        let scene = self.run.scene;
        let mut slots = std::mem::take(&mut self.scratch.open);
        slots.clear();
        scene.volumes().outer().slots_where(|block| self.may_see_around(block), |slot| slots.push(slot));
        slots.iter().for_each(|&slot| self.test_volume(slot));
        self.scratch.open = slots;
        self.settle();
    }

    /// Finds the objects that reach beyond the grid and were not found in their bricks: a brick out
    /// of sight, or a hidden one, tells nothing about the parts of its objects beyond the grid.
    pub(super) fn find_overhanging(&mut self) {
        let scene = self.run.scene;
        let mut slots = std::mem::take(&mut self.scratch.open);
        slots.clear();
        scene.overhang().slots_where(|block| self.may_see_around(block), |slot| slots.push(slot));
        slots.iter().for_each(|&slot| self.find(slot));
        self.scratch.open = slots;
        if !self.scratch.found.is_empty() {
            self.settle();
            self.drawing.draw_all_patches(self.around.as_ref().map_or(0, |shells| shells.farthest));
        }
    }

    /// Whether a box around boxes beyond the grid may be in sight.
    fn may_see_around(&self, block: &Block) -> bool {
        self.run.view.may_see_volume(block) && !self.drawing.hides(block)
    }

    /// Reveals a volume that is in sight.
    pub(super) fn test_volume(&mut self, slot: Slot) {
        if self.run.fixed_only || self.marks.is_revealed(slot) {
            return;
        }
        let bounds = self.run.scene.volume_block(slot);
        if self.drawing.sees_volume(&bounds) {
            self.reveal(slot);
        }
    }

    /// Marks the volume of an object as revealed, and finds the object.
    fn reveal(&mut self, slot: Slot) {
        if !self.marks.reveal(slot) || !self.run.scene.object(slot).is_shown(self.run.view) {
            return;
        }
        self.drawing.stats.tbvs_revealed += 1;
        self.pvs.revealed.push(self.run.scene.id(slot));
        self.find(slot);
    }
}
