//! The frame loop: the clock and the results of a frame's queries.

use glam::DVec3;

use crate::error::Error;
use crate::id::ObjectId;
use crate::pvs::Pvs;
use crate::scene::Scene;

/// The changes that [`Scene::end_frame`] made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct FrameReport {
    /// Objects found hidden and put into a temporal bounding volume.
    pub hidden: usize,
    /// Volumes that were revealed.
    pub revealed: usize,
}

/// The most objects that one [`Scene::end_frame`] puts into volumes. One whose volume reaches into
/// 16 bricks of 8x8x8 cells or more counts as several.
///
/// A volume costs a microsecond or some: it is written into all of its bricks. An object without one
/// costs a fraction of that in each frame, when it moves.
pub const MOST_NEW_VOLUMES: usize = 512;

/// A volume counts once more for each time that it reaches into this many bricks.
const MANY_BRICKS: usize = 16;

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
            return Err(Error::NotFinite { what: "the time", value: DVec3::splat(now) });
        }
        let backwards = now < self.clock.now;
        if now != self.clock.now {
            self.clock.reports.clock_moved();
            self.opacity.clock_moved();
        }
        let ended = self.clock.frame;
        self.clock.begin(now);
        let mut due = Vec::new();
        let until = if backwards { f64::INFINITY } else { now };
        while let Some(entry) = self.clock.expiries.pop_until(until) {
            if self.expire(entry, backwards) {
                due.push(self.id(entry.slot));
            }
        }
        // One that the last frame showed is reported unasked.
        if self.clock.reports.count_overdue() > 0 {
            self.changes.changed();
            let overdue = self.clock.reports.overdue();
            let unseen = overdue.filter(|&slot| !self.last_frame.saw_in(ended, slot));
            due.extend(unseen.map(|slot| self.id(slot)));
        }
        Ok(due)
    }

    /// Applies the results of a frame's queries: dynamic objects that no view saw go into temporal
    /// bounding volumes, revealed ones come out. Without results nothing changes; those of queries
    /// that never ran are passed over. A frame that ends without a call costs reports and time, but
    /// loses nobody.
    ///
    /// At most [`MOST_NEW_VOLUMES`] unseen objects are put into volumes by one call, in turn; the
    /// others stay listed, are tested by queries as the visible ones are, and follow in the next
    /// frames. So the first frame with 100,000 movers costs no more than any other, and 196 frames
    /// put all of them into volumes.
    ///
    /// Small objects that hide nothing stay listed for 256 to 512 frames once they left their volume
    /// within 32 frames; if they are reported on expiry, within 8 frames and a quarter of a second,
    /// and then they are due in each of these frames. What hides their zones hides them too, and
    /// lists of zones cost less than a volume that does not last.
    ///
    /// Costs the dynamic objects that are in no volume, and the volumes that are made.
    ///
    /// # Errors
    /// Refuses a result of another scene; then nothing changes.
    pub fn end_frame<'a>(&mut self, views: impl IntoIterator<Item = &'a Pvs>) -> Result<FrameReport, Error> {
        let views: Vec<&Pvs> = views.into_iter().filter(|p| p.has_run()).collect();
        if views.iter().any(|p| p.scene != self.tag()) {
            return Err(Error::ForeignPvs);
        }
        let mut report = FrameReport::default();
        if views.is_empty() {
            return Ok(report);
        }
        self.last_frame.end(self.clock.frame, views.iter().filter_map(|p| p.viewer));
        for pvs in &views {
            // Most results are fresh: then no object needs to be looked up.
            let fresh = pvs.is_fresh(self.revision(), self.moves());
            for id in &pvs.visible {
                if fresh || self.slots.find(id.0).is_some() {
                    self.last_frame.seen.insert(id.slot());
                }
            }
        }
        for &id in views.iter().flat_map(|p| &p.revealed) {
            if self.find(id).is_ok_and(|object| object.is_hidden()) {
                report.revealed += 1;
                self.reveal(id.slot());
            }
        }
        // Of too many for one frame, those after the last one are first: so each has its turn.
        let listed = self.index.movers.as_slice().iter().copied();
        let awake = listed.filter(|&slot| !self.clock.is_resting(slot));
        let unseen = self.last_frame.unseen(awake, MOST_NEW_VOLUMES);
        let (mut tried, mut cost) = (0, 0);
        while cost < MOST_NEW_VOLUMES && tried < unseen.len() {
            if let Some(bricks) = self.try_hide(unseen[tried]) {
                report.hidden += 1;
                cost += 1 + bricks / MANY_BRICKS;
            }
            tried += 1;
        }
        self.last_frame.hid(unseen, tried);
        self.clock.compact_expiries(&self.slots);
        Ok(report)
    }
}
