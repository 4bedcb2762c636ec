//! The transitions of objects between their states, with their effects on matrices, lists and
//! volumes.
//!
//! Each function causes the events that the tables of [`crate::scene::state`] name for it.

use casca_slots::{AT_ONCE, Expiry, Slot};
use glam::IVec3;

use crate::grid::mask::BRICK;
use crate::numeric::scene::earliest_arrival;
use crate::object::{Bounds, Occluder};
use crate::scene::Scene;
use crate::scene::solids::{add_static_solid, remove_static_solid};
use crate::scene::spatial_index::{Span, zone_for};
use crate::scene::state::{Event, Hidden, State};
use crate::scene::static_solids::StaticSolids;
use crate::scene::validity::Validity;
use crate::scene::volume::Tbv;

/// An unlocated object keeps its old volume if the room there is at least this share of the slack
/// of a new one.
const WORTH_KEEPING: f64 = 0.5;

impl Scene {
    /// An object is reported to be somewhere.
    pub(super) fn report(&mut self, slot: Slot, bounds: Bounds, occluder: Option<Occluder>) {
        self.note_report(slot);
        self.locate(slot);
        let object = &mut self.slots[slot];
        let same = object.bounds.same(&bounds) && same_occluder(object.occluder(), occluder.as_ref());
        if same && !object.is_unlocated() || occluder.is_none() && self.stay_in_room(slot, &bounds) {
            return;
        }
        let object = &mut self.slots[slot];
        object.moved = self.changes.moved();
        let state = object.state();
        self.note_static(slot);
        match state {
            State::Listed | State::Overdue => {
                self.changes.changed();
                self.relist(slot, bounds, occluder);
            }
            State::Hidden(hidden) => {
                self.exchange_shape(slot, bounds, occluder);
                self.hidden_moved(slot, hidden);
            }
            State::Unlocated { volume } => {
                self.exchange_shape(slot, bounds, occluder);
                self.found_again(slot, volume);
            }
        }
    }

    /// Notes when an object was reported, where that matters.
    pub(super) fn note_report(&mut self, slot: Slot) {
        if self.object(slot).on_expiry() && self.clock.reports.report(slot) {
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
        let listed = matches!(object.state(), State::Listed | State::Overdue);
        if !listed || object.occluder().is_none() {
            self.slots[slot].layers = layers;
            self.index.boxes.put(slot, &self.slots[slot]);
            self.refresh_mover(slot);
            return;
        }
        self.locate(slot);
        self.unlist(slot);
        self.slots[slot].layers = layers;
        self.list(slot);
    }

    /// Writes an object that is in no matrix into I and O.
    pub(super) fn list(&mut self, slot: Slot) {
        let object = &mut self.slots[slot];
        object.apply(Event::Listed);
        // A mesh finds its cells once for the bounds and the occluder.
        let _cells = object.occluder().and_then(|o| o.cache_cells(&self.grid));
        self.index.list(&self.grid, self.slots.id(slot), &mut self.slots[slot]);
        let object = &self.slots[slot];
        let on_expiry = object.on_expiry();
        if object.in_zone {
            if on_expiry {
                self.clock.reports.enter_zone(slot);
            }
            return;
        }
        if let Some(occluder) = object.occluder()
            && let Some(part) = self.opacity.join(object.layers)
        {
            let cells = self.opacity.part_mut(part);
            if object.is_static() {
                let (grid, objects, index) = (&self.grid, &self.slots, &self.index);
                add_static_solid(cells, occluder, &StaticSolids { grid, objects, index, part });
            } else {
                cells.moving.add(occluder, &self.grid);
            }
            self.slots[slot].opacity = Some(part);
        }
        if on_expiry && !self.clock.reports.is_current(slot) {
            self.miss(slot);
        }
    }

    /// Erases a listed object from I and O.
    fn unlist(&mut self, slot: Slot) {
        self.clock.reports.leave_zone(slot);
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
            Some(occluder) => cells.moving.remove(occluder, &self.grid),
            None => {}
        }
        self.opacity.leave(part);
    }

