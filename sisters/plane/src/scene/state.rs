//! Where a dynamic object is, as far as the scene knows.
//!
//! | State     | I and O                          | T            | Queries                                     |
//! |-----------|----------------------------------|--------------|---------------------------------------------|
//! | `Listed`  | its cells                        | -            | test it where its cells are in sight        |
//! | `Overdue` | its last cells in I, none in O   | -            | count it as visible                         |
//! | `Hidden`  | -                                | its volume   | test it where its volume is in sight        |
//! | `Lost`    | -                                | -            | count it as visible                         |
//!
//! | Call          | Object                                       | State after                                     |
//! |---------------|----------------------------------------------|-------------------------------------------------|
//! | `begin_frame` | listed, reported on expiry, no report yet    | `Overdue`                                       |
//! | `begin_frame` | hidden, its volume expires                   | `Lost`                                          |
//! | `update`      | listed or overdue                            | `Listed`                                        |
//! | `update`      | hidden, inside its volume                    | `Hidden`: the same volume, another expiry       |
//! | `update`      | hidden outside its volume, or lost           | `Hidden` if a volume fits, else `Listed`        |
//! | `end_frame`   | listed, in no set                            | `Hidden` if a volume fits, else `Listed`        |
//! | `end_frame`   | hidden, seen, reported on expiry             | `Lost`                                          |
//! | `end_frame`   | hidden, volume seen, in a set                | `Listed`                                        |
//! | `end_frame`   | hidden, volume seen, in no set               | `Hidden` if a volume fits, else `Listed`        |

use crate::geometry::Shape;
use crate::volume::{Tbv, Validity};

/// Where an object is: see the tables of this module.
#[derive(Debug, Clone)]
pub(super) enum State {
    Listed,
    Overdue,
    Hidden(Hidden),
    Lost,
}

/// The volume of a hidden object, and until when it is certain.
#[derive(Debug, Clone)]
pub(super) struct Hidden {
    pub(super) tbv: Tbv,
    /// How long it was made to last, in seconds.
    pub(super) lasts: f64,
    /// Until then, in seconds, the object cannot leave the volume. Only objects that are reported
    /// on expiry use it.
    pub(super) expires: f64,
    /// The time of the object's entry in the queue of expiries, never later than `expires`;
    /// infinity without entry.
    pub(super) queued: f64,
    /// The disc in which an object is that goes unreported.
    pub(super) region: Option<Shape>,
}

/// The parts that only a dynamic object has.
#[derive(Debug, Clone)]
pub(super) struct Mover {
    pub(super) state: State,
    pub(super) validity: Validity,
    /// The time of the last report.
    pub(super) reported: f64,
    /// The number of the last frame that ended with it in sight.
    pub(super) seen_in: u64,
}

impl Mover {
    pub(super) fn new(now: f64) -> Self {
        Self { state: State::Listed, validity: Validity::first(), reported: now, seen_in: 0 }
    }
}
