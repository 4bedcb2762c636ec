//! Objects by chance: walls, and what moves behind their borders.

use glam::{Affine3A, Vec3};

use super::super::dice::turn;
use super::super::forms::{BASES, Form, skew};
use super::super::ops::{Hides, Moves, Op};
use super::Maker;

impl Maker<'_> {
    pub(super) fn wall(&mut self) -> Op {
        let (size, min) = (self.config.size(), self.config.min);
        let axis = self.dice.below(3) as usize;
        let mut low = Vec3::ZERO;
        let mut high = size;
        for i in 0..3 {
            if i == axis {
                low[i] = size[i] * self.dice.between(0.3, 0.65);
                high[i] = low[i] + self.config.cell * self.dice.between(0.6, 4.0);
            } else if self.dice.once_in(2) {
                low[i] = size[i] * self.dice.between(-0.05, 0.4);
                high[i] = size[i] * self.dice.between(0.6, 1.05);
            }
        }
        let (config, dice) = (&self.config, &mut self.dice);
        let (low, mut high) = (config.settled(dice, min + low), config.settled(dice, min + high));
        if low[axis] >= high[axis] {
            high[axis] = config.snap(low + config.cell)[axis];
        }
        self.walls.push((low, high));
        let (center, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let form = match self.dice.below(8) {
            0 => Form::Turned { center, half, turn: turn(&mut self.dice) },
            1 => Form::Placed {
                base: self.dice.pick(&[0, 0, 5]),
                transform: Affine3A::from_scale_rotation_translation(half, glam::Quat::IDENTITY, center),
            },
            2 => Form::Mesh { base: 0, center, scale: half },
            _ => Form::Block { min: low, max: high },
        };
        let moves = self.dice.pick(&[Moves::Fixed, Moves::Fixed, Moves::Fixed, Moves::Free]);
        let hides = if self.dice.once_in(6) { Hides::Inner(3, self.dice.seed()) } else { Hides::Itself };
        Op::Insert { name: self.name(), form, hides, moves }
    }

    pub(super) fn insert(&mut self) -> Op {
        if self.dice.once_in(24) {
            return self.wall();
        }
        let form = self.form();
        let hides = self.hides();
        let speed = self.config.cell * self.dice.pick(&[0.0, 0.2, 1.0, 1.0, 4.0, 30.0]);
        let moves = match self.dice.below(13) {
            0 | 1 => Moves::Fixed,
            2 | 3 => Moves::Free,
            4 | 5 => Moves::Within(speed),
            6 if self.dice.once_in(8) => Moves::FixedWithin(speed),
            _ => Moves::OnExpiry(speed),
        };
        Op::Insert { name: self.name(), form, hides, moves }
    }

    pub(super) fn hides(&mut self) -> Hides {
        match self.dice.below(10) {
            0..=4 => Hides::Nothing,
            5..=7 => Hides::Itself,
            _ => Hides::Inner(self.dice.below(6) as u8, self.dice.seed()),
        }
    }

    /// A place: mostly beyond a wall's border, where things come into sight.
    pub(super) fn place(&mut self) -> Vec3 {
        if self.dice.once_in(48) {
            return self.beyond();
        }
        let (min, size, cell) = (self.config.min, self.config.size(), self.config.cell);
        let p = match self.dice.below(16) {
            0..=3 if !self.walls.is_empty() => self.in_shadow(),
            0..=6 => {
                let (low, high) = match self.walls.len() as u32 {
                    0 => (min + size * 0.3, min + size * 0.7),
                    n => self.walls[self.dice.below(n) as usize],
                };
                let axis = (high - low).min_position();
                let edge = (axis + 1 + self.dice.below(2) as usize) % 3;
                let mut p =
                    low + (high - low) * Vec3::new(self.dice.unit(), self.dice.unit(), self.dice.unit());
                let away = cell * self.dice.between(0.3, 5.0);
                p[axis] = if self.dice.once_in(2) { low[axis] - away } else { high[axis] + away };
                let end = if self.dice.once_in(2) { low[edge] } else { high[edge] };
                p[edge] = end + cell * self.dice.between(-2.5, 2.5);
                p
            }
            7..=11 => self.config.inside(&mut self.dice),
            // A corner of cells.
            12 | 13 => min + ((self.config.inside(&mut self.dice) - min) / cell).floor() * cell,
            // On the floor.
            14 => self.config.inside(&mut self.dice).with_y(min.y + cell * self.dice.pick(&[0.5, 0.25])),
            _ => {
                let share = Vec3::new(self.dice.unit(), self.dice.unit(), self.dice.unit());
                min + size * (share * 2.0 - 0.5)
            }
        };
        self.config.settled(&mut self.dice, p)
    }

    /// A place far beyond the grid, on any side.
    pub(super) fn beyond(&mut self) -> Vec3 {
        let far = self.dice.pick(&[1e5, 3e9, 1e12, 1e18]);
        let mut away = || far * self.dice.pick(&[0.0, 1.0, -1.0]);
        let away = Vec3::new(away(), away(), away());
        self.config.inside(&mut self.dice) + away
    }

    /// Behind an edge of a wall, for the first camera: little out of its sight.
    pub(super) fn in_shadow(&mut self) -> Vec3 {
        let (low, high) = self.walls[self.dice.below(self.walls.len() as u32) as usize];
        let free = self.dice.below(3) as usize;
        let mut edge = Vec3::ZERO;
        for i in 0..3 {
            let share = if i == free { self.dice.unit() } else { self.dice.below(2) as f32 };
            edge[i] = low[i] + (high[i] - low[i]) * share;
        }
        let inwards = ((low + high) * 0.5 - edge).normalize_or(Vec3::X);
        let onwards = (edge - self.config.cameras[0]).normalize_or(Vec3::X);
        let (behind, aside) = (self.dice.between(0.3, 6.0), self.dice.between(-0.2, 2.5));
        edge + (onwards * behind + inwards * aside) * self.config.cell
    }

    pub(super) fn form(&mut self) -> Form {
        let center = self.place();
        let cell = self.config.cell;
        let size = cell
            * match self.dice.below(24) {
                0 => 0.0,
                1 => 0.02,
                2 => self.dice.between(4.0, 12.0),
                3 if self.dice.once_in(8) => 60.0,
                4..=9 => self.dice.pick(&[0.25, 0.5]),
                _ => self.dice.between(0.1, 1.5),
            };
        let mut side = || size * self.dice.between(0.3, 1.0);
        let half = Vec3::new(side(), side(), side());
        // Some have no height, and some faces touch others.
        let half = self.config.snap(self.dice.settled(half, cell * 0.5));
        match self.dice.below(16) {
            0..=5 => Form::Ball { center, radius: half.x },
            6..=10 => Form::Block { min: center - half, max: center + half },
            11 | 12 => Form::Turned { center, half, turn: turn(&mut self.dice) },
            13 if self.dice.once_in(4) => {
                Form::Mesh { base: self.dice.below(u32::from(BASES)) as u8, center, scale: half }
            }
            _ => {
                let signs =
                    Vec3::new(self.dice.pick(&[1.0, -1.0]), 1.0, self.dice.pick(&[1.0, 1.0, -1.0, 0.0]));
                let shear = self.dice.pick(&[0.0, 0.0, 0.5, 2.0]);
                let matrix = skew(turn(&mut self.dice), half * signs, shear);
                let base = self.dice.below(u32::from(BASES)) as u8;
                Form::Placed { base, transform: Affine3A::from_mat3_translation(matrix, center) }
            }
        }
    }
}
