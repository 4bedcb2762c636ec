//! Furniture and small things in rooms.

use std::f32::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::motion::Path;
use super::parts::{beams, object, placed, prism};
use crate::random::Dice;
use crate::world::{Mesh, Object};

/// Pieces of furniture and small things on each storey.
const PIECES: f32 = 45.0;
const SMALL: f32 = 60.0;
/// Height of tables.
const TABLE: f32 = 0.74;
/// Room between things and walls, and between things and the walk.
const WALL: f32 = 0.12;
const OFF: f32 = 0.3;

/// A model of a piece of furniture and how far it reaches from its middle.
struct Model {
    name: &'static str,
    reach: f32,
    mesh: Arc<Mesh>,
}

fn model(name: &'static str, parts: &[([f32; 3], [f32; 3])]) -> Model {
    let mesh = beams(parts);
    let reach = mesh.positions.iter().map(|p| p.x.hypot(p.z)).fold(0.0, f32::max);
    Model { name, reach, mesh: Arc::new(mesh) }
}

fn models() -> [Model; 3] {
    let table = [
        ([-0.7, 0.70, -0.4], [1.4, 0.04, 0.8]),
        ([-0.68, 0.0, -0.38], [0.06, 0.7, 0.06]),
        ([0.62, 0.0, -0.38], [0.06, 0.7, 0.06]),
        ([-0.68, 0.0, 0.32], [0.06, 0.7, 0.06]),
        ([0.62, 0.0, 0.32], [0.06, 0.7, 0.06]),
    ];
    let chair = [
        ([-0.22, 0.43, -0.22], [0.44, 0.04, 0.44]),
        ([-0.22, 0.0, -0.22], [0.04, 0.43, 0.04]),
        ([0.18, 0.0, -0.22], [0.04, 0.43, 0.04]),
        ([-0.22, 0.0, 0.18], [0.04, 0.43, 0.04]),
        ([0.18, 0.0, 0.18], [0.04, 0.43, 0.04]),
        ([-0.22, 0.47, 0.19], [0.44, 0.45, 0.03]),
    ];
    let shelf = [
        ([-0.5, 0.0, -0.17], [0.03, 1.9, 0.34]),
        ([0.47, 0.0, -0.17], [0.03, 1.9, 0.34]),
        ([-0.47, 0.05, 0.16], [0.94, 1.85, 0.01]),
        ([-0.47, 0.05, -0.17], [0.94, 0.03, 0.33]),
        ([-0.47, 0.5, -0.17], [0.94, 0.03, 0.33]),
        ([-0.47, 0.95, -0.17], [0.94, 0.03, 0.33]),
        ([-0.47, 1.4, -0.17], [0.94, 0.03, 0.33]),
        ([-0.47, 1.87, -0.17], [0.94, 0.03, 0.33]),
    ];
    [model("table", &table), model("chair", &chair), model("shelf", &shelf)]
}

/// What furnishes storeys of the same rooms.
pub(super) struct Furniture<'a> {
    /// Least and greatest x, least and greatest z.
    rooms: &'a [[f32; 4]],
    /// Places of the walk, of all storeys, as seen from above.
    walk: Vec<Vec2>,
    models: [Model; 3],
    ball: Arc<Mesh>,
    bottle: Arc<Mesh>,
    book: Arc<Mesh>,
}

impl<'a> Furniture<'a> {
    pub(super) fn new(rooms: &'a [[f32; 4]], path: &Path) -> Self {
        let at = |i: usize| path.at(path.length() * i as f32 / 2000.0);
        Self {
            rooms,
            walk: (0..=2000).map(|i| Vec2::new(at(i).x, at(i).z)).collect(),
            models: models(),
            ball: Arc::new(Mesh::ball(0)),
            bottle: Arc::new(prism(8)),
            book: Arc::new(Mesh::cuboid(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.5, 1.0, 0.5))),
        }
    }

    /// A place in a room and off the walk for something that reaches this far.
    fn pick(&self, dice: &mut Dice, floor: f32, reach: f32) -> Vec3 {
        loop {
            let room = (dice.range(0.0, 1.0) * self.rooms.len() as f32) as usize % self.rooms.len();
            let ([left, right, near, far], off) = (self.rooms[room], reach + WALL);
            let p = Vec2::new(dice.range(left + off, right - off), dice.range(near + off, far - off));
            if self.walk.iter().all(|s| s.distance(p) > reach + OFF) {
                return Vec3::new(p.x, floor, p.y);
            }
        }
    }

    /// Pieces of furniture on a floor, and small things on it and on tables.
    pub(super) fn furnish(&self, dice: &mut Dice, floor: f32, scale: f32, objects: &mut Vec<Object>) {
        let mut tables = Vec::new();
        for _ in 0..(PIECES * scale) as usize {
            let model = &self.models[(dice.range(0.0, 1.0) * 3.0) as usize % 3];
            let at = self.pick(dice, floor, model.reach);
            let turn = dice.range(0.0, 3.99).floor() * FRAC_PI_2 + dice.range(-0.1, 0.1);
            objects.push(object(model.name, placed(&model.mesh, Vec3::ONE, turn, at)));
            if model.name == "table" {
                tables.push(at);
            }
        }
        for _ in 0..(SMALL * scale) as usize {
            let table = (dice.range(0.0, 1.0) * tables.len() as f32) as usize;
            let at = match tables.get(table) {
                Some(&table) if dice.chance(0.6) => {
                    let aside = Vec3::new(0.25, 0.0, 0.25);
                    table + Vec3::Y * TABLE + dice.point(-aside, aside)
                }
                _ => self.pick(dice, floor, 0.2),
            };
            objects.push(self.small_thing(dice, at));
        }
    }

    fn small_thing(&self, dice: &mut Dice, at: Vec3) -> Object {
        let turn = dice.range(0.0, TAU);
        match dice.range(0.0, 3.0) {
            kind if kind < 1.0 => {
                let radius = dice.range(0.05, 0.15);
                object("ball", placed(&self.ball, Vec3::splat(radius), turn, at + Vec3::Y * radius))
            }
            kind if kind < 2.0 => {
                object("bottle", placed(&self.bottle, Vec3::new(0.04, 0.3, 0.04), turn, at))
            }
            _ => {
                let size = Vec3::new(0.2, dice.range(0.02, 0.1), 0.28);
                object("book", placed(&self.book, size, turn, at))
            }
        }
    }
}
