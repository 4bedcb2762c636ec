//! The surface that belongs to a generated set: what its lines lie on or grow from.

use std::f32::consts::{PI, TAU};

use glam::{DVec2, Vec3};

use crate::mesh::Mesh;
use crate::sets::generate::{Family, Recipe, ground};

/// Squares along a side of the ground, and rings of a ball; a ball has twice as many sides.
const STEPS: u32 = 96;
/// The layer of the ground that is the surface, as the layers of lines.
const LAYER: f64 = 0.5;
/// How far the ground lies below the lines of its layer.
const BELOW: f64 = 0.012;
/// The radius of the ball that hair grows from, a little below the roots.
const BALL: f32 = 0.295;

impl Recipe {
    /// The surface of the set at its time, open or closed: of a reservoir the ground below the
    /// upper half of its layers, of a ball of hair the ball. Others have none.
    pub fn surface(&self) -> Option<Mesh> {
        let time = if self.time.is_finite() { self.time } else { 0.0 };
        match self.family {
            Family::Reservoir => Some(layer(time)),
            Family::PomPom => Some(ball()),
            _ => None,
        }
    }
}

/// Squares over the area of the set.
fn layer(time: f64) -> Mesh {
    let side = STEPS + 1;
    let at = |i: u32| f64::from(i) / f64::from(STEPS) * 2.0 - 1.0;
    let place = |i: u32| {
        let (x, z) = (at(i % side), at(i / side));
        Vec3::new(x as f32, (ground(DVec2::new(x, z), LAYER, time) - BELOW) as f32, z as f32)
    };
    grid([STEPS, STEPS], (0..side * side).map(place).collect())
}

/// Rings of squares from pole to pole; those at the poles have no area on one side.
fn ball() -> Mesh {
    let sides = 2 * STEPS;
    let place = |i: u32| {
        let (ring, side) = (i / (sides + 1), i % (sides + 1));
        // The last corner of a ring is its first one, in every bit.
        let (sine, cosine) = ((side % sides) as f32 / sides as f32 * TAU).sin_cos();
        let (out, up) = (ring as f32 / STEPS as f32 * PI).sin_cos();
        let out = if ring % STEPS == 0 { 0.0 } else { out };
        Vec3::new(out * cosine, up, out * sine) * BALL
    };
    grid([sides, STEPS], (0..(sides + 1) * (STEPS + 1)).map(place).collect())
}

/// Squares between places row by row.
fn grid([columns, rows]: [u32; 2], positions: Vec<Vec3>) -> Mesh {
    let squares = (0..columns * rows).map(|i| {
        let first = i / columns * (columns + 1) + i % columns;
        [first, first + 1, first + columns + 2, first + columns + 1]
    });
    let squares: Vec<[u32; 4]> = squares.collect();
    Mesh::of_polygons(positions, squares.iter().map(|s| &s[..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hair_grows_out_of_its_ball() {
        let recipe = Recipe { lines: 50, ..Recipe::new(Family::PomPom, 2) };
        let (mesh, set) = (recipe.surface().unwrap(), recipe.make().unwrap());
        assert!(mesh.positions.iter().all(|p| (p.length() - BALL).abs() < 1e-6));
        for line in set.iter() {
            assert!((0.0..0.03).contains(&(line[0].length() - BALL)), "{}", line[0].length());
        }
    }

    #[test]
    fn the_ground_lies_just_below_the_lines_of_its_layer_and_moves_with_them() {
        for time in [0.0, 2.0] {
            let recipe = Recipe { lines: 800, time, ..Recipe::new(Family::Reservoir, 2) };
            let (mesh, set) = (recipe.surface().unwrap(), recipe.make().unwrap());
            // The heights of lines above the ground: none within a margin below it, many above.
            let above = |p: &Vec3| {
                let [i, j] = [p.x, p.z].map(|c| ((c + 1.0) / 2.0 * STEPS as f32).round() as usize);
                mesh.positions.get(j * (STEPS as usize + 1) + i).map_or(1.0, |ground| p.y - ground.y)
            };
            let starts: Vec<f32> = set.iter().map(|line| above(&line[0])).collect();
            let on = starts.iter().filter(|h| (0.0..0.06).contains(*h)).count();
            assert!(on > 60, "{time}: {on}");
        }
        assert!(Recipe { time: f64::NAN, ..Recipe::new(Family::Reservoir, 1) }.surface().is_some());
        assert!(Recipe::new(Family::Abc, 1).surface().is_none());
    }
}
