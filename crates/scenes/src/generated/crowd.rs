//! A hundred thousand people in walled yards, seen through gates from the lanes between.

use glam::Vec3;

use super::motion::{Moving, Path, Walk, Way};
use super::options::SceneOptions;
use super::parts::{object, solid_box, standing_box};
use crate::random::Dice;
use crate::world::{Shape, World};

const SIZE: f32 = 256.0;
const HEIGHT: f32 = 16.0;
const GROUND: f32 = 1.0;
const WALL: f32 = 7.0;
/// A yard with its walls and half of the lanes around it.
const PITCH: f32 = 32.0;
const YARDS: usize = 8;
const PEOPLE: f32 = 100_000.0;
const GATE: f32 = 3.0;

fn path() -> Path {
    let stops = [(0, 0), (3, 0), (3, 3), (1, 3), (1, 6), (5, 6), (5, 2), (7, 2)];
    // Lanes run along multiples of the pitch; those at the border lie half outside.
    let lane = |i: usize| (i as f32 * PITCH).clamp(1.2, SIZE - 1.2);
    let at = |(x, z): (usize, usize)| Vec3::new(lane(x), GROUND + 1.7, lane(z));
    Path::close_to(&stops.map(at), 2.0)
}

pub(super) fn build(options: &SceneOptions) -> World {
    let mut dice = Dice::new(options.seed, 5);
    let mut objects = vec![solid_box("ground", Vec3::ZERO, Vec3::new(SIZE, GROUND, SIZE))];
    for yz in 0..YARDS {
        for yx in 0..YARDS {
            let corner = Vec3::new(yx as f32 * PITCH, GROUND, yz as f32 * PITCH);
            let gate_side = dice.range(0.0, 3.99) as usize;
            let gate_at = dice.range(8.0, 20.0).round();
            for side in 0..4 {
                let (near, along_x) = (side % 2 == 0, side < 2);
                let (a, b) = if near { (2.0, 4.0) } else { (28.0, 30.0) };
                let mut wall = |from: f32, to: f32| {
                    let (lo, hi) = if along_x { ((from, a), (to, b)) } else { ((a, from), (b, to)) };
                    let min = corner + Vec3::new(lo.0, 0.0, lo.1);
                    let max = corner + Vec3::new(hi.0, WALL - GROUND, hi.1);
                    objects.push(solid_box("wall", min, max));
                };
                // Walls along x hold the corners.
                let (from, to) = if along_x { (2.0, 30.0) } else { (4.0, 28.0) };
                if side == gate_side {
                    wall(from, gate_at);
                    wall(gate_at + GATE, to);
                } else {
                    wall(from, to);
                }
            }
        }
    }
    let mut moving = Vec::new();
    let people = (PEOPLE * options.scale) as usize;
    let yards = YARDS * YARDS;
    for i in 0..people {
        // Places in rows, each yard filled alike.
        let (yard, place, places) = (i % yards, i / yards, people.div_ceil(yards));
        let rows = (places as f32).sqrt().ceil().max(1.0);
        let pitch = 23.0 / rows;
        let corner =
            Vec3::new((yard % YARDS) as f32 * PITCH + 4.5, GROUND, (yard / YARDS) as f32 * PITCH + 4.5);
        let spot = Vec3::new((place as f32 % rows) * pitch, 0.0, (place as f32 / rows).floor() * pitch);
        let base = corner + spot + Vec3::new(pitch, 0.0, pitch) * 0.5;
        let height = dice.range(1.4, 1.9);
        if dice.chance(0.1) {
            let radius = dice.range(0.15, 0.25);
            let center = base + Vec3::Y * dice.range(radius, 1.5);
            objects.push(object("balloon", Shape::Sphere { center, radius }));
        } else {
            objects.push(standing_box("person", base, Vec3::new(0.4, height, 0.3)));
        }
        let reach = Vec3::new(dice.range(0.05, 0.4), 0.0, dice.range(0.05, 0.4));
        moving.push(Moving::last(&mut objects, Way::swing(&mut dice, reach, 1.5)));
    }
    let walk = Walk { moving, glance: 0.7, ..Walk::along(path(), options) };
    walk.through("crowd", objects, [Vec3::ZERO, Vec3::new(SIZE, HEIGHT, SIZE)], 1.0)
}
