//! Open ground with scattered rocks.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::bits::BitGrid;

/// A rock for so many tiles.
const TILES_A_ROCK: u64 = 120;
/// The longest side of a rock's rectangle.
const LONGEST: u32 = 3;

/// See [`crate::maps::MapKind::Fields`].
pub(super) fn fields(width: u32, height: u32, seed: u64) -> BitGrid {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut rocks = BitGrid::new(width, height);
    if width == 0 || height == 0 {
        return rocks;
    }
    for _ in 0..u64::from(width) * u64::from(height) / TILES_A_ROCK {
        let (x, y) = (random.random_range(0..width), random.random_range(0..height));
        // Two arms that cross at the first tile.
        rocks.fill(y, x..x.saturating_add(random.random_range(1..=LONGEST)));
        for above in 1..random.random_range(1..=LONGEST) {
            rocks.set(x, y.saturating_add(above), true);
        }
    }
    rocks
}