    /// Moves a listed object: only the cells that change are touched, unless they are many.
    fn relist(&mut self, slot: Slot, bounds: Bounds, occluder: Option<Occluder>) {
        let (grid, object, hides) = (&self.grid, &self.slots[slot], occluder.as_ref());
        let by_zones = hides.is_none() && object.in_zone && zone_for(grid, object, &bounds).is_some();
        if !by_zones {
            // Another surface may find no numbers left, and then hides nothing.
            if !object.keeps_surface(hides) || !self.index.move_cells(grid, (slot, object), &bounds, hides) {
                self.unlist(slot);
                self.exchange_shape(slot, bounds, occluder);
                return self.list(slot);
            }
            if let Some(part) = object.opacity {
                self.opacity.move_occluder(grid, part, object.occluder(), hides);
            }
        }
        self.exchange_shape(slot, bounds, occluder);
        self.index.boxes.put(slot, &self.slots[slot]);
        if by_zones {
            self.refresh_mover(slot);
        }
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

    /// A hidden object was reported elsewhere: inside its volume it stays.
    fn hidden_moved(&mut self, slot: Slot, hidden: Hidden) {
        let object = &mut self.slots[slot];
        let block = object.bounds.block();
        if hidden.tbv.contains(&self.grid, &block) {
            if object.on_expiry() {
                let room = hidden.tbv.room(&block);
                self.enclose_again(slot, hidden, room);
            }
            return;
        }
        object.adapt(Validity::outlived);
        let (bounds, on_expiry) = (object.bounds.clone(), object.on_expiry());
        self.remove_volume(slot);
        self.changes.changed();
        // Lists of zones cost less than a volume that does not last.
        if !on_expiry
            && self.clock.was_short(&hidden, false)
            && zone_for(&self.grid, self.object(slot), &bounds).is_some()
        {
            self.clock.rest(slot);
            return self.list(slot);
        }
        let volume = self.make_volume(slot);
        self.enclose_or_list(slot, volume);
    }

    /// An unlocated object was reported. Where a new volume would not last much longer, the old one
    /// stays.
    fn found_again(&mut self, slot: Slot, volume: Option<Tbv>) {
        self.index.always.remove(slot);
        self.changes.changed();
        let object = &mut self.slots[slot];
        object.adapt(Validity::outlived);
        let block = object.bounds.block();
        if volume.is_none() {
            // A view saw its last volume. The next one tells whether it sees the object; a new
            // volume would only be seen again.
            return self.list(slot);
        }
        if self.clock.resting.contains(slot) && zone_for(&self.grid, object, &object.bounds).is_some() {
            // Reports in each frame cost less than a volume that does not last.
            self.remove_volume(slot);
            return self.list(slot);
        }
        let next = self.make_volume(slot);
        if let (Some(old), Some(new)) = (volume, &next) {
            let room = old.room(&block);
            if room >= WORTH_KEEPING * new.tbv.slack {
                self.changes.volume_is_new(slot, self.slots.len());
                self.enclose_again(slot, Hidden { tbv: old, queued: f64::INFINITY, ..*new }, room);
                return;
            }
        }
        self.remove_volume(slot);
        self.enclose_or_list(slot, next);
    }

    /// The place of an object that is listed in no zone is not known any more: until it is reported
    /// it counts as visible and hides nothing. Its cells stay, since its report mostly comes at
    /// once.
    pub(super) fn miss(&mut self, slot: Slot) {
        let object = &mut self.slots[slot];
        if object.apply(Event::Missed) {
            self.opacity.miss(object.opacity);
            self.index.always.insert(slot);
            self.changes.changed();
        }
    }

    /// The place of an object is known again, or does not matter any more.
    pub(super) fn locate(&mut self, slot: Slot) {
        let object = &mut self.slots[slot];
        if object.is_overdue() && object.apply(Event::Reported) {
            self.opacity.locate(object.opacity);
            if Span::of(&self.grid, &object.bounds.block()).suffices() {
                self.index.always.remove(slot);
            }
            self.changes.changed();
        }
    }

    /// The volume of an object that is reported on expiry is over. If it did not last, a small
    /// object gets none for some time.
    fn tire(&mut self, slot: Slot) {
        let object = &self.slots[slot];
        if let State::Hidden(hidden) = object.state()
            && object.on_expiry()
            && self.clock.was_short(&hidden, true)
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
        match object.state() {
            // Queued again since: that entry counts.
            State::Hidden(hidden) if hidden.queued != entry.at => false,
            State::Hidden(Hidden { expires, .. }) if !backwards && expires > self.clock.now => {
                object.apply(Event::Requeued(expires));
                self.clock.queue(self.slots.id(entry.slot), expires);
                false
            }
            State::Hidden(_) => {
                self.tire(entry.slot);
                let object = &mut self.slots[entry.slot];
                object.apply(Event::Expired);
                self.index.always.insert(entry.slot);
                self.changes.changed();
                true
            }
            // Revealed in the last frame: its bounds are old.
            State::Unlocated { .. } => entry.at == AT_ONCE,
            State::Listed | State::Overdue => false,
        }
    }

    /// A view saw the volume of a hidden object; `seen` says whether the object is in a set.
    pub(super) fn reveal(&mut self, slot: Slot, seen: bool) {
        self.tire(slot);
        self.remove_volume(slot);
        let (id, object) = (self.slots.id(slot), &mut self.slots[slot]);
        object.adapt(Validity::revealed);
        if object.on_expiry() {
            object.apply(Event::Revealed);
            self.index.always.insert(slot);
            self.changes.changed();
            self.clock.queue(id, AT_ONCE);
        } else if seen {
            self.list(slot);
        } else {
            let volume = self.make_volume(slot);
            self.enclose_or_list(slot, volume);
        }
    }

    /// No view saw a listed dynamic object: puts it into a volume, if one fits.
    pub(super) fn try_hide(&mut self, slot: Slot) -> bool {
        // A volume around an old place contains nothing for certain.
        if self.is_unlocated(slot) {
            return false;
        }
        let Some(hidden) = self.make_volume(slot) else { return false };
        self.unlist(slot);
        self.enclose(slot, hidden);
        true
    }

    /// Takes an object out of the scene.
    pub(super) fn take_out(&mut self, slot: Slot) {
        self.changes.changed();
        self.note_static(slot);
        self.locate(slot);
        match self.object(slot).state() {
            State::Listed | State::Overdue => self.unlist(slot),
            State::Hidden(_) => self.remove_volume(slot),
            State::Unlocated { .. } => {
                self.index.always.remove(slot);
                self.remove_volume(slot);
            }
        }
        self.exchange_occluder(slot, None);
        self.last_frame.seen.remove(slot);
        self.slots.remove(slot);
    }

    /// Takes an object out of its volume, if it is in one.
    pub(super) fn remove_volume(&mut self, slot: Slot) {
        if let Some(tbv) = self.slots[slot].volume() {
            self.index.volumes.remove(&tbv.cells, slot);
            self.index.rooms.close(slot);
        }
    }

    /// A volume around the place of an object, if one fits. It is not in the matrices yet, nor in
    /// the queue.
    fn make_volume(&self, slot: Slot) -> Option<Hidden> {
        let object = self.object(slot);
        let (speed, block) = (object.promised_speed(), object.bounds.block());
        // Without a promise it is taken to cross a cell in a second.
        let distance = speed.unwrap_or(self.grid.cell_size()) * object.validity().seconds();
        let extent = self.index.extent().map_or(IVec3::ZERO, |all| (all.hi - all.lo + 1) * BRICK);
        // What lasts until it expires, or was seen, is where the object may be: not in all its cells.
        let bounds = (&block, object.on_expiry() || object.validity().was_revealed());
        let tbv = Tbv::around(&self.grid, extent, bounds, distance, &self.last_frame.viewers)?;
        let expires = earliest_arrival(self.clock.now, tbv.room(&block), speed.unwrap_or(0.0));
        let (since, made) = (self.clock.frame, self.clock.now);
        Some(Hidden { tbv, expires, queued: f64::INFINITY, since, made })
    }

    /// Puts an object that is in no matrix into a volume, or into I and O.
    fn enclose_or_list(&mut self, slot: Slot, volume: Option<Hidden>) {
        match volume {
            Some(hidden) => self.enclose(slot, hidden),
            None => self.list(slot),
        }
    }

    /// Puts an object that is in no matrix into a new volume.
    fn enclose(&mut self, slot: Slot, hidden: Hidden) {
        self.index.volumes.insert(&hidden.tbv.cells, slot);
        self.changes.changed();
        self.changes.volume_is_new(slot, self.slots.len());
        self.hide(slot, hidden);
    }

    /// Leaves an object in the volume that it has, `room` away from its walls. If it has no entry
    /// in the queue, `queued` is infinite.
    fn enclose_again(&mut self, slot: Slot, hidden: Hidden, room: f64) {
        let speed = self.object(slot).promised_speed().unwrap_or(0.0);
        self.hide(slot, Hidden { expires: earliest_arrival(self.clock.now, room, speed), ..hidden });
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
        self.slots[slot].apply(Event::Enclosed(hidden));
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
