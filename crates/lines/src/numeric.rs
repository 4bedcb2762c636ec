//! All floating-point margins of the crate, each with its reason, and the one hash.

/// The matrix of a view may differ from a rotation by this much in each entry of its product with its transpose: matrices
/// built in single precision do, by some roundings.
pub(crate) const NOT_RIGID: f64 = 1e-4;

/// The least sine of an angle to the tangent that the thesis' ratio of sines divides by: it keeps a single prism, whose far end
/// lies on the line's own direction, from outweighing all others.
pub(crate) const LEAST_SINE: f32 = 1e-3;

/// A base plane whose normal has a component along the column below this is parallel to it: the crossing would lie thousands of
/// radii away, so that the column is wholly above the plane or wholly below.
pub(crate) const PARALLEL: f32 = 1e-6;

/// A tangent this close to the direction of view (the sine of the angle) leaves no direction towards the eye that is normal to it:
/// single precision would give noise.
pub(crate) const ALONG_VIEW: f32 = 1e-4;

/// The share of a solid angle that must be known for an estimate: below it one column would speak for a whole hemisphere.
pub(crate) const LEAST_KNOWN: f32 = 1e-3;

/// A pseudo-random number from a number (SplitMix64, Steele et al. 2014, "Fast splittable pseudorandom number generators").
pub(crate) fn hash(state: u64) -> u64 {
    let z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Seeded pseudo-random numbers: the same on every machine.
#[derive(Debug, Clone)]
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(hash(seed))
    }

    /// Evenly spread in 0 to 1, without 1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(1);
        (hash(self.0) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Evenly spread in `lo` to `hi`.
    pub(crate) fn within(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.unit()
    }
}
