//! A house of rooms with a set of lines in each: most lines are behind walls.

use glam::{Vec3, vec3};

use crate::sets::generate::{Family, Recipe};
use crate::sets::{LineError, LineSet, MOST_VERTICES};

/// The side of a room. Generated sets have a side of 2.
pub const ROOM: f32 = 2.6;
/// The height of walls above the middle and below it.
const HALF_HEIGHT: f32 = 1.2;
/// Half the thickness of a wall.
const HALF_THICK: f32 = 0.05;
/// Half the width of a door.
const HALF_DOOR: f32 = 0.35;
/// The sets of rooms, in turn.
const FAMILIES: [Family; 5] =
    [Family::Spiral, Family::PomPom, Family::Dipole, Family::Abc, Family::Reservoir];

/// Lines and walls.
#[derive(Debug, Clone)]
pub struct House {
    /// The lines of all rooms, room by room.
    pub lines: LineSet,
    /// The least and the greatest corner of each wall, and of the floor.
    pub walls: Vec<[Vec3; 2]>,
    /// The number of rooms along a side.
    pub side: u32,
}

impl House {
    /// `side` times `side` rooms with `lines` lines each, at a time in seconds. There is a door in
    /// the middle of each wall between two rooms.
    ///
    /// # Errors
    /// As [`Recipe::make`]. A room without lines counts as one with a line.
    pub fn new(side: u32, lines: u32, seed: u64, time: f64) -> Result<Self, LineError> {
        let vertices = FAMILIES.map(|family| family.usual().1).into_iter().max().unwrap_or(1);
        // Rooms without lines count as well: their walls take memory, too.
        let most = u128::from(side).pow(2) * u128::from(lines.max(1)) * u128::from(vertices);
        if most > MOST_VERTICES as u128 {
            return Err(LineError::TooMany);
        }
        let mut all = LineSet::default();
        for room in 0..side * side {
            let family = FAMILIES[room as usize % FAMILIES.len()];
            let recipe = Recipe::new(family, seed.wrapping_add(u64::from(room)));
            let middle = middle_of(side, room);
            for line in (Recipe { lines, time, ..recipe }).make()?.iter() {
                all.push(line.iter().map(|&p| p + middle))?;
            }
        }
        Ok(Self { lines: all, walls: walls(side), side })
    }

    /// An eye near a corner of a room, and a place in the room that it looks at.
    pub fn eye(&self, room: u32) -> [Vec3; 2] {
        let middle = middle_of(self.side, room);
        let corner = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)][room as usize % 4];
        let aside = 0.42 * ROOM;
        [middle + vec3(corner.0 * aside, 0.3, corner.1 * aside), middle]
    }
}

fn middle_of(side: u32, room: u32) -> Vec3 {
    let at = |i: u32| (i as f32 + 0.5 - side as f32 * 0.5) * ROOM;
    vec3(at(room % side.max(1)), 0.0, at(room / side.max(1)))
}

fn walls(side: u32) -> Vec<[Vec3; 2]> {
    let half = side as f32 * ROOM * 0.5;
    let floor = [vec3(-half, -HALF_HEIGHT - 0.1, -half), vec3(half, -HALF_HEIGHT, half)];
    let mut walls = vec![floor];
    for i in 0..=side {
        let across = i as f32 * ROOM - half;
        for j in 0..side {
            let (from, to) = (j as f32 * ROOM - half, (j + 1) as f32 * ROOM - half);
            let middle = (from + to) * 0.5;
            let parts = match i == 0 || i == side {
                true => vec![(from, to)],
                false => vec![(from, middle - HALF_DOOR), (middle + HALF_DOOR, to)],
            };
            for (from, to) in parts {
                let (low, high) = (across - HALF_THICK, across + HALF_THICK);
                walls.push([vec3(low, -HALF_HEIGHT, from), vec3(high, HALF_HEIGHT, to)]);
                walls.push([vec3(from, -HALF_HEIGHT, low), vec3(to, HALF_HEIGHT, high)]);
            }
        }
    }
    walls
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn houses_that_are_too_large_are_refused_even_without_lines() {
        assert!(matches!(House::new(70_000, 0, 1, 0.0), Err(LineError::TooMany)));
        let house = House::new(2, 0, 1, 0.0).unwrap();
        assert!(house.lines.is_empty() && !house.walls.is_empty());
        assert_eq!(House::new(2, 3, 1, 0.0).unwrap().lines.len(), 12);
    }
}
