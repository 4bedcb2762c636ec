//! One wall in the middle of an arena, which most cases of awkward shapes change.

use glam::{Quat, Vec3};

use super::case::{ASPECT, Case, block, box_mesh, dice, glass, mesh, placed, solid, sphere, still};
use crate::experiments::{Lab, LabError};
use casca_scenes::random::Dice;
use casca_scenes::world::{Camera, Object, Shape};

/// Of the grid, in metres.
pub(super) const CELL: f32 = 0.5;
/// The front of the wall lies on this plane, 10 m before the eye and on a plane between cells.
pub(super) const FRONT: f32 = -10.0;
/// Half of the wall's width and height.
pub(super) const HALF: Vec3 = Vec3::new(6.0, 4.0, 0.0);
/// The corners of the arena.
pub(super) const ARENA: [Vec3; 2] = [Vec3::new(-14.0, -14.0, -26.0), Vec3::new(14.0, 14.0, 4.0)];

/// What every arena has: objects behind the wall and around it, and cameras that sway before it.
pub(super) struct Arena<'a> {
    pub(super) lab: &'a Lab<'a>,
    pub(super) cameras: Vec<Camera>,
    crowd: Vec<Object>,
}

/// A box of the wall: `x` and `y` as shares of its half sizes, and its thickness.
pub(super) fn brick(x: (f32, f32), y: (f32, f32), thickness: f32) -> Shape {
    block(
        Vec3::new(x.0 * HALF.x, y.0 * HALF.y, FRONT - thickness),
        Vec3::new(x.1 * HALF.x, y.1 * HALF.y, FRONT),
    )
}

pub(super) fn wall(thickness: f32) -> Shape {
    brick((-1.0, 1.0), (-1.0, 1.0), thickness)
}

/// A flat mesh in the wall's plane, of `n` by `m` quadrilaterals; `keep` chooses among them.
pub(super) fn sheet(n: u32, m: u32, mut keep: impl FnMut(u32, u32) -> bool) -> Shape {
    let at = |i: u32, j: u32| {
        let share = |k: u32, of: u32| 2.0 * k as f32 / of as f32 - 1.0;
        Vec3::new(share(i, n) * HALF.x, share(j, m) * HALF.y, FRONT)
    };
    let positions = (0..=m).flat_map(|j| (0..=n).map(move |i| at(i, j))).collect();
    let mut triangles = Vec::new();
    for j in 0..m {
        for i in 0..n {
            if keep(i, j) {
                let a = j * (n + 1) + i;
                let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    mesh(positions, triangles)
}

impl<'a> Arena<'a> {
    pub(super) fn new(lab: &'a Lab) -> Self {
        let mut dice = dice(lab.seed, 5);
        let base = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, 70.0, ASPECT, 0.1, 100.0);
        let cameras = (0..lab.pick(8, 3)).map(|_| {
            let turn = Quat::from_scaled_axis(dice.ball() * 0.15);
            placed(&base, dice.ball() * Vec3::new(2.0, 1.0, 0.4), turn)
        });
        let cameras = cameras.collect();
        let mut crowd = Vec::new();
        for i in 0..lab.pick(500, 250) {
            let (lo, hi) = (Vec3::new(-13.0, -13.0, -25.0), Vec3::new(13.0, 13.0, -12.5));
            let (at, size) = (dice.point(lo, hi), dice.range(0.05, 0.35));
            let shape = match i % 3 {
                0 => block(at - size, at + size),
                1 => box_mesh(at - size, at + size),
                _ => sphere(at, size),
            };
            crowd.push(if i % 4 == 0 { glass("crowd", shape) } else { solid("crowd", shape) });
        }
        Self { lab, cameras, crowd }
    }

    /// The arena with these objects before its own.
    pub(super) fn with(&self, name: &str, mut objects: Vec<Object>) -> Result<Case, LabError> {
        objects.extend(self.crowd.iter().cloned());
        Ok(Case::new(name, objects, CELL, still(self.cameras.iter().copied())))
    }

    /// The arena with each of these as its wall.
    pub(super) fn walls(
        &self,
        walls: impl IntoIterator<Item = (&'static str, Shape)>,
    ) -> Result<Vec<Case>, LabError> {
        walls.into_iter().map(|(name, wall)| self.with(name, vec![solid("wall", wall)])).collect()
    }

    pub(super) fn dice(&self, case: u64) -> Dice {
        dice(self.lab.seed, case)
    }
}
