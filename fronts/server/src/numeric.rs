//! Margins and limits, each with its reason.

/// Coordinates may be so far from the origin, in metres: single precision tells places there apart
/// by 6 cm.
pub const FARTHEST: f32 = 1e6;

/// The greatest speed of an eye or an entity, in metres a second. Faster ones see all in a tick.
pub const FASTEST: f32 = 1e5;

/// The longest latency, tick or age of a report, in seconds: whoever is later is gone.
pub const LONGEST: f32 = 60.0;

/// A box that goes on to here on all sides holds all eyes, so that who may be anywhere in it is
/// told of; it does not grow on, so that sums with its corners stay finite.
pub(crate) const EVERYWHERE: f32 = 1e9;

/// Sums and products of a few numbers in double precision are off by less than this share.
pub(crate) const ROUNDING: f64 = 1e-12;

/// Narrower walls hide too little to be asked, in metres: a wall must be as wide as the room that
/// the eye or the entity has.
pub(crate) const LEAST_WALL: f32 = 0.6;

/// Times that entities move for are rounded up to so many seconds, so that clients share their
/// boxes: at 5 m/s that is 5 cm.
pub(crate) const STEP: f64 = 0.01;

/// The least single number that is not less than a double one of at most 1e38; infinite beyond.
pub(crate) fn at_least(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) < value { near.next_up() } else { near }
}

/// The greatest single number that is not more than a double one of at least -1e38.
pub(crate) fn at_most(value: f64) -> f32 {
    -at_least(-value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_to_the_side_asked_for() {
        for value in [0.0, 0.1, -0.1, 1.0, 16_777_217.0, -16_777_217.0, 1e-50, -1e-50, 1e300] {
            assert!(f64::from(at_least(value)) >= value, "{value}");
            assert!(f64::from(at_most(value)) <= value, "{value}");
        }
        assert_eq!((at_least(0.5), at_most(0.5)), (0.5, 0.5));
    }
}
