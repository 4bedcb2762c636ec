//! The changes of state of dynamic objects: see the tables of [`crate::scene::state`].

use casca_slots::{AT_ONCE, Expiry, Slot};
use glam::{DVec2, IVec2};

use crate::error::Error;
use crate::geometry::{Disc, Shape};
use crate::id::ObjectId;
use crate::numeric::earliest_arrival;
use crate::scene::Scene;
use crate::scene::state::{Hidden, State};
use crate::volume::{Tbv, Validity};

impl Scene {
    /// The cells of the outline of the temporal bounding volume that stands for an object, those
    /// beyond the grid included; none if it is not in a volume.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn volume_outline(&self, id: ObjectId) -> Result<Vec<IVec2>, Error> {
        let hidden = self.find(id)?.hidden();
        Ok(hidden.map_or(Vec::new(), |hidden| hidden.tbv.outline().collect()))
    }

    /// For how many seconds the next temporal bounding volume of an object is made to last: longer
    /// after volumes that no view saw, shorter after ones that a view saw. `None` for fixed
    /// objects.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn validity(&self, id: ObjectId) -> Result<Option<f64>, Error> {
        Ok(self.find(id)?.mover.as_ref().map(|mover| mover.validity.seconds()))
    }

    /// Enters the place of an object that a call reported.
    pub(super) fn report(&mut self, slot: Slot, bounds: Shape, occluder: Option<Shape>) {
        let now = self.now;
        let Some(object) = self.slots.get_mut(slot) else { return };
        let state = object.mover.as_mut().map(|mover| {
            mover.reported = now;
            mover.state.clone()
        });
        match state {
            None | Some(State::Listed | State::Overdue) => {
                self.unlist(slot);
                self.exchange(slot, bounds, occluder);
                self.list(slot);
            }
            Some(State::Hidden(hidden)) => {
                self.exchange(slot, bounds, occluder);
                self.hidden_moved(slot, hidden);
            }
            Some(State::Lost) => {
                self.lost.remove(slot);
                self.exchange(slot, bounds, occluder);
                self.enclose_or_list(slot);
            }
        }
    }

    /// Gives an object that is in no matrix other shapes.
    fn exchange(&mut self, slot: Slot, bounds: Shape, occluder: Option<Shape>) {
        if let Some(object) = self.slots.get_mut(slot) {
            (object.bounds, object.occluder) = (bounds, occluder);
        }
    }

    /// A hidden object was reported elsewhere: inside its volume it stays.
    fn hidden_moved(&mut self, slot: Slot, hidden: Hidden) {
        let Some(object) = self.slots.get(slot) else { return };
        // Outlines have no cells beyond the border of the grid: an object that leaves the grid
        // leaves its volume.
        let (inside, in_grid) =
            (hidden.tbv.room(&self.grid, &object.bounds), self.room_in_grid(&object.bounds));
        let room = inside.min(in_grid);
        if inside >= 0.0 && in_grid > 0.0 {
            if object.on_expiry() {
                let expires = earliest_arrival(self.now, room, object.promised_speed().unwrap_or(0.0));
                self.hide(slot, Hidden { expires, ..hidden });
            }
            return;
        }
        self.adapt(slot, |validity| validity.outlived(hidden.lasts));
        self.volumes.remove(slot, &hidden.tbv);
        self.enclose_or_list(slot);
    }

    /// How far a shape is from the border of the grid; negative outside.
    fn room_in_grid(&self, shape: &Shape) -> f64 {
        let block = shape.block();
        (block.min - self.grid.min()).min(self.grid.max() - block.max).min_element()
    }

    /// The place of a listed object is no longer known: until it is reported it counts as visible
    /// and hides nothing.
    pub(super) fn miss(&mut self, slot: Slot) {
        self.unfill(slot);
        self.set_state(slot, State::Overdue);
        self.lost.insert(slot);
    }

    /// An entry of the queue of expiries came up; whether a report of its object is due. After the
    /// clock went backwards, no volume is certain.
    pub(super) fn expire(&mut self, entry: Expiry, backwards: bool) -> bool {
        let Expiry { slot, generation, at } = entry;
        let object = self.slots.of_generation(slot, generation);
        let state = object.and_then(|object| object.mover.as_ref()).map(|mover| mover.state.clone());
        match state {
            // Queued again since: that entry counts.
            Some(State::Hidden(hidden)) if hidden.queued != at => false,
            Some(State::Hidden(hidden)) if !backwards && hidden.expires > self.now => {
                self.hide(slot, Hidden { queued: f64::INFINITY, ..hidden });
                false
            }
            Some(State::Hidden(hidden)) => {
                self.adapt(slot, |validity| validity.outlived(hidden.lasts));
                self.lose(slot, &hidden.tbv);
                true
            }
            // Seen in the last frame: its bounds are old.
            Some(State::Lost) => at == AT_ONCE,
            _ => false,
        }
    }

    /// A view saw the volume of a hidden object; `seen` says whether the object is in a set.
    pub(super) fn reveal(&mut self, slot: Slot, seen: bool) {
        let Some(hidden) = self.slots.get(slot).and_then(|object| object.hidden().cloned()) else { return };
        self.adapt(slot, Validity::revealed);
        if self.slots.get(slot).is_some_and(|object| object.on_expiry()) {
            self.lose(slot, &hidden.tbv);
            let generation = self.slots.id(slot).generation();
            self.expiries.push(Expiry { at: AT_ONCE, slot, generation });
            return;
        }
        self.volumes.remove(slot, &hidden.tbv);
        if seen {
            self.list(slot);
        } else {
            self.enclose_or_list(slot);
        }
    }

    /// No view saw a listed dynamic object: puts it into a volume, if one fits.
    pub(super) fn try_hide(&mut self, slot: Slot) -> bool {
        let listed = self.slots.get(slot).and_then(|object| object.mover.as_ref());
        if !listed.is_some_and(|mover| matches!(mover.state, State::Listed)) {
            return false;
        }
        let Some(hidden) = self.make_volume(slot) else { return false };
        self.unlist(slot);
        self.enclose(slot, hidden);
        true
    }

    /// Takes an object of any state out of all matrices.
    pub(super) fn take_out(&mut self, slot: Slot) {
        let state =
            self.slots.get(slot).and_then(|object| object.mover.as_ref()).map(|mover| mover.state.clone());
        match state {
            None | Some(State::Listed | State::Overdue) => self.unlist(slot),
            Some(State::Hidden(hidden)) => self.volumes.remove(slot, &hidden.tbv),
            Some(State::Lost) => _ = self.lost.remove(slot),
        }
    }

    /// A volume around the place of an object, if one fits. It is in no matrix yet.
    fn make_volume(&self, slot: Slot) -> Option<Hidden> {
        let object = self.slots.get(slot)?;
        if self.is_outer(&object.bounds) {
            return None;
        }
        let speed = object.promised_speed();
        // Without a promise it is taken to cross a cell in a second.
        let seconds = object.mover.as_ref()?.validity.seconds();
        let pace = speed.unwrap_or(self.grid.cell_size());
        let on_expiry = object.on_expiry();
        let tbv = Tbv::around(&self.grid, &object.bounds, pace * seconds, &self.viewers, on_expiry)?;
        let room = tbv.room(&self.grid, &object.bounds);
        let expires = earliest_arrival(self.now, room, speed.unwrap_or(0.0));
        let region = on_expiry.then(|| disc_around(tbv.disc(&self.grid)));
        // An object that promised to stay outlives any volume.
        let lasts = if pace > 0.0 { room / pace } else { f64::INFINITY };
        Some(Hidden { tbv, lasts, expires, queued: f64::INFINITY, region })
    }

    /// Puts an object that is in no matrix into a volume, or into I and O.
    fn enclose_or_list(&mut self, slot: Slot) {
        match self.make_volume(slot) {
            Some(hidden) => self.enclose(slot, hidden),
            None => self.list(slot),
        }
    }

    /// Puts an object that is in no matrix into a new volume.
    fn enclose(&mut self, slot: Slot, hidden: Hidden) {
        self.volumes.insert(slot, &hidden.tbv);
        self.drawn += 1;
        self.hide(slot, hidden);
    }

    /// An object is in a volume from now on. Queues its expiry, unless an entry comes up in time.
    fn hide(&mut self, slot: Slot, mut hidden: Hidden) {
        let generation = self.slots.id(slot).generation();
        if hidden.region.is_some() && hidden.expires < hidden.queued {
            hidden.queued = hidden.expires;
            self.expiries.push(Expiry { at: hidden.expires, slot, generation });
        }
        self.set_state(slot, State::Hidden(hidden));
    }

    /// The volume of an object that goes unreported does not hold it for certain any more.
    fn lose(&mut self, slot: Slot, tbv: &Tbv) {
        self.volumes.remove(slot, tbv);
        self.set_state(slot, State::Lost);
        self.lost.insert(slot);
    }

    fn adapt(&mut self, slot: Slot, change: impl FnOnce(&mut Validity)) {
        if let Some(mover) = self.slots.get_mut(slot).and_then(|object| object.mover.as_mut()) {
            change(&mut mover.validity);
        }
    }

    pub(super) fn set_state(&mut self, slot: Slot, state: State) {
        if let Some(mover) = self.slots.get_mut(slot).and_then(|object| object.mover.as_mut()) {
            mover.state = state;
        }
    }

    /// Drops entries of the queue that were replaced since, once there are many of them.
    pub(super) fn compact_expiries(&mut self) {
        if !self.expiries.is_crowded(self.slots.len()) {
            return;
        }
        let slots = &self.slots;
        self.expiries.retain(|entry| {
            let object = slots.of_generation(entry.slot, entry.generation);
            match object.and_then(|object| object.mover.as_ref()).map(|mover| &mover.state) {
                Some(State::Hidden(hidden)) => hidden.queued == entry.at,
                Some(State::Lost) => entry.at == AT_ONCE,
                _ => false,
            }
        });
    }
}

/// A disc in single precision around one in double precision.
fn disc_around((center, radius): (DVec2, f64)) -> Shape {
    let near = center.as_vec2();
    let radius = (radius + center.distance(near.as_dvec2())) as f32;
    Disc::new(near, radius.next_up().next_up()).into()
}
