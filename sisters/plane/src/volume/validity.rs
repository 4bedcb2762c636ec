//! For how long the volume of an object is made to last (thesis, section 3.3.1; Sudarsky & Gotsman
//! 1996).
//!
//! Longer after the object left or outlived its volume unseen, half as long after the volume was
//! seen. A slow rise keeps most volumes from being seen at all.

/// Seconds that the first volume of an object is made to last.
const FIRST: f64 = 0.5;
/// Adaptation stays between these, in seconds.
const LEAST: f64 = 1.0 / 64.0;
const MOST: f64 = 64.0;
/// The factors of a volume that was outlived, and of one that was seen.
const LONGER: f64 = 1.25;
const SHORTER: f64 = 0.5;

/// The validity of an object's next volume, in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Validity(f64);

impl Validity {
    /// The validity of the first volume of an object.
    pub(crate) fn first() -> Self {
        Self(FIRST)
    }

    /// How long the next volume is made to last.
    pub(crate) fn seconds(self) -> f64 {
        self.0
    }

    /// The object left its volume, or the volume expired, before any view saw it. A volume that a
    /// limit kept from lasting as long as was asked for tells nothing about larger ones.
    pub(crate) fn outlived(&mut self, lasted: f64) {
        if lasted >= self.0 {
            self.0 = (self.0 * LONGER).min(MOST);
        }
    }

    /// A view saw the volume.
    pub(crate) fn revealed(&mut self) {
        self.0 = (self.0 * SHORTER).max(LEAST);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn validity_rises_slowly_and_falls_fast_within_its_range() {
        let mut validity = Validity::first();
        (0..100).for_each(|_| validity.outlived(20.0));
        assert!((20.0..25.0).contains(&validity.seconds()));
        (0..100).for_each(|_| validity.outlived(MOST));
        assert_eq!(validity.seconds(), MOST);
        for halvings in 1..=12 {
            validity.revealed();
            assert_eq!(validity.seconds(), MOST / f64::from(1 << halvings));
        }
        validity.revealed();
        assert_eq!(validity.seconds(), LEAST);
    }
}
