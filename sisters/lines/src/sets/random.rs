//! Seeded pseudo-random numbers, the same on every machine.

/// A pseudo-random number from a number (SplitMix64, Steele et al. 2014, "Fast splittable
/// pseudorandom number generators").
pub fn hash(state: u64) -> u64 {
    let z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A sequence of pseudo-random numbers.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// The sequence of a seed.
    pub fn new(seed: u64) -> Self {
        Self(hash(seed))
    }

    /// Evenly spread in 0 to 1, without 1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(1);
        (hash(self.0) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Evenly spread in `lo` to `hi`.
    pub fn within(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.unit()
    }
}
