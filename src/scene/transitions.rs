//! How objects come from one home to another, with the effects on matrices, lists and volumes: the
//! second table of [`crate::scene::home`].

use casca_slots::{Expiry, Slot};
use glam::IVec3;

use crate::grid::cell_box::{CellBox, volume};
use crate::grid::mask::BRICK;
use crate::numeric::scene::earliest_arrival;
use crate::object::{Bounds, Occluder};
use crate::scene::Scene;
use crate::scene::home::{Hidden, Validity};
use crate::scene::opaque::{add_cells, take_cells};
use crate::scene::solids::{add_static_solid, remove_static_solid};
use crate::scene::spatial_index::zone_for;
use crate::scene::static_solids::StaticSolids;
use crate::scene::volume::{MOST_CELLS, Tbv};

/// An object keeps a volume whose time was over if the room there is at least this share of the
/// distance that it goes while a new one would last.
const WORTH_KEEPING: f64 = 0.5;

impl Scene {
    /// An object is reported to be somewhere.
    pub(super) fn report(&mut self, slot: Slot, bounds: Bounds, occluder: Option<Occluder>) {
        self.note_report(slot);
        let object = &mut self.slots[slot];
        let same = object.bounds.same(&bounds) && same_occluder(object.occluder(), occluder.as_ref());
        if same && !object.is_expired() {
            return;
        }
        object.moved = self.changes.moved();
        let volume = object.volume().copied();
        self.note_static(slot);
        if let Some(hidden) = volume {
            self.exchange_shape(slot, bounds, occluder);
            self.hidden_moved(slot, hidden);
        } else {
            self.changes.changed();
            self.relist(slot, bounds, occluder);
        }
    }

    /// Notes when an object was reported, where that matters.
    pub(super) fn note_report(&mut self, slot: Slot) {
        let object = &self.slots[slot];
        if object.on_expiry() && self.clock.reports.report(slot) {
            // Its occluder counts again.
            if let Some(part) = object.opacity {
                self.opacity.part_mut(part).on_expiry.report();
            }
            self.changes.changed();
        }
    }

    /// Notes that an object is about to change, if it is static.
    pub(super) fn note_static(&mut self, slot: Slot) {
        let object = self.object(slot);
        if object.is_static() {
            let occluder = object.occluder().map(Occluder::block);
            self.changes.static_changed(slot, occluder);
        }
    }

    /// Puts an object on other layers, wherever it is. The cells of a listed occluder are kept by
    /// its layers.
    pub(super) fn change_layers(&mut self, slot: Slot, layers: u64) {
        let object = self.object(slot);
        if object.volume().is_some() || object.occluder().is_none() {
            self.slots[slot].layers = layers;
            self.index.boxes.put(slot, &self.slots[slot]);
            self.refresh_mover(slot);
            return;
        }
        self.unlist(slot);
        self.slots[slot].layers = layers;
        self.list(slot);
    }

    /// Writes an object that is in no matrix into I and O.
    pub(super) fn list(&mut self, slot: Slot) {
        let object = &mut self.slots[slot];
        object.set_volume(None);
        // A mesh finds its cells once for the bounds and the occluder.
        let _cells = object.occluder().and_then(|o| o.cache_cells(&self.grid));
        self.index.list(&self.grid, self.slots.id(slot), &mut self.slots[slot]);
        let object = &self.slots[slot];
        if object.on_expiry() {
            self.clock.reports.enter(slot);
        }
        if let Some(occluder) = object.occluder()
            && let Some(part) = self.opacity.join(object.layers)
        {
            let cells = self.opacity.part_mut(part);
            if object.is_static() {
                let (grid, objects, index) = (&self.grid, &self.slots, &self.index);
                add_static_solid(cells, occluder, &StaticSolids { grid, objects, index, part });
            } else {
                add_cells(&mut cells.moving, occluder, &self.grid);
            }
            if object.on_expiry() {
                cells.on_expiry.enter(self.clock.reports.is_current(slot));
            }
            self.slots[slot].opacity = Some(part);
        }
    }

    /// Erases a listed object from I and O.
    fn unlist(&mut self, slot: Slot) {
        self.clock.reports.leave(slot);
        let object = &mut self.slots[slot];
        let _cells = object.occluder().and_then(|o| o.cache_cells(&self.grid));
        self.index.unlist(&self.grid, slot, object);
        let Some(part) = object.opacity.take() else { return };
        let object = &self.slots[slot];
        let cells = self.opacity.part_mut(part);
        match object.occluder() {
            Some(occluder) if object.is_static() => {
                let (grid, objects, index) = (&self.grid, &self.slots, &self.index);
                remove_static_solid(cells, occluder, &StaticSolids { grid, objects, index, part });
            }
            Some(occluder) => take_cells(&mut cells.moving, occluder, &self.grid),
            None => {}
        }
        if object.on_expiry() {
            cells.on_expiry.leave(self.clock.reports.is_current(slot));
        }
        self.opacity.leave(part);
    }

