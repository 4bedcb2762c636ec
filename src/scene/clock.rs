//! The clock of a scene, and what is due by it.

use casca_slots::{Expiry, ExpiryQueue, Id, Slot, Slots};

use crate::scene::home::Hidden;
use crate::scene::object::Object;
use crate::scene::reports::ReportLog;
use crate::scene::slot_bits::SlotBits;

/// A small object that is reported whenever it moves, and that left its volume after fewer frames,
/// is listed in a zone instead of getting another one: writing and erasing a volume costs as much
/// as some thirty reports.
const WORTH_FRAMES: u64 = 32;

/// The same for an object reported on expiry, for which a volume saves reports, which cost the
/// application time, too: one that lasts for fewer frames costs more than these reports.
pub(super) const WORTH_ASKING: u64 = 8;

/// A volume that lasted for this many seconds was worth it, however few frames there were.
const WORTH_SECONDS: f64 = 0.25;

/// An object whose volume did not last gets no other for this many frames, or up to twice as many.
const REST: u64 = 256;

/// The time and the number of the frame. It owns what becomes due by them: volumes that expire,
/// reports, and objects that rest.
#[derive(Debug, Clone, Default)]
pub(super) struct Clock {
    /// In seconds.
    pub(super) now: f64,
    /// Number of the frame, counted by [`Scene::begin_frame`](crate::Scene::begin_frame).
    pub(super) frame: u64,
    /// When volumes may not contain their objects any more.
    pub(super) expiries: ExpiryQueue,
    /// When objects reported on expiry were last reported.
    pub(super) reports: ReportLog,
    /// Objects that get no volume for some frames, though no view sees them: those that began to
    /// rest in the present span of frames, and those of the span before.
    resting: [SlotBits; 2],
}

impl Clock {
    /// The volume of an object expires at a time.
    pub(super) fn queue(&mut self, id: Id, at: f64) {
        self.expiries.push(Expiry { at, slot: id.slot(), generation: id.generation() });
    }

    /// Whether a volume of a small object that is over now did not last long enough to pay.
    pub(super) fn was_short(&self, hidden: &Hidden, on_expiry: bool) -> bool {
        let frames = self.frame.saturating_sub(hidden.since);
        match on_expiry {
            true => frames < WORTH_ASKING && self.now - hidden.made < WORTH_SECONDS,
            false => frames < WORTH_FRAMES,
        }
    }

    /// An object gets no volume for some frames.
    pub(super) fn rest(&mut self, slot: Slot) {
        self.resting[0].insert(slot);
    }

    /// Whether an object gets no volume, or one that had the slot before would get none.
    pub(super) fn is_resting(&self, slot: Slot) -> bool {
        self.resting.iter().any(|resting| resting.contains(slot))
    }

    /// A frame begins at a time.
    pub(super) fn begin(&mut self, now: f64) {
        self.now = now;
        self.frame += 1;
        if self.frame.is_multiple_of(REST) {
            self.resting.swap(0, 1);
            self.resting[0].clear();
        }
    }

    /// Drops entries of the queue that were replaced since, once there are many of them.
    pub(super) fn compact_expiries(&mut self, objects: &Slots<Object>) {
        if !self.expiries.is_crowded(objects.len()) {
            return;
        }
        self.expiries.retain(|entry| {
            let object = objects.of_generation(entry.slot, entry.generation);
            object.and_then(Object::volume).is_some_and(|hidden| hidden.queued == entry.at)
        });
    }

    pub(super) fn bytes(&self) -> usize {
        self.expiries.bytes()
            + self.reports.bytes()
            + self.resting.each_ref().map(SlotBits::bytes).iter().sum::<usize>()
    }
}
