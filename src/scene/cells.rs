//! Objects in the matrices I and O: their cells, written, erased and moved.

use casca_slots::Slot;
use glam::IVec3;

use crate::geometry::Block;
use crate::grid::Grid;
use crate::grid::bricks::BRICK;
use crate::grid::cell_box::{CellBox, volume};
use crate::matrix::bits::NONE;
use crate::object::{Bounds, Occluder};
use crate::scene::Scene;
use crate::scene::movers::Movers;
use crate::scene::state::Event;
use crate::shape::pieces::touched;

/// An object whose bounds span more cells than this is not written into I, which would take a
/// brick for every 512 of them: it is tested against the frustum in every query.
const MOST_SPANNED: u64 = 1 << 22;

/// How the cells of a box stand for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Span {
    /// The cells, also those beyond the grid.
    cells: CellBox,
    /// Whether all of them lie in the grid.
    inside: bool,
    /// Whether one of them does.
    enters: bool,
    /// Whether those in the grid are few enough to be written into I.
    few: bool,
}

impl Span {
    pub(super) fn of(grid: &Grid, block: &Block) -> Self {
        let (lo, hi) = grid.cover(block.min, block.max);
        let inside = grid.contains(lo) && grid.contains(hi);
        let clipped = grid.clip(lo, hi);
        let few = clipped.is_none_or(|(lo, hi)| volume(lo, hi) <= MOST_SPANNED);
        Self { cells: CellBox { lo, hi }, inside, enters: clipped.is_some(), few }
    }

    /// Whether the walk over the cells finds the object wherever it can be seen, or the boxes
    /// around what reaches beyond the grid do.
    pub(super) fn suffices(self) -> bool {
        self.enters && self.few
    }

    /// Whether it is in cells and reaches beyond the grid.
    pub(super) fn overhangs(self) -> bool {
        self.suffices() && !self.inside
    }
}

/// Whether two shapes surely touch the same bricks, inside the grid and none of them wholly.
fn touch_same_bricks(grid: &Grid, old: &Bounds, new: &Bounds) -> bool {
    // A mesh may be in several pieces, none of them in a brick between two others.
    if [old, new].iter().any(|bounds| matches!(bounds, Bounds::Mesh(_))) {
        return false;
    }
    let cover = |shape: &Bounds| {
        let block = shape.block();
        grid.cover(block.min, block.max)
    };
    let ((lo, hi), (old_lo, old_hi)) = (cover(new), cover(old));
    let same = lo >> 3i32 == old_lo >> 3i32 && hi >> 3i32 == old_hi >> 3i32;
    // A connected shape touches all bricks of its box if those are a row.
    let rows = (hi >> 3i32).cmpgt(lo >> 3i32).bitmask().count_ones() <= 1;
    let whole = |lo: IVec3, hi: IVec3| (hi - lo).min_element() >= BRICK - 1;
    let inside = [lo, hi, old_lo, old_hi].into_iter().all(|cell| grid.contains(cell));
    same && rows && inside && !whole(lo, hi) && !whole(old_lo, old_hi)
}

impl Scene {
    /// Writes an object that is in no matrix into I and O.
    pub(super) fn list(&mut self, slot: Slot) {
        self.boxes.put(slot, &self.slots[slot]);
        if let Some(zone) = self.zone_to_list(slot, &self.object(slot).bounds) {
            self.list_in_zone(slot, zone);
            return;
        }
        let grid = self.grid;
        let object = &mut self.slots[slot];
        object.apply(Event::Listed);
        let block = object.bounds.block();
        let span = Span::of(&grid, &block);
        object.in_cells = span.few;
        let (bounds, occluder) = (object.bounds.clone(), object.occluder().cloned());
        let (dynamic, on_expiry) = (!object.is_static(), object.on_expiry());
        let part = occluder.as_ref().and_then(|_| self.opacity.join(object.layers));
        object.opacity = part;
        // A mesh finds its cells once for the bounds and the occluder.
        let _cells = occluder.as_ref().and_then(|o| o.cache_cells(&grid));
        if span.few {
            touched(&bounds, &grid, &mut |p| p.bricks(|b, m| self.ids.change(b, &NONE, m, slot)));
        }
        if !span.suffices() {
            self.members.always.insert(slot);
        }
        if span.overhangs() {
            self.members.overhang.insert(&block, &span.cells, slot);
        }
        if dynamic {
            self.members.movers.insert(slot);
        }
        if on_expiry {
            self.members.on_expiry.insert(slot);
        }
        match occluder.zip(part) {
            Some((occluder, part)) if dynamic => self.opacity.part_mut(part).moving.add(&occluder, &grid),
            Some((occluder, part)) => self.add_static_solid(slot, part, &occluder),
            None => {}
        }
        if on_expiry && !self.reports.is_current(slot) {
            self.miss(slot);
        }
    }

