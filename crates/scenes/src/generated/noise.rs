//! Smooth random functions of space.

use glam::Vec3;

use crate::random::Dice;

/// Values along each side of the lattice; it repeats beyond.
const SIDE: usize = 16;

/// Goes smoothly between random values from -1 to 1 at points with whole coordinates.
pub(super) struct Noise(Vec<f32>);

impl Noise {
    pub(super) fn new(dice: &mut Dice) -> Self {
        Self((0..SIDE.pow(3)).map(|_| dice.range(-1.0, 1.0)).collect())
    }

    pub(super) fn at(&self, p: Vec3) -> f32 {
        let (cell, t) = (p.floor(), p - p.floor());
        let t = t * t * (3.0 - 2.0 * t);
        let corner = |i: usize| {
            let step = Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
            let [x, y, z] = (cell + step).to_array().map(|c| c.rem_euclid(SIDE as f32) as usize % SIDE);
            self.0[(z * SIDE + y) * SIDE + x]
        };
        let along_x = |i: usize| corner(i) + (corner(i + 1) - corner(i)) * t.x;
        let along_y = |i: usize| along_x(i) + (along_x(i + 2) - along_x(i)) * t.y;
        along_y(0) + (along_y(4) - along_y(0)) * t.z
    }
}