    /// Moves a listed object. An occluder that stays in its bricks moves its opaque cells alone.
    fn relist(&mut self, slot: Slot, bounds: Bounds, occluder: Option<Occluder>) {
        let (grid, object, hides) = (&self.grid, &self.slots[slot], occluder.as_ref());
        // Another surface may find no numbers left, and then hides nothing.
        let stays =
            object.keeps_surface(hides) && self.index.stays_in_bricks(grid, object, &bounds, hides.is_some());
        if !stays {
            self.unlist(slot);
            self.exchange_shape(slot, bounds, occluder);
            return self.list(slot);
        }
        if let Some(part) = object.opacity {
            let cells = &mut self.opacity.part_mut(part).moving;
            if let Some(before) = object.occluder() {
                take_cells(cells, before, grid);
            }
            if let Some(after) = hides {
                add_cells(cells, after, grid);
            }
        }
        self.exchange_shape(slot, bounds, occluder);
        self.index.boxes.put(slot, &self.slots[slot]);
    }

    /// Brings the entry of an object in the list of its zone up to date with it.
    pub(super) fn refresh_mover(&mut self, slot: Slot) {
        if !self.index.refresh_mover(&self.grid, self.slots.id(slot), &self.slots[slot]) {
            self.unlist(slot);
            self.list(slot);
        }
    }

    /// Gives an object another occluder, in no matrix.
    pub(super) fn exchange_occluder(&mut self, slot: Slot, occluder: Option<Occluder>) {
        // Reports that pass over the matrices are for objects that hide nothing.
        if occluder.is_some() {
            self.index.rooms.close(slot);
        }
        let object = &mut self.slots[slot];
        if object.keeps_surface(occluder.as_ref()) {
            // A surface that only moves keeps the numbers of its patches.
            object.set_occluder(occluder);
            return;
        }
        if let Some(old) = object.occluder()
            && let Some(surface) = old.surface()
        {
            self.seams.remove(slot, surface, object.shares_positions(old));
        }
        object.set_occluder(occluder);
        if let Some(new) = object.occluder()
            && let Some(surface) = new.surface()
            && !self.seams.insert(slot, surface, object.shares_positions(new))
        {
            object.idle();
        }
    }

    /// Gives an object that is in no matrix another shape.
    fn exchange_shape(&mut self, slot: Slot, bounds: Bounds, occluder: Option<Occluder>) {
        self.exchange_occluder(slot, occluder);
        self.slots[slot].bounds = bounds;
    }

    /// An object in a volume was reported: where that serves it stays. Else it is listed, or, where
    /// reports are saved by it, gets a new volume at once.
    fn hidden_moved(&mut self, slot: Slot, hidden: Hidden) {
        let object = &mut self.slots[slot];
        let (block, expired, on_expiry) = (object.bounds.block(), object.is_expired(), object.on_expiry());
        let inside = hidden.tbv.contains(&self.grid, &block);
        if inside && !on_expiry {
            return;
        }
        let room = hidden.tbv.room(&block);
        if expired || !inside {
            object.adapt(Validity::outlived);
            self.changes.changed();
        }
        let wanted = self.distance(slot).min(MOST_CELLS * self.grid.cell_size());
        if inside && (!expired || room >= WORTH_KEEPING * wanted && !self.clock.is_resting(slot)) {
            let expires =
                earliest_arrival(self.clock.now, room, self.object(slot).promised_speed().unwrap_or(0.0));
            let mut again = Hidden { expires, ..hidden };
            if expired {
                self.index.always.remove(slot);
                self.changes.volume_is_new(slot, self.slots.len());
                let (since, made) = (self.clock.frame, self.clock.now);
                again = Hidden { queued: f64::INFINITY, since, made, ..again };
            }
            return self.hide(slot, again);
        }
        if !on_expiry {
            self.tire(slot);
        }
        self.remove_volume(slot);
        self.list(slot);
        if on_expiry && !self.clock.is_resting(slot) {
            // It would be due in each frame until its turn comes.
            self.try_hide(slot);
        }
    }

    /// The volume of an object is over. If it did not last, a small object gets none for some time:
    /// lists of zones cost less.
    fn tire(&mut self, slot: Slot) {
        let object = &self.slots[slot];
        if let Some(hidden) = object.volume()
            && self.clock.was_short(hidden, object.on_expiry())
            && zone_for(&self.grid, object, &object.bounds).is_some()
        {
            self.clock.rest(slot);
        }
    }

