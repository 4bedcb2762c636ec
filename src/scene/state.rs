//! The states of an object, and the events that change them.
//!
//! This table is the whole machine. [`State::after`] is the table as code, and a test goes through
//! each of its entries. "-" means that the event does not apply: the state stays as it is.
//!
//! | Event                                             | Listed  | Overdue | Hidden                  | Unlocated |
//! |---------------------------------------------------|---------|---------|-------------------------|-----------|
//! | `Missed`: time passed and no report came          | Overdue | -       | -                       | -         |
//! | `Reported`: the application told where it is      | -       | Listed  | -                       | -         |
//! | `Enclosed`: it is inside a volume from now on     | Hidden  | -       | Hidden                  | Hidden    |
//! | `Requeued`: its expiry is queued for another time | -       | -       | Hidden                  | -         |
//! | `Expired`: it may have left its volume            | -       | -       | Unlocated, with volume  | -         |
//! | `Revealed`: its volume is gone                    | -       | -       | Unlocated, no volume    | the same  |
//! | `Listed`: its cells are in the matrices           | Listed  | -       | Listed                  | Listed    |
//!
//! A new object is listed. An object of any state can be removed.
//!
//! The calls of the application cause these events:
//!
//! | Call                       | Object                                        | Events                                        |
//! |----------------------------|-----------------------------------------------|-----------------------------------------------|
//! | `begin_frame`              | listed, reported on expiry, in no zone        | `Missed`                                      |
//! | `begin_frame`              | hidden, its expiry was put off                | `Requeued`                                    |
//! | `begin_frame`              | hidden, its expiry is due                     | `Expired`                                     |
//! | `update`, `set_occluder`   | overdue                                       | `Reported`, then as listed                    |
//! | `update`, `set_occluder`   | listed                                        | none: its cells move                          |
//! | `update`, `set_occluder`   | hidden, still inside its volume               | `Enclosed` (the same volume, another expiry)  |
//! | `update`, `set_occluder`   | hidden, outside its volume                    | `Enclosed` if a new volume fits, else `Listed`|
//! | `update`, `set_occluder`   | the same, small, and the volume was new       | `Listed`                                      |
//! | `update`, `set_occluder`   | unlocated, its volume expired                 | `Enclosed` (old or new volume), else `Listed` |
//! | `update`, `set_occluder`   | the same, small, and the volume was new       | `Listed`                                      |
//! | `update`, `set_occluder`   | unlocated, its volume revealed                | `Listed`                                      |
//! | `end_frame`                | listed, in no set                             | `Enclosed` if a volume fits, else none        |
//! | `end_frame`                | hidden, volume revealed, reported on expiry   | `Revealed`                                    |
//! | `end_frame`                | hidden, volume revealed, in a set             | `Listed`                                      |
//! | `end_frame`                | hidden, volume revealed, in no set            | `Enclosed` if a new volume fits, else `Listed`|
//! | `set_origin`               | hidden, surely still inside its volume        | `Enclosed` (the same volume)                  |
//! | `set_origin`               | hidden or unlocated, reported on expiry       | `Revealed` if it may be outside               |
//! | `set_origin`               | hidden, reported when moved, outside by now   | `Listed`                                      |
//!
//! An overdue object gets no volume: a volume around an old place contains nothing for certain. One
//! that is listed in a zone is overdue without an event: [`crate::scene::reports`] tells.

use crate::scene::volume::Tbv;

/// Where an object is, as far as the scene knows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum State {
    /// Its cells are in I, and in O if it has an occluder.
    Listed,
    /// As `Listed`, but the object is reported on expiry, in no zone, and was not reported since
    /// the clock last moved. It may be anywhere: it counts as visible and hides nothing.
    Overdue,
    /// It is inside a temporal bounding volume, and its cells are in no matrix.
    Hidden(Hidden),
    /// Its volume expired or was revealed, and no report came since: it counts as visible and hides
    /// nothing.
    Unlocated {
        /// The expired volume stays in the matrices, in case the object is still inside.
        volume: Option<Tbv>,
    },
}

/// The volume of a hidden object, and until when it is certain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hidden {
    pub(super) tbv: Tbv,
    /// Until then, in seconds, the object cannot leave the volume. Only objects that are reported
    /// on expiry use it.
    pub(super) expires: f64,
    /// The time of the object's entry in the queue of expiries, never later than `expires`;
    /// infinity without entry.
    pub(super) queued: f64,
    /// The number of the frame in which the volume was made.
    pub(super) since: u64,
    /// The time at which it was made.
    pub(super) made: f64,
}

/// What happens to an object. The table of this module says which states it leads to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Event {
    Missed,
    Reported,
    Enclosed(Hidden),
    Requeued(f64),
    Expired,
    Revealed,
    Listed,
}

impl State {
    /// The state after an event, or `None` where the event does not apply.
    pub(super) fn after(self, event: Event) -> Option<Self> {
        match (self, event) {
            (Self::Listed, Event::Missed) => Some(Self::Overdue),
            (Self::Overdue, Event::Reported) => Some(Self::Listed),
            (Self::Overdue, _) => None,
            (_, Event::Enclosed(hidden)) => Some(Self::Hidden(hidden)),
            (_, Event::Listed) => Some(Self::Listed),
            (Self::Hidden(hidden), Event::Requeued(queued)) => {
                Some(Self::Hidden(Hidden { queued, ..hidden }))
            }
            (Self::Hidden(hidden), Event::Expired) => Some(Self::Unlocated { volume: Some(hidden.tbv) }),
            (Self::Hidden(_) | Self::Unlocated { .. }, Event::Revealed) => {
                Some(Self::Unlocated { volume: None })
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, IVec3};

    use super::*;
    use crate::geometry::Block;
    use crate::grid::cell_box::CellBox;

    fn hidden(side: i32, queued: f64) -> Hidden {
        let cells = CellBox { lo: IVec3::ZERO, hi: IVec3::splat(side - 1) };
        let block = Block { min: DVec3::ZERO, max: DVec3::splat(f64::from(side)) };
        Hidden { tbv: Tbv { cells, block, slack: 1.0 }, expires: 5.0, queued, since: 1, made: 0.0 }
    }

    #[test]
    fn every_entry_of_the_table_is_as_written() {
        let (small, large) = (hidden(2, 3.0), hidden(4, 4.0));
        let kept = State::Unlocated { volume: Some(small.tbv) };
        let bare = State::Unlocated { volume: None };
        let states = [State::Listed, State::Overdue, State::Hidden(small), kept, bare];
        let into = State::Hidden(large);
        let (listed, overdue) = (State::Listed, State::Overdue);
        let no = None;
        let table = [
            (Event::Missed, [Some(overdue), no, no, no, no]),
            (Event::Reported, [no, Some(listed), no, no, no]),
            (Event::Enclosed(large), [Some(into), no, Some(into), Some(into), Some(into)]),
            (Event::Requeued(4.5), [no, no, Some(State::Hidden(hidden(2, 4.5))), no, no]),
            (Event::Expired, [no, no, Some(kept), no, no]),
            (Event::Revealed, [no, no, Some(bare), Some(bare), Some(bare)]),
            (Event::Listed, [Some(listed), no, Some(listed), Some(listed), Some(listed)]),
        ];
        for (event, row) in table {
            for (state, next) in states.into_iter().zip(row) {
                assert_eq!(state.after(event), next, "{state:?} after {event:?}");
            }
        }
    }
}
