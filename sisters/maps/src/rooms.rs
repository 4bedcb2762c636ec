//! Floor plans: a rectangle is split by walls and corridors until rooms are left.

use casca_plane::BitGrid;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::Drawing;

/// Rooms that are longer are split.
const LONGEST: u32 = 14;
/// No side of a room gets shorter than this.
const SHORTEST: u32 = 4;
/// Rectangles that are longer are split by a corridor instead of a wall.
const CORRIDOR: u32 = 40;
/// The width of corridors.
const CORRIDOR_WIDTH: u32 = 2;
/// A wall has a door for so many tiles, at least one.
const DOOR_EVERY: u32 = 18;
/// So many places are tried for a wall that ends at no door.
const TRIES: u32 = 8;

/// Free tiles between walls: the first of them, and how many along each axis.
struct Rectangle {
    first: [u32; 2],
    size: [u32; 2],
}

impl Drawing {
    /// A floor plan from a seed: rooms and corridors between walls of one tile, with doors of one
    /// tile. One seed always gives the same.
    pub fn rooms(width: u32, height: u32, seed: u64) -> Self {
        let mut plan = Self { walls: BitGrid::new(width, height), ..Self::default() };
        for y in 0..height {
            plan.walls.set(0, y, true);
            plan.walls.set(width.wrapping_sub(1), y, true);
        }
        plan.walls.fill(0, 0..width);
        plan.walls.fill(height.wrapping_sub(1), 0..width);
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let inner = |size: u32| size.saturating_sub(2);
        let mut open = vec![Rectangle { first: [1, 1], size: [inner(width), inner(height)] }];
        while let Some(Rectangle { first, size }) = open.pop() {
            // It is split across its longer side.
            let along = usize::from(size[0] < size[1]);
            let (length, breadth) = (size[along], size[1 - along]);
            if length <= LONGEST || breadth < SHORTEST {
                continue;
            }
            let tile = |at: u32, across: u32| match along {
                0 => (first[0] + at, first[1].wrapping_add(across)),
                _ => (first[0].wrapping_add(across), first[1] + at),
            };
            let is_wall = |walls: &BitGrid, (x, y)| walls.get(x, y);
            // A place for one wall, or for the two of a corridor, that meets no door at its ends.
            let taken = if length > CORRIDOR { CORRIDOR_WIDTH + 2 } else { 1 };
            let last = (length - taken).checked_sub(SHORTEST).filter(|&last| last >= SHORTEST);
            let Some(last) = last else { continue };
            let ends = |at: u32| [tile(at, u32::MAX), tile(at, breadth)];
            let ends_at_walls = |at: u32| ends(at).into_iter().all(|end| is_wall(&plan.walls, end));
            let mut places = (0..TRIES).map(|_| random.random_range(SHORTEST..=last));
            let place = places.find(|&at| ends_at_walls(at) && ends_at_walls(at + taken - 1));
            let Some(at) = place else { continue };
            for at in [at, at + taken - 1].into_iter().take(taken.min(2) as usize) {
                (0..breadth).map(|across| tile(at, across)).for_each(|(x, y)| plan.walls.set(x, y, true));
                for _ in 0..(breadth / DOOR_EVERY).max(1) {
                    let across = random.random_range(0..breadth);
                    // Doors stand apart.
                    let beside = [across.wrapping_sub(1), across, across + 1];
                    if beside.into_iter().all(|across| is_wall(&plan.walls, tile(at, across))) {
                        let (x, y) = tile(at, across);
                        plan.walls.set(x, y, false);
                        plan.doors.push((x, y));
                    }
                }
            }
            for (start, length) in [(0, at), (at + taken, length - at - taken)] {
                let (mut first, mut size) = (first, size);
                (first[along], size[along]) = (first[along] + start, length);
                open.push(Rectangle { first, size });
            }
        }
        plan
    }
}
