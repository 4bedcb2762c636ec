//! Homes: where each object is known to stay, and until when that is known.
//!
//! | Home     | Whose                          | Its box                | Found by                  |
//! |----------|--------------------------------|------------------------|---------------------------|
//! | *bricks* | static objects                 | the bounds             | I, by the bricks touched  |
//! | *bricks* | large movers, and those that hide others | the bricks of their box | I, by these bricks |
//! | *zone*   | small movers that hide nothing | the room of the zone   | [`crate::scene::movers`]  |
//! | *volume* | movers that no view saw        | the block of the volume | T                        |
//!
//! Objects in bricks and zones are *listed*; what the grid does not reach is listed in `always`. A
//! report inside of the box of a mover that hides nothing changes no list ([`crate::scene::rooms`]).
//!
//! Where motion is reported, it is known for ever that an object is in its box. If an object is
//! reported on expiry, that is known for one in a volume until [`Hidden::expires`], and for one that
//! is listed until the clock moves ([`crate::scene::reports`]). After that it is *overdue*: it counts
//! as visible and hides nothing until it is reported.
//!
//! | Call           | Home                                        | Then                          |
//! |----------------|---------------------------------------------|-------------------------------|
//! | `insert`       | none                                        | listed                        |
//! | `begin_frame`  | any whose time is over                      | the same, overdue             |
//! | `update`       | listed, overdue or not                      | listed where it is now        |
//! | `update`       | volume, inside of it                        | the same, until another time  |
//! | `update`       | volume, overdue, with enough room left      | the same, until another time  |
//! | `update`       | volume, outside or with too little room     | listed; on expiry a new volume |
//! | `end_frame`    | listed, in no set, not overdue, not resting | a new volume, if one fits     |
//! | `end_frame`    | volume, revealed                            | listed; on expiry overdue      |
//! | `set_origin`   | volume, surely still inside of it           | the same                      |
//! | `set_origin`   | any other volume                            | listed; on expiry maybe overdue |
//!
//! An object of any home can be removed. Those that are *resting* left a volume so soon that they get
//! none for some time. `set_occluder`, `set_bounds` and `set_transform` act as `update` does.
//!
//! # How long a volume is made to last
//!
//! That adapts: longer after the object left or outlived its volume unseen, half as long after the
//! volume was revealed. A slow rise keeps most volumes from being revealed at all: each reveal
//! costs a query a test, and the object a new volume.

use crate::scene::volume::Tbv;

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

/// Seconds that the first volume of an object is made to last.
const FIRST: f64 = 0.5;
/// Adaptation stays between these, in seconds.
const LEAST: f64 = 1.0 / 64.0;
const MOST: f64 = 64.0;
/// The factors of a volume that was outlived, and of one that was revealed.
const LONGER: f64 = 1.25;
const SHORTER: f64 = 0.5;

/// The validity of an object's next volume.
#[derive(Debug, Clone, Copy)]
pub(super) struct Validity {
    seconds: f64,
    /// Whether the last volume was revealed.
    was_revealed: bool,
}

impl Validity {
    /// The validity of the first volume of an object.
    pub(super) fn first() -> Self {
        Self { seconds: FIRST, was_revealed: false }
    }

    /// How long the next volume is made to last, in seconds.
    pub(super) fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Whether the last volume was revealed: the next one has no room that the object cannot reach.
    pub(super) fn was_revealed(&self) -> bool {
        self.was_revealed
    }

    /// A volume was outlived.
    pub(super) fn outlived(&mut self) {
        self.was_revealed = false;
        self.seconds = (self.seconds * LONGER).min(MOST);
    }

    /// A volume was revealed.
    pub(super) fn revealed(&mut self) {
        self.was_revealed = true;
        self.seconds = (self.seconds * SHORTER).max(LEAST);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn validity_rises_slowly_and_falls_fast_within_its_range() {
        let mut validity = Validity::first();
        for _ in 0..100 {
            validity.outlived();
        }
        assert_eq!(validity.seconds(), MOST);
        for halvings in 1..=12 {
            validity.revealed();
            assert_eq!(validity.seconds(), MOST / f64::from(1 << halvings));
        }
        validity.revealed();
        assert!(validity.seconds() == LEAST && validity.was_revealed());
        validity.outlived();
        assert!(!validity.was_revealed());
    }
}
