//! For how long the volume of an object is made to last.
//!
//! It adapts: longer after the object left or outlived its volume unseen, half as long after the
//! volume was revealed. A slow rise keeps most volumes from being revealed at all: each reveal
//! costs a query a test, and the object a new volume.

/// Seconds that the first volume of an object is made to last.
const FIRST: f64 = 0.5;
/// Adaptation stays between these, in seconds.
const LEAST: f64 = 1.0 / 64.0;
const MOST: f64 = 64.0;
/// The factors of a volume that was outlived, and of one that was revealed.
const LONGER: f64 = 1.25;
const SHORTER: f64 = 0.5;

/// When even the shortest volume beyond the grid was revealed, this many volumes stay inside: the
/// masks of [`crate::Method::Cell`] end with the grid, so that it reveals each volume that leaves
/// the grid inside the frustum.
const CONFINED: u8 = 8;

/// The validity of an object's next volume.
#[derive(Debug, Clone, Copy)]
pub(super) struct Validity {
    seconds: f64,
    /// How many of the next volumes stay inside the grid.
    confined: u8,
}

impl Validity {
    /// The validity of the first volume of an object.
    pub(super) fn first() -> Self {
        Self { seconds: FIRST, confined: 0 }
    }

    /// How long the next volume is made to last, in seconds.
    pub(super) fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Whether the next volume must stay inside the grid.
    pub(super) fn is_confined(&self) -> bool {
        self.confined > 0
    }

    /// A volume was outlived. Confined volumes tell nothing about larger ones.
    pub(super) fn outlived(&mut self) {
        if self.confined == 0 {
            self.seconds = (self.seconds * LONGER).min(MOST);
        }
    }

    /// A volume was revealed; `outer` says whether it reached beyond the grid.
    pub(super) fn revealed(&mut self, outer: bool) {
        self.seconds = (self.seconds * SHORTER).max(LEAST);
        if outer && self.seconds <= LEAST {
            self.confined = CONFINED;
        }
    }

    /// A volume, or an attempt to make one, is over.
    pub(super) fn passed(&mut self) {
        self.confined = self.confined.saturating_sub(1);
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
            validity.revealed(false);
            assert_eq!(validity.seconds(), MOST / f64::from(1 << halvings));
        }
        validity.revealed(false);
        assert!(validity.seconds() == LEAST && !validity.is_confined());
    }

    #[test]
    fn a_confined_object_waits_for_eight_volumes() {
        let mut validity = Validity::first();
        (0..10).for_each(|_| validity.revealed(true));
        for _ in 0..CONFINED {
            assert!(validity.is_confined());
            validity.outlived();
            assert_eq!(validity.seconds(), LEAST, "confined volumes do not lengthen");
            validity.passed();
        }
        assert!(!validity.is_confined());
    }
}