    /// An entry of the queue of expiries came up; whether a report of its object is due. After the
    /// clock went backwards, no volume is certain.
    pub(super) fn expire(&mut self, entry: Expiry, backwards: bool) -> bool {
        if self.slots.of_generation(entry.slot, entry.generation).is_none() {
            return false;
        }
        let object = &mut self.slots[entry.slot];
        let queued = object.volume().filter(|hidden| hidden.queued == entry.at);
        let Some(&hidden) = queued.filter(|_| object.is_hidden()) else {
            // It was queued again since, or is due already, or in no volume.
            return false;
        };
        if !backwards && hidden.expires > self.clock.now {
            object.set_volume(Some(Hidden { queued: hidden.expires, ..hidden }));
            self.clock.queue(self.slots.id(entry.slot), hidden.expires);
            return false;
        }
        object.expire();
        self.tire(entry.slot);
        self.index.always.insert(entry.slot);
        self.changes.changed();
        true
    }

    /// A view saw the volume of a hidden object.
    pub(super) fn reveal(&mut self, slot: Slot) {
        self.slots[slot].adapt(Validity::revealed);
        if self.object(slot).on_expiry() {
            self.tire(slot);
            // Its report is due, though it is in sight.
            self.clock.reports.forget(slot);
            self.last_frame.seen.remove(slot);
            self.changes.changed();
        }
        self.remove_volume(slot);
        self.list(slot);
    }

    /// No view saw a listed dynamic object: puts it into a volume, if one fits, and tells into how many
    /// bricks that reaches.
    pub(super) fn try_hide(&mut self, slot: Slot) -> Option<usize> {
        // A volume around an old place contains nothing for certain.
        if self.is_unlocated(slot) {
            return None;
        }
        let object = self.object(slot);
        let (block, speed) = (object.bounds.block(), object.promised_speed().unwrap_or(0.0));
        let extent = self.index.extent().map_or(IVec3::ZERO, |all| (all.hi - all.lo + 1) * BRICK);
        // What lasts until it expires, or was seen, is where the object may be: not in all its cells.
        let bounds = (&block, object.on_expiry() || object.validity().was_revealed());
        let distance = self.distance(slot);
        let viewers = &self.last_frame.viewers;
        let tbv = Tbv::around(&self.grid, extent, bounds, distance, viewers)?;
        self.unlist(slot);
        self.index.volumes.insert(&tbv.cells, slot);
        self.changes.changed();
        self.changes.volume_is_new(slot, self.slots.len());
        let expires = earliest_arrival(self.clock.now, tbv.room(&block), speed);
        let (since, made) = (self.clock.frame, self.clock.now);
        self.hide(slot, Hidden { tbv, expires, queued: f64::INFINITY, since, made });
        let CellBox { lo, hi } = tbv.cells.bricks();
        Some(volume(lo, hi) as usize)
    }

    /// How far an object is taken to go while its next volume lasts. Without a promise it crosses a
    /// cell in a second.
    fn distance(&self, slot: Slot) -> f64 {
        let object = self.object(slot);
        object.promised_speed().unwrap_or(self.grid.cell_size()) * object.validity().seconds()
    }

    /// Takes an object out of the scene.
    pub(super) fn take_out(&mut self, slot: Slot) {
        self.changes.changed();
        self.note_static(slot);
        if self.object(slot).volume().is_some() {
            self.remove_volume(slot);
        } else {
            self.unlist(slot);
        }
        self.exchange_occluder(slot, None);
        self.last_frame.seen.remove(slot);
        self.slots.remove(slot);
    }

    /// Takes an object out of its volume, if it is in one.
    pub(super) fn remove_volume(&mut self, slot: Slot) {
        if let Some(hidden) = self.slots[slot].volume() {
            self.index.volumes.remove(&hidden.tbv.cells, slot);
            self.index.rooms.close(slot);
            self.index.always.remove(slot);
        }
    }

    /// An object is in a volume from now on. Queues its expiry, unless an entry comes up in time.
    pub(super) fn hide(&mut self, slot: Slot, mut hidden: Hidden) {
        let (id, object) = (self.slots.id(slot), &mut self.slots[slot]);
        if object.on_expiry() && hidden.expires < hidden.queued {
            hidden.queued = hidden.expires;
            self.clock.queue(id, hidden.expires);
        }
        // Reports of other objects put off the expiry, too, and occluders go with the bounds.
        if !object.on_expiry() && object.given_occluder().is_none() {
            self.index.rooms.open(id, &hidden.tbv.block);
        }
        self.slots[slot].set_volume(Some(hidden));
    }
}

fn same_occluder(a: Option<&Occluder>, b: Option<&Occluder>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => a.same(b),
        (None, None) => true,
        _ => false,
    }
}

#[cfg(test)]
mod tests;
