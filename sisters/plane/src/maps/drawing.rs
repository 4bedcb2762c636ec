//! Maps that are drawn with letters.

use crate::bits::BitGrid;

/// The drawing of a harbour, 72 by 36 tiles, with a customs house, a tower, warehouses and
/// containers.
pub const HARBOUR: &str = include_str!("../../maps/harbour.txt");

/// A map read from a drawing: a letter for each tile, row 0 first.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Drawing {
    /// The tiles `#`. Those of doors are clear.
    pub walls: BitGrid,
    /// The tiles `+`.
    pub doors: Vec<(u32, u32)>,
    /// The tiles `g`, where guards begin.
    pub guards: Vec<(u32, u32)>,
    /// The first tile `@`, where a walk begins.
    pub start: Option<(u32, u32)>,
    /// What was passed over in the file, if it is from one.
    pub warnings: Vec<String>,
}

impl Drawing {
    /// Reads a drawing. All other letters are free ground, and short lines end with it.
    pub fn read(text: &str) -> Self {
        let width = text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
        let height = text.lines().count();
        let mut drawing = Self { walls: BitGrid::new(width as u32, height as u32), ..Self::default() };
        for (line, y) in text.lines().zip(0..) {
            for (letter, x) in line.chars().zip(0..) {
                match letter {
                    '#' => drawing.walls.set(x, y, true),
                    '+' => drawing.doors.push((x, y)),
                    'g' => drawing.guards.push((x, y)),
                    '@' => drawing.start = drawing.start.or(Some((x, y))),
                    _ => {}
                }
            }
        }
        drawing
    }
}
