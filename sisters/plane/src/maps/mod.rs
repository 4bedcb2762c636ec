//! Maps for tests, benches and examples: floor plans, caves and open fields from a seed, and a
//! small map that comes with the crate.
//!
//! One seed always gives the same map.

mod drawing;
mod rooms;

pub use drawing::{Drawing, HARBOUR, MapError};
pub use rooms::FloorPlan;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::bits::BitGrid;

/// A kind of map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MapKind {
    /// Floor plans: rooms and corridors between walls of one tile, with doors of one tile.
    Rooms,
    /// Caves, from a cellular automaton.
    Caves,
    /// Open ground with rocks of one to five tiles.
    Fields,
}

impl MapKind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Rooms, Self::Caves, Self::Fields];

    /// The name of the kind: `"rooms"`, `"caves"` or `"fields"`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rooms => "rooms",
            Self::Caves => "caves",
            Self::Fields => "fields",
        }
    }

    /// The opaque tiles of a map of this kind. Costs some nanoseconds a tile.
    pub fn generate(self, width: u32, height: u32, seed: u64) -> BitGrid {
        match self {
            Self::Rooms => FloorPlan::generate(width, height, seed).walls,
            Self::Caves => caves(width, height, seed),
            Self::Fields => fields(width, height, seed),
        }
    }
}

/// The share of rock at the beginning.
const ROCK: f64 = 0.44;
/// How often the rock is smoothed.
const STEPS: u32 = 5;
/// A tile is rock if so many of the nine tiles around it and at it are.
const MAJORITY: u8 = 5;

/// Random rock, smoothed by a cellular automaton.
fn caves(width: u32, height: u32, seed: u64) -> BitGrid {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut rock = BitGrid::new(width, height);
    for y in 0..height {
        for x in 0..width {
            rock.set(x, y, random.random_bool(ROCK));
        }
    }
    for _ in 0..STEPS {
        rock = smoothed(&rock);
    }
    rock
}

/// Each tile as most of those around it. Rock lies beyond the border.
fn smoothed(rock: &BitGrid) -> BitGrid {
    let (width, height) = (rock.width(), rock.height());
    let mut next = BitGrid::new(width, height);
    // Rows of counts: rock in three tiles of a row.
    let three = |y: Option<u32>| -> Vec<u8> {
        let at = |x: u32| match y {
            Some(y) if x < width && y < height => u8::from(rock.get(x, y)),
            _ => 1,
        };
        (0..width).map(|x| at(x.wrapping_sub(1)) + at(x) + at(x + 1)).collect()
    };
    let (mut below, mut here) = (three(None), three(Some(0)));
    for y in 0..height {
        let above = three(Some(y + 1));
        for x in 0..width {
            let at = x as usize;
            next.set(x, y, below[at] + here[at] + above[at] >= MAJORITY);
        }
        (below, here) = (here, above);
    }
    next
}

/// A rock for so many tiles.
const TILES_A_ROCK: u64 = 120;
/// The longest side of a rock's rectangle.
const LONGEST_ROCK: u32 = 3;

/// Open ground with scattered rocks.
fn fields(width: u32, height: u32, seed: u64) -> BitGrid {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut rocks = BitGrid::new(width, height);
    if width == 0 || height == 0 {
        return rocks;
    }
    for _ in 0..u64::from(width) * u64::from(height) / TILES_A_ROCK {
        let (x, y) = (random.random_range(0..width), random.random_range(0..height));
        // Two arms that cross at the first tile.
        rocks.fill(y, x..x.saturating_add(random.random_range(1..=LONGEST_ROCK)));
        for above in 1..random.random_range(1..=LONGEST_ROCK) {
            rocks.set(x, y.saturating_add(above), true);
        }
    }
    rocks
}

#[cfg(test)]
mod tests;
