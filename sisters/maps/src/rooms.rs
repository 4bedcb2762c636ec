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

/// Free tiles between walls: columns `x..x + width` and rows `y..y + height`.
struct Rectangle {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
}

struct Builder {
    plan: Drawing,
    random: Pcg64Mcg,
}

impl Drawing {
    /// A floor plan from a seed: rooms and corridors between walls of one tile, with doors of one
    /// tile. One seed always gives the same.
    pub fn rooms(width: u32, height: u32, seed: u64) -> Self {
        let mut walls = BitGrid::new(width, height);
        for y in 0..height {
            walls.set(0, y, true);
            walls.set(width.wrapping_sub(1), y, true);
        }
        walls.fill(0, 0..width);
        walls.fill(height.wrapping_sub(1), 0..width);
        let random = Pcg64Mcg::seed_from_u64(seed);
        let mut builder = Builder { plan: Drawing { walls, ..Drawing::default() }, random };
        let inner = |size: u32| size.saturating_sub(2);
        let mut open = vec![Rectangle { x: 1, y: 1, width: inner(width), height: inner(height) }];
        while let Some(rectangle) = open.pop() {
            builder.split(&rectangle, &mut open);
        }
        builder.plan
    }
}

impl Builder {
    /// Splits a rectangle, across its longer side, if that is long enough.
    fn split(&mut self, rectangle: &Rectangle, open: &mut Vec<Rectangle>) {
        let across = rectangle.width >= rectangle.height;
        let (length, breadth) = match across {
            true => (rectangle.width, rectangle.height),
            false => (rectangle.height, rectangle.width),
        };
        if length <= LONGEST || breadth < SHORTEST {
            return;
        }
        let corridor = length > CORRIDOR;
        let taken = if corridor { CORRIDOR_WIDTH + 2 } else { 1 };
        let Some(at) = self.free_place(rectangle, across, length, taken) else { return };
        self.wall(rectangle, across, at);
        let part = |start: u32, size: u32| match across {
            true => Rectangle { x: rectangle.x + start, width: size, ..*rectangle },
            false => Rectangle { y: rectangle.y + start, height: size, ..*rectangle },
        };
        if corridor {
            self.wall(rectangle, across, at + taken - 1);
        }
        open.push(part(0, at));
        open.push(part(at + taken, length - at - taken));
    }

    /// A place for walls that meets no door at its ends.
    fn free_place(&mut self, rectangle: &Rectangle, across: bool, length: u32, taken: u32) -> Option<u32> {
        let last = (length - taken).checked_sub(SHORTEST).filter(|&last| last >= SHORTEST)?;
        let walls = &self.plan.walls;
        let ends_at_walls = |at: u32| match across {
            true => {
                let x = rectangle.x + at;
                walls.get(x, rectangle.y - 1) && walls.get(x, rectangle.y + rectangle.height)
            }
            false => {
                let y = rectangle.y + at;
                walls.get(rectangle.x - 1, y) && walls.get(rectangle.x + rectangle.width, y)
            }
        };
        (0..TRIES)
            .map(|_| self.random.random_range(SHORTEST..=last))
            .find(|&at| ends_at_walls(at) && ends_at_walls(at + taken - 1))
    }

    /// A wall through a rectangle, with doors.
    fn wall(&mut self, rectangle: &Rectangle, across: bool, at: u32) {
        let breadth = if across { rectangle.height } else { rectangle.width };
        let tile = |along: u32| match across {
            true => (rectangle.x + at, rectangle.y + along),
            false => (rectangle.x + along, rectangle.y + at),
        };
        for (x, y) in (0..breadth).map(tile) {
            self.plan.walls.set(x, y, true);
        }
        for _ in 0..(breadth / DOOR_EVERY).max(1) {
            let (x, y) = tile(self.random.random_range(0..breadth));
            let walls = &mut self.plan.walls;
            // Doors stand apart.
            let aside = if across { [(x, y - 1), (x, y + 1)] } else { [(x - 1, y), (x + 1, y)] };
            if walls.get(x, y) && aside.into_iter().all(|(x, y)| walls.get(x, y)) {
                walls.set(x, y, false);
                self.plan.doors.push((x, y));
            }
        }
    }
}
