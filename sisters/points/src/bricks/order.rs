//! The order of the points in a brick: every beginning of it is spread over the whole brick.
//!
//! A hierarchy of grids, as in Schütz, Ohrhallinger, Wimmer 2020 ("Fast Out-of-Core Octree
//! Generation for Massive Point Clouds"), but with random points: each occupied cell of the
//! coarsest grid gives one point, then each of the next grid that has given none, and so on.

use super::file::{Brick, BrickPoint, LEVELS};
use crate::numeric::morton;
use casca::Aabb;
use glam::Vec3;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Bits of a coordinate in the codes that bricks are cut by.
pub(super) const BITS: u32 = 21;

/// The cell of a point in a grid of `2^bits` cells along the edge of a cube, in Morton order.
pub(super) fn code(position: Vec3, low: Vec3, edge: f64, bits: u32) -> u64 {
    let cells = f64::from(1_u32 << bits);
    let at = (position.as_dvec3() - low.as_dvec3()) / edge * cells;
    // NaN, as all points of a cube without an edge have it, becomes 0.
    morton(at.to_array().map(|x| x.clamp(0.0, cells - 1.0) as u32))
}

/// Puts the points of a brick, at least one, in order. A point chosen for a cell is also the one
/// chosen in every finer cell that contains it, as it is the least of a random order in each.
pub(super) fn arrange(points: &mut Vec<BrickPoint>, first: u64) -> Brick {
    let low = points.iter().fold(Vec3::INFINITY, |low, p| low.min(p.position));
    let high = points.iter().fold(Vec3::NEG_INFINITY, |high, p| high.max(p.position));
    let mut brick = Brick { bounds: Aabb::new(low, high), counts: [0; LEVELS], first };
    let mut random = Pcg64Mcg::seed_from_u64(first);
    let finest = LEVELS as u32 - 2;
    struct Item {
        code: u64,
        priority: (u32, usize),
        level: usize,
    }
    let edge = brick.edge();
    let item = |(i, p): (usize, &BrickPoint)| Item {
        code: code(p.position, low, edge, finest),
        priority: (random.next_u32(), i),
        level: LEVELS - 1,
    };
    let mut items: Vec<Item> = points.iter().enumerate().map(item).collect();
    items.sort_by_key(|item| item.code);
    for level in 0..=finest {
        let shift = 3 * (finest - level);
        for cell in items.chunk_by_mut(|a, b| a.code >> shift == b.code >> shift) {
            if let Some(least) = cell.iter_mut().min_by_key(|item| item.priority) {
                least.level = least.level.min(level as usize);
            }
        }
    }
    items.sort_unstable_by_key(|item| (item.level, item.priority));
    items.iter().for_each(|item| brick.counts[item.level] += 1);
    for level in 1..LEVELS {
        brick.counts[level] += brick.counts[level - 1];
    }
    *points = items.iter().map(|item| points[item.priority.1]).collect();
    brick
}
