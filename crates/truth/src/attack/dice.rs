//! Where the choices of an attack come from: a seeded generator, or the bytes of a fuzzer.

use glam::{DQuat, DVec3, Quat, Vec3};

use crate::places::settled;

/// Makes choices, the same ones for the same seed or bytes.
#[derive(Debug, Clone)]
pub enum Dice<'a> {
    /// Numbers without end, from a seed (splitmix64, Steele et al. 2014).
    Numbers(u64),
    /// Bytes; zeros once they are used up.
    Bytes(&'a [u8]),
}

impl Dice<'_> {
    /// The choices of a seed; close seeds give choices that have nothing to do with each other.
    pub fn new(seed: u64) -> Self {
        Self::Numbers(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5851_f42d_4c95_7f2d)
    }

    pub fn is_over(&self) -> bool {
        matches!(self, Self::Bytes([]))
    }

    /// A number of as many bytes as asked for, up to 4.
    fn next(&mut self, bytes: usize) -> u32 {
        match self {
            Self::Numbers(state) => {
                *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
                let z = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
                let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
                ((z ^ (z >> 31)) >> 32) as u32 >> (32 - 8 * bytes)
            }
            Self::Bytes(rest) => {
                let (now, later) = rest.split_at(bytes.min(rest.len()));
                *rest = later;
                now.iter().fold(0, |sum, &b| sum << 8 | u32::from(b))
            }
        }
    }

    /// A number below `n`, which is at most 2^16.
    pub fn below(&mut self, n: u32) -> u32 {
        let bytes = if n <= 256 { 1 } else { 2 };
        // A byte alone would prefer the first few of many numbers; four bytes cost a seeded
        // generator no more.
        let bytes = if matches!(self, Self::Numbers(_)) { 4 } else { bytes };
        self.next(bytes) % n.max(1)
    }

    /// A number from 0 to 1.
    pub fn unit(&mut self) -> f32 {
        self.next(2) as f32 / 65535.0
    }

    /// A number from 0 to less than 1, in steps of 2^-32.
    pub fn real(&mut self) -> f64 {
        f64::from(self.next(4)) / 4_294_967_296.0
    }

    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// A point near another, with half of its coordinates on a lattice: see [`crate::places`].
    pub fn settled(&mut self, at: Vec3, step: f32) -> Vec3 {
        Vec3::from_array(at.to_array().map(|at| settled(f64::from(self.unit()), at, step)))
    }

    /// True once in `n` times.
    pub fn once_in(&mut self, n: u32) -> bool {
        // Used-up bytes choose the common case.
        self.below(n) == n - 1
    }

    pub fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len() as u32) as usize]
    }

    /// A number that seeds other dice.
    pub fn seed(&mut self) -> u32 {
        self.next(4)
    }
}

/// A direction, of length 1; often along an axis or across one.
pub fn direction(dice: &mut Dice) -> Vec3 {
    let v = Vec3::new(dice.unit(), dice.unit(), dice.unit()) * 2.0 - 1.0;
    dice.settled(v, 1.0).normalize_or(Vec3::X)
}

/// A rotation; often about an axis, sometimes none.
pub fn turn(dice: &mut Dice) -> Quat {
    match dice.below(5) {
        0 => Quat::IDENTITY,
        1 => Quat::from_rotation_y(dice.between(0.0, 6.3)),
        _ => Quat::from_axis_angle(direction(dice), dice.between(0.0, 6.3)),
    }
}

/// A direction to which an eye goes: along an axis, a diagonal, or any.
pub fn way(dice: &mut Dice) -> DVec3 {
    match dice.below(4) {
        0 => DVec3::AXES[dice.below(3) as usize] * dice.pick(&[1.0, -1.0]),
        1 => DVec3::from_array(std::array::from_fn(|_| dice.pick(&[1.0, -1.0]))).normalize(),
        _ => direction(dice).as_dvec3().normalize(),
    }
}

/// A turn by an angle about any axis, or about one of the world.
pub fn turned(dice: &mut Dice, angle: f64) -> DQuat {
    DQuat::from_axis_angle(way(dice), angle)
}
