//! The random numbers of scenes, experiments and exact visibility: all from a seed.

use glam::Vec3;
use rand::{RngExt, SeedableRng};

/// The generator that all of them use. The same seed gives the same numbers on every machine.
pub use rand_pcg::Pcg64Mcg as Generator;

/// The odd number next to 2^64 over the golden ratio.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// The generator of one stream of random numbers. A caller that needs several streams of a seed
/// numbers them; where seeds and streams both count up, one of them goes through [`spread`].
pub fn generator(seed: u64, stream: u64) -> Generator {
    Generator::seed_from_u64(seed ^ stream)
}

/// Numbers close to each other become numbers far from each other, so that a seed and a stream that
/// count up do not meet. Different numbers stay different.
pub fn spread(number: u64) -> u64 {
    number.wrapping_mul(GOLDEN)
}

/// Random numbers and places from a seed.
pub struct Dice(Generator);

impl Dice {
    /// Those of a stream, which may count up as seeds do.
    pub fn new(seed: u64, stream: u64) -> Self {
        Self(generator(spread(seed), stream))
    }

    /// A number from `lo` to `hi`.
    pub fn range(&mut self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.0.random::<f32>()
    }

    /// True in this share of all cases.
    pub fn chance(&mut self, share: f32) -> bool {
        self.0.random::<f32>() < share
    }

    /// A point of a box.
    pub fn point(&mut self, lo: Vec3, hi: Vec3) -> Vec3 {
        Vec3::new(self.range(lo.x, hi.x), self.range(lo.y, hi.y), self.range(lo.z, hi.z))
    }

    /// A vector at most 1 long.
    pub fn ball(&mut self) -> Vec3 {
        for _ in 0..64 {
            let v = self.point(Vec3::NEG_ONE, Vec3::ONE);
            if v.length_squared() <= 1.0 {
                return v;
            }
        }
        Vec3::ZERO
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_are_what_they_were_and_differ() {
        // Scenes, pinned sets and the figures of the report come from these numbers.
        let first = |seed, stream| generator(seed, stream).random::<u64>();
        assert_eq!(first(1, 0), Generator::seed_from_u64(1).random::<u64>());
        assert_eq!(first(6, 3), first(5, 0));
        let mut all: Vec<u64> = (0..100).flat_map(|s| (0..100).map(move |i| first(spread(s), i))).collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 10_000);
    }
}
