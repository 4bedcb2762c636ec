//! Caves: random rock, smoothed by a cellular automaton.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::bits::BitGrid;

/// The share of rock at the beginning.
const ROCK: f64 = 0.44;
/// How often the rock is smoothed.
const STEPS: u32 = 5;
/// A tile is rock if so many of the nine tiles around it and at it are.
const MAJORITY: u8 = 5;

/// See [`crate::maps::MapKind::Caves`].
pub(super) fn caves(width: u32, height: u32, seed: u64) -> BitGrid {
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
