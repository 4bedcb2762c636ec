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
