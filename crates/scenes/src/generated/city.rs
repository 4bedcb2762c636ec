//! A town of square blocks: buildings around courtyards, streets with cars,
//! and thousands of small things.

use std::f32::consts::TAU;

use glam::Vec3;

use super::motion::{Moving, Path, Walk, Way};
use super::options::SceneOptions;
use super::parts::{object, solid_box, standing_box};
use crate::random::Dice;
use crate::world::{Object, Shape, World};

pub(super) const SIZE: f32 = 200.0;
const HEIGHT: f32 = 40.0;
/// A street and the block beside it.
pub(super) const PITCH: f32 = 40.0;
pub(super) const STREET: f32 = 12.0;
pub(super) const BLOCKS: usize = 5;
const SMALL: f32 = 3000.0;
const CARS: usize = 60;
/// Top of the ground.
pub(super) const GROUND: f32 = 1.0;

/// A walk along the middle of streets, turning sharply enough to stay on them.
pub(super) fn path() -> Path {
    let street = |i: usize| i as f32 * PITCH + STREET * 0.5;
    let stops = [(0, 0), (2, 0), (2, 2), (1, 2), (1, 4), (3, 4), (3, 1), (4, 1)];
    let at = |(x, z): (usize, usize)| Vec3::new(street(x), GROUND + 1.7, street(z));
    Path::close_to(&stops.map(at), 4.0)
}

/// Buildings around courtyards, and open squares.
fn blocks(dice: &mut Dice, objects: &mut Vec<Object>) {
    for bz in 0..BLOCKS {
        for bx in 0..BLOCKS {
            let corner = Vec3::new(bx as f32 * PITCH + STREET, GROUND, bz as f32 * PITCH + STREET);
            if dice.chance(0.1) {
                continue; // An open square.
            }
            // Four wings around a courtyard: north, south, west, east.
            let wings = [
                (0.0, 0.0, 28.0, 9.0),
                (0.0, 19.0, 28.0, 9.0),
                (0.0, 9.0, 9.0, 10.0),
                (19.0, 9.0, 9.0, 10.0),
            ];
            for (x, z, w, d) in wings {
                let height = dice.range(8.0, 26.0).round();
                let min = corner + Vec3::new(x, 0.0, z);
                objects.push(solid_box("building", min, min + Vec3::new(w, height, d)));
                if dice.chance(0.4) {
                    let roof = min + Vec3::new(1.5, height, 1.5);
                    let size = Vec3::new(w - 3.0, dice.range(2.0, 6.0), d - 3.0);
                    objects.push(solid_box("roof storey", roof, roof + size));
                }
            }
        }
    }
}

/// Small things in courtyards and on pavements.
fn small_things(dice: &mut Dice, count: usize, objects: &mut Vec<Object>) {
    for _ in 0..count {
        let size = dice.point(Vec3::splat(0.2), Vec3::splat(1.0));
        let block = Vec3::new(dice.range(0.0, 4.99).floor(), 0.0, dice.range(0.0, 4.99).floor()) * PITCH;
        let base = if dice.chance(0.4) {
            // In a courtyard.
            block + Vec3::new(dice.range(21.6, 30.4), GROUND, dice.range(21.6, 30.4))
        } else {
            // On a pavement, along x or along z.
            let across = if dice.chance(0.5) { dice.range(0.6, 1.9) } else { dice.range(10.1, 11.4) };
            let along = dice.range(STREET + 0.6, PITCH - 0.6);
            let (x, z) = if dice.chance(0.5) { (across, along) } else { (along, across) };
            block + Vec3::new(x, GROUND, z)
        };
        if dice.chance(0.3) {
            let radius = size.x * 0.5;
            objects.push(object("ball", Shape::Sphere { center: base + Vec3::Y * radius, radius }));
        } else {
            objects.push(standing_box("crate", base, size));
        }
    }
}

/// Cars, each of which goes to and fro on its lane between two crossings.
fn cars(dice: &mut Dice, objects: &mut Vec<Object>) -> Vec<Moving> {
    let mut moving = Vec::new();
    for i in 0..CARS {
        let lane = if i % 2 == 0 { 3.9 } else { 8.1 };
        let across = dice.range(0.0, 4.99).floor() * PITCH + lane;
        let start = dice.range(0.0, 4.99).floor() * PITCH + STREET + 2.5;
        let way = PITCH - STREET - 5.0;
        let along_x = dice.chance(0.5);
        let (base, size, way) = if along_x {
            (Vec3::new(start, GROUND + 0.2, across), Vec3::new(4.2, 1.4, 1.8), Vec3::X * way)
        } else {
            (Vec3::new(across, GROUND + 0.2, start), Vec3::new(1.8, 1.4, 4.2), Vec3::Z * way)
        };
        objects.push(standing_box("car", base, size));
        let (rate, phase) = (dice.range(0.3, 1.0), dice.range(0.0, TAU));
        moving.push(Moving::last(objects, Way::Slide { way, rate, phase }));
    }
    moving
}

pub(super) fn build(options: &SceneOptions) -> World {
    let mut dice = Dice::new(options.seed, 2);
    let mut objects = vec![solid_box("ground", Vec3::ZERO, Vec3::new(SIZE, GROUND, SIZE))];
    blocks(&mut dice, &mut objects);
    small_things(&mut dice, (SMALL * options.scale) as usize, &mut objects);
    let moving = cars(&mut dice, &mut objects);
    let walk = Walk { moving, glance: 0.5, ..Walk::along(path(), options) };
    walk.through("city", objects, [Vec3::ZERO, Vec3::new(SIZE, HEIGHT, SIZE)], 1.0)
}