    /// The zone to list an object in instead of cells, if it may be: it moves, is small and hides
    /// nothing.
    pub(super) fn zone_to_list(&self, slot: Slot, bounds: &Bounds) -> Option<IVec3> {
        let object = self.object(slot);
        let may = !object.is_static() && object.given_occluder().is_none();
        if may { Movers::zone_of(&self.grid, &bounds.block()) } else { None }
    }

    /// Lists an object that is in no matrix in a zone.
    fn list_in_zone(&mut self, slot: Slot, zone: IVec3) {
        let object = &mut self.slots[slot];
        object.apply(Event::Listed);
        (object.in_cells, object.in_zone) = (true, true);
        if object.on_expiry() {
            self.reports.enter_zone(slot);
        }
        self.members.movers.insert(slot);
        self.enter_zone(slot, zone);
    }

    /// Writes an object into the list of a zone, out of any other.
    fn enter_zone(&mut self, slot: Slot, zone: IVec3) {
        let (object, id) = (&self.slots[slot], self.slots.id(slot));
        let aabb = object.bounds.aabb();
        let room = self.movers.insert(&self.grid, (id, zone), object.is_plain());
        self.boxes.put_mover(slot, aabb.min.into(), aabb.max.into());
        self.rooms.open(id, &room);
    }

    /// Brings the entry of an object in the list of its zone up to date with it.
    pub(super) fn refresh_mover(&mut self, slot: Slot) {
        let object = self.object(slot);
        if !object.in_zone {
            return;
        }
        // Its bounds may have become those of a larger object, in the same room.
        let block = object.bounds.block();
        match Movers::zone_of(&self.grid, &block) {
            Some(zone) => self.enter_zone(slot, zone),
            None => {
                self.unlist(slot);
                self.list(slot);
            }
        }
    }

    /// Whether a listed object that is in a zone may be in one with other bounds, too.
    fn stays_in_zones(&mut self, slot: Slot, bounds: &Bounds) -> bool {
        self.object(slot).in_zone && self.zone_to_list(slot, bounds).is_some()
    }

    /// Takes an object out of its zone.
    fn leave_zone(&mut self, slot: Slot) {
        self.rooms.close(slot);
        self.movers.remove(slot);
        self.reports.leave_zone(slot);
    }

    /// Erases a listed object from I and O.
    pub(super) fn unlist(&mut self, slot: Slot) {
        if std::mem::take(&mut self.slots[slot].in_zone) {
            self.leave_zone(slot);
            self.slots[slot].in_cells = false;
        }
        let grid = self.grid;
        let object = &mut self.slots[slot];
        let in_cells = std::mem::take(&mut object.in_cells);
        let (bounds, occluder) = (object.bounds.clone(), object.occluder().cloned());
        let dynamic = !object.is_static();
        let part = object.opacity.take();
        let _cells = occluder.as_ref().and_then(|o| o.cache_cells(&grid));
        if in_cells {
            touched(&bounds, &grid, &mut |p| p.bricks(|b, m| self.ids.change(b, m, &NONE, slot)));
        }
        self.members.always.remove(slot);
        let span = Span::of(&grid, &bounds.block());
        if span.overhangs() {
            self.members.overhang.remove(&span.cells, slot);
        }
        self.members.movers.remove(slot);
        self.members.on_expiry.remove(slot);
        match occluder.zip(part) {
            Some((occluder, part)) if dynamic => self.opacity.part_mut(part).moving.remove(&occluder, &grid),
            Some((occluder, part)) => self.remove_static_solid(slot, part, &occluder),
            None => {}
        }
        part.into_iter().for_each(|part| self.opacity.leave(part));
    }

