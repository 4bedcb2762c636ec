//! Objects and temporal bounding volumes whose cells are in sight.

use casca_slots::Slot;
use glam::IVec3;

use crate::grid::cell_box::volume;
use crate::grid::side::Side;
use crate::matrix::tbv::TbvMatrix;
use crate::pvs::Pvs;
use crate::query::cell::lists::CellLists;
use crate::query::cell::shell_scale::ShellScale;
use crate::query::cell::side::Hit;
use crate::query::cell::sides::{ShellSide, is_hidden};
use crate::query::marks::Marks;
use crate::scene::Scene;
use crate::shape::Which;
use crate::view::View;
use crate::walk::Shells;

/// A revealed object with more cells than this is decided without testing which of them are in
/// sight.
const MAX_PENDING: u64 = 1 << 18;

/// Finds the objects of a run: it owns the set, the marks of decided objects, and the cells whose
/// visibility decides about others.
pub(super) struct Finder<'a> {
    pub(super) scene: &'a Scene,
    pub(super) view: &'a View,
    pub(super) shells: &'a Shells,
    pub(super) pvs: &'a mut Pvs,
    pub(super) marks: &'a mut Marks,
    /// For each shell, the cells there of revealed objects that are not decided.
    pub(super) pending: &'a mut Vec<Vec<(IVec3, Slot)>>,
}

impl Finder<'_> {
    /// Decides the objects in the viewer's own cell, and reveals the volumes around it.
    pub(super) fn first_cell(&mut self, lists: &CellLists) {
        lists.of(self.shells.cell).for_each(|slot| self.decide(slot));
        let around = self.scene.volumes_around(self.shells.cell);
        around.into_iter().for_each(|slot| self.reveal(slot, 0));
        if let Some(first) = self.pending.first_mut() {
            for (_, slot) in std::mem::take(first) {
                self.decide(slot);
            }
        }
    }

    /// Decides an object one of whose cells is in sight.
    pub(super) fn decide(&mut self, slot: Slot) {
        let object = self.scene.object(slot);
        if self.marks.decide(slot) && object.is_shown(self.view) && self.is_in_view(slot) {
            self.pvs.push(self.scene.id(slot));
        }
    }

    /// Adds an object to the set without a test.
    pub(super) fn add(&mut self, slot: Slot) {
        self.marks.decide(slot);
        self.pvs.push(self.scene.id(slot));
    }

    /// Compares the bounds of an object with the frustum.
    pub(super) fn is_in_view(&mut self, slot: Slot) -> bool {
        self.pvs.stats.objects_tested += 1;
        // An object whose place is not known may be anywhere.
        self.scene.is_unlocated(slot) || self.view.may_see(self.scene.object(slot).bounds())
    }

    /// Reveals a volume. Returns whether its object remains to be decided.
    pub(super) fn uncover(&mut self, slot: Slot) -> bool {
        let object = self.scene.object(slot);
        // An object of unknown place is always found, and is in its old volume no more for certain.
        if self.scene.is_unlocated(slot) || !self.marks.reveal(slot) || !object.is_shown(self.view) {
            return false;
        }
        self.pvs.stats.tbvs_revealed += 1;
        self.pvs.revealed.push(self.scene.id(slot));
        if object.on_expiry() {
            // Its bounds are old: it may be anywhere in the volume.
            self.add(slot);
            return false;
        }
        true
    }

    /// A volume came into sight at shell `m`: the cells of its object from
    /// there on decide. Nearer ones are hidden, or the surface around them would have
    /// been seen before.
    pub(super) fn reveal(&mut self, slot: Slot, m: i32) {
        if !self.uncover(slot) {
            return;
        }
        let bounds = self.scene.object(slot).bounds();
        if !self.view.may_see(bounds) {
            return;
        }
        let block = bounds.block();
        let (lo, hi) = self.scene.grid().cover(block.min, block.max);
        if volume(lo, hi) > MAX_PENDING {
            // Going through that many cells costs more than a test could save.
            self.decide(slot);
            return;
        }
        let cell = self.shells.cell;
        bounds.kind().rows(self.scene.grid(), Which::Touched, &mut |run| {
            run.cells().filter(|c| (*c - cell).abs().max_element() >= m).for_each(|c| self.pend(c, slot));
        });
    }

    /// Lists an object to be decided if a cell is in sight.
    pub(super) fn pend(&mut self, cell: IVec3, slot: Slot) {
        let shell = (cell - self.shells.cell).abs().max_element() as usize;
        if self.pending.len() <= shell {
            self.pending.resize_with(shell + 1, Vec::new);
        }
        self.pending[shell].push((cell, slot));
    }

    /// Decides the revealed objects with cells in the scale's shell.
    pub(super) fn settle_pending(&mut self, scale: &ShellScale, sides: &[ShellSide; 6]) {
        let m = scale.shell() as usize;
        let Some(list) = self.pending.get_mut(m) else { return };
        let mut list = std::mem::take(list);
        for (c, slot) in list.drain(..) {
            let relative = c - self.shells.cell;
            if !self.marks.is_decided(slot)
                && self.shells.frustum.meets(relative, relative)
                && !is_hidden(sides, relative, scale)
            {
                self.decide(slot);
            }
        }
        self.pending[m] = list;
    }

    /// Decides the objects and reveals the volumes in tiles in sight, cells of a side that have the
    /// coordinate `at` along its axis.
    pub(super) fn look_up(
        &mut self,
        hits: &mut Vec<Hit>,
        lists: &CellLists,
        side: &Side,
        at: i32,
        scale: &ShellScale,
        sides: &[ShellSide; 6],
    ) {
        let (scene, axes, m) = (self.scene, side.axes, scale.shell());
        for Hit { brick, tile, objects } in hits.drain(..) {
            if !objects {
                for slot in scene.tbv_matrix().ids(brick) {
                    let surface = |cells| TbvMatrix::surface_tile(cells, brick, &axes, at);
                    if !self.marks.is_revealed(slot)
                        && scene.volume_cells(slot).is_some_and(|cells| surface(cells) & tile != 0)
                    {
                        self.reveal(slot, m);
                    }
                }
                continue;
            }
            let mut corner = (brick << 3i32) - self.shells.cell;
            corner[axes.normal] = at - self.shells.cell[axes.normal];
            lists.for_tile(brick, &axes, at, tile, |bit, whole, own| {
                let decided = |&slot: &Slot| self.marks.is_decided(slot);
                if own.iter().all(decided) && whole.iter().all(decided) {
                    return;
                }
                let mut c = corner;
                c[axes.row] += bit >> 3;
                c[axes.col] += bit & 7;
                let on_edge = c[axes.row].abs() == m || c[axes.col].abs() == m;
                if !(on_edge && is_hidden(sides, c, scale)) {
                    whole.iter().chain(own).for_each(|&slot| self.decide(slot));
                }
            });
        }
    }
}
