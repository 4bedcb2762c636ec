//! The frame loop: the clock and the results of a frame's queries.

use casca_slots::Slot;

use crate::error::Error;
use crate::id::ObjectId;
use crate::pvs::Pvs;
use crate::scene::Scene;
use crate::scene::state::State;

/// The changes that [`Scene::end_frame`] made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct FrameReport {
    /// Objects found hidden and put into a temporal bounding volume.
    pub hidden: usize,
    /// Volumes that a view saw.
    pub revealed: usize,
    /// Volumes that were drawn since the last frame ended: also those of objects that left their
    /// volume, and of objects that were reported when their volume had expired.
    pub drawn: usize,
}

/// The slots of the objects in sight, a bit for each.
struct Seen(Vec<u64>);

impl Seen {
    fn contains(&self, slot: Slot) -> bool {
        self.0[slot.index() / 64] >> (slot.index() % 64) & 1 != 0
    }
}

impl Scene {
    /// Sets the clock, in seconds, and gives the objects that are due for a report. Of those
    /// [reported on expiry](crate::Reports::OnExpiry), these are the ones whose volume may no
    /// longer contain them, and the ones in no volume, unless the last frame ended with them in
    /// sight: those are reported unasked. Until each is [updated](Scene::update), every query
    /// counts it as visible, and it hides nothing.
    ///
    /// A clock that goes backwards makes all in volumes due. Costs the objects that are due and, if
    /// any object that is reported on expiry is in no volume, a look at each dynamic one that is in
    /// none.
    ///
    /// # Errors
    /// Refuses a time that is not finite; then nothing changes.
    pub fn begin_frame(&mut self, now: f64) -> Result<Vec<ObjectId>, Error> {
        if !now.is_finite() {
            return Err(Error::NotFinite { what: "the time", value: now });
        }
        let backwards = now < self.now;
        self.now = now;
        let mut due = Vec::new();
        let until = if backwards { f64::INFINITY } else { now };
        let entries: Vec<_> = std::iter::from_fn(|| self.expiries.pop_until(until)).collect();
        for entry in entries {
            if self.expire(entry, backwards) {
                due.push(self.id(entry.slot));
            }
        }
        self.miss_unreported(&mut due);
        due.sort_unstable_by_key(|id| id.slot());
        due.dedup();
        self.revision += u64::from(!due.is_empty());
        Ok(due)
    }

    /// Listed objects that are reported on expiry were surely there only when they were last
    /// reported.
    fn miss_unreported(&mut self, due: &mut Vec<ObjectId>) {
        let frame = self.frame;
        self.frame += 1;
        let asked = if self.listed_on_expiry > 0 { self.listed.as_slice().len() } else { 0 };
        for i in 0..asked {
            let slot = self.listed.as_slice()[i];
            let Some(object) = self.slots.get(slot).filter(|object| object.on_expiry()) else { continue };
            let Some(mover) = object.mover.as_ref().filter(|mover| mover.reported != self.now) else {
                continue;
            };
            // An object that the last frame showed is reported unasked.
            if mover.seen_in != frame {
                due.push(self.id(slot));
            }
            if matches!(mover.state, State::Listed) {
                self.revision += 1;
                self.miss(slot);
            }
        }
    }

    /// Applies the results of a frame's queries: dynamic objects that no view saw go into temporal
    /// bounding volumes, those whose volume a view saw come out. Without results nothing changes;
    /// those of queries that never ran are passed over. A frame that ends without a call costs
    /// reports and time, but loses nobody.
    ///
    /// Costs the dynamic objects that are visible or whose volume was seen.
    ///
    /// # Errors
    /// Refuses a result of another scene; then nothing changes.
    pub fn end_frame<'a>(&mut self, views: impl IntoIterator<Item = &'a Pvs>) -> Result<FrameReport, Error> {
        let views: Vec<&Pvs> = views.into_iter().filter(|pvs| pvs.has_run()).collect();
        if views.iter().any(|pvs| pvs.scene != self.tag()) {
            return Err(Error::ForeignPvs);
        }
        let mut report = FrameReport { drawn: std::mem::take(&mut self.drawn), ..FrameReport::default() };
        if views.is_empty() {
            return Ok(report);
        }
        self.viewers.clear();
        let eyes = views.iter().filter_map(|pvs| pvs.view());
        self.viewers.extend(eyes.map(|view| self.grid.cell_of(view.eye())));
        let seen = self.seen_by(&views);
        for &id in views.iter().flat_map(|pvs| pvs.revealed.iter().chain(&pvs.visible)) {
            if self.find(id).is_ok_and(|object| object.hidden().is_some()) {
                report.revealed += 1;
                self.reveal(id.slot(), seen.contains(id.slot()));
            }
        }
        report.hidden = self.hide_unseen(&seen);
        report.drawn += std::mem::take(&mut self.drawn);
        self.seen = seen.0;
        self.compact_expiries();
        self.revision += u64::from(report != FrameReport::default());
        Ok(report)
    }

    /// The objects that are in one of the sets.
    fn seen_by(&mut self, views: &[&Pvs]) -> Seen {
        let mut seen = std::mem::take(&mut self.seen);
        seen.clear();
        seen.resize(self.slots.count().div_ceil(64), 0);
        for id in views.iter().flat_map(|pvs| &pvs.visible) {
            if self.find(*id).is_ok() {
                seen[id.index() / 64] |= 1 << (id.index() % 64);
            }
        }
        Seen(seen)
    }

    /// Puts listed dynamic objects that no view saw into volumes, and counts them.
    fn hide_unseen(&mut self, seen: &Seen) -> usize {
        let (mut hidden, mut i) = (0, 0);
        while let Some(&slot) = self.listed.as_slice().get(i) {
            if !seen.contains(slot) && self.try_hide(slot) {
                // Another object is in its place of the list now.
                hidden += 1;
                continue;
            }
            if seen.contains(slot) {
                let frame = self.frame;
                let mover = self.slots.get_mut(slot).and_then(|object| object.mover.as_mut());
                mover.into_iter().for_each(|mover| mover.seen_in = frame);
            }
            i += 1;
        }
        hidden
    }
}