    /// Moves a listed object: only the cells that change are touched, unless they are many.
    pub(super) fn relist(&mut self, slot: Slot, bounds: Bounds, occluder: Option<Occluder>) {
        let by_zones = occluder.is_none() && self.stays_in_zones(slot, &bounds);
        if !by_zones && !self.move_cells(slot, &bounds, occluder.as_ref()) {
            self.unlist(slot);
            self.exchange_occluder(slot, occluder);
            self.slots[slot].bounds = bounds;
            self.list(slot);
            return;
        }
        self.slots[slot].bounds = bounds;
        self.exchange_occluder(slot, occluder);
        self.boxes.put(slot, &self.slots[slot]);
        if by_zones {
            self.refresh_mover(slot);
        }
    }

    /// Moves the cells of a small dynamic object in the matrices; false, without a change, for
    /// others.
    fn move_cells(&mut self, slot: Slot, bounds: &Bounds, occluder: Option<&Occluder>) -> bool {
        let grid = self.grid;
        let object = &self.slots[slot];
        let in_cells = object.in_cells && !self.members.always.contains(slot);
        let hides = object.occluder().is_some() || occluder.is_some();
        // From now on it is listed in other ways.
        if object.in_zone || !hides && self.zone_to_list(slot, bounds).is_some() {
            return false;
        }
        if in_cells && !hides && touch_same_bricks(&grid, &object.bounds, bounds) {
            return true;
        }
        let (before, after) = (Span::of(&grid, &object.bounds.block()), Span::of(&grid, &bounds.block()));
        // An occluder that comes or goes joins or leaves its part of the opacity.
        let same_part = object.occluder().is_some() == occluder.is_some();
        let simple = !object.is_static() && in_cells && same_part && after.suffices();
        let mut moved = std::mem::take(&mut self.moved);
        let done = simple && moved.touched(&object.bounds, bounds, &grid);
        if done {
            if before.overhangs() {
                self.members.overhang.remove(&before.cells, slot);
            }
            if after.overhangs() {
                self.members.overhang.insert(&bounds.block(), &after.cells, slot);
            }
            moved.iter().for_each(|(brick, old, new)| self.ids.change(brick, old, new, slot));
            let object = &self.slots[slot];
            if let Some(part) = object.opacity {
                let (before, opacity) = (object.occluder(), self.opacity.part_mut(part));
                if moved.opaque(before, occluder, &grid) {
                    moved.iter().for_each(|(brick, old, new)| opacity.moving.exchange(brick, old, new));
                } else {
                    before.into_iter().for_each(|o| opacity.moving.remove(o, &grid));
                    occluder.into_iter().for_each(|o| opacity.moving.add(o, &grid));
                }
            }
        }
        self.moved = moved;
        done
    }

    /// Gives an object another occluder, in no matrix.
    pub(super) fn exchange_occluder(&mut self, slot: Slot, occluder: Option<Occluder>) {
        // Reports that pass over the matrices are for objects that hide nothing.
        if occluder.is_some() {
            self.rooms.close(slot);
        }
        let object = &mut self.slots[slot];
        let is_static = object.is_static();
        // Only triangles that are drawn where they are share positions with others.
        let fixed = |o: &Occluder| is_static && o.placement().is_none();
        let drawn =
            |o: Option<&Occluder>| o.and_then(|o| o.surface().map(|s| (std::ptr::from_ref(s), fixed(o))));
        if drawn(object.occluder()) == drawn(occluder.as_ref()) {
            // A surface that only moves keeps the numbers of its patches.
            object.set_occluder(occluder);
            return;
        }
        if let Some(old) = object.occluder()
            && let Some(surface) = old.surface()
        {
            self.seams.remove(slot, surface, fixed(old));
        }
        object.set_occluder(occluder);
        if let Some(new) = object.occluder()
            && let Some(surface) = new.surface()
            && !self.seams.insert(slot, surface, fixed(new))
        {
            object.idle();
        }
    }
}
