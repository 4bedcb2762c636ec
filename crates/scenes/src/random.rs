//! The random numbers of scenes, experiments and exact visibility: all from a seed.

use rand::SeedableRng;

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

#[cfg(test)]
mod tests {
    use rand::RngExt;

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
