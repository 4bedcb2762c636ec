//! Views from which nothing is taken to be hidden: objects are compared with the frustum, and no
//! cells are visited.

use casca_slots::Slot;

use crate::query::cell::CellWalk;

/// An entry of the list of all that the frustum meets, in the order in which it is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Found {
    Volume,
    Object,
}

impl CellWalk<'_> {
    /// Finds the volumes and objects in the frustum, in the order of the shells in which their
    /// boxes begin. The cost follows the number of objects, whatever the size of the grid.
    pub(super) fn find_everything(&mut self) {
        let scene = self.scene;
        let begins = self.shells.begins(scene.grid());
        let mut found = Vec::new();
        for (slot, object) in scene.living().filter(|(_, object)| object.is_shown(self.view)) {
            let mut first = 0;
            if object.is_hidden() {
                if !self.may_see_volume_of(slot) {
                    continue;
                }
                first = begins.shell(&scene.volume_block(slot));
                found.push((first, slot, Found::Volume));
                if object.on_expiry() {
                    continue;
                }
            } else {
                self.marks.decide(slot);
            }
            if self.is_in_view(slot) {
                found.push((begins.shell(&object.bounds().block()).max(first), slot, Found::Object));
            }
        }
        found.sort_unstable();
        for (_, slot, what) in found {
            match what {
                Found::Volume => {
                    self.uncover(slot);
                }
                Found::Object => {
                    self.marks.decide(slot);
                    self.pvs.push(scene.id(slot));
                }
            }
        }
    }

    /// Whether the frustum, or the widened frustum of a walk, may meet a volume.
    fn may_see_volume_of(&self, slot: Slot) -> bool {
        let volumes = self.scene.volumes();
        let (cells, v) = (volumes.cells(slot), self.shells.cell);
        let meets = || match volumes.is_outer(slot) {
            true => self.from_eye && cells.contains(v),
            false => self.shells.frustum.meets(cells.lo - v, cells.hi - v),
        };
        self.view.may_see_volume(&self.scene.volume_block(slot)) || meets()
    }
}
