//! One floor of rooms: walls 0.2 m thick, doorways with doors that slide
//! open and shut, furniture.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::motion::{Moving, Path, Walk, Way};
use super::options::SceneOptions;
use super::parts::{object, solid_box, standing_box};
use crate::random::Dice;
use crate::world::{Object, Shape, World};

const ROOMS: usize = 5;
const PITCH: f32 = 8.0;
const SIZE: f32 = ROOMS as f32 * PITCH;
/// Floor and ceiling, 0.2 m thick each.
const FLOOR: f32 = 0.2;
const CEILING: f32 = 3.2;
const HALF_WALL: f32 = 0.1;
const DOOR_WIDTH: f32 = 1.0;
const DOOR_HEIGHT: f32 = 2.1;

/// The rooms that the walk passes, each next to the one before.
const ROUTE: [(usize, usize); 13] =
    [(0, 0), (1, 0), (1, 1), (2, 1), (3, 1), (3, 2), (2, 2), (2, 3), (1, 3), (1, 4), (2, 4), (3, 4), (4, 4)];

fn center(room: (usize, usize)) -> Vec3 {
    Vec3::new((room.0 as f32 + 0.5) * PITCH, FLOOR + 1.6, (room.1 as f32 + 0.5) * PITCH)
}

fn path() -> Path {
    let mut corners = vec![center(ROUTE[0])];
    for pair in ROUTE.windows(2) {
        let (a, b) = (center(pair[0]), center(pair[1]));
        // Straight through the doorway, half a metre to each side of it.
        let door = (a + b) * 0.5;
        let ahead = (b - a).normalize() * 0.8;
        corners.extend([door - ahead, door + ahead, b]);
    }
    Path::new(&corners)
}

fn on_route(a: (usize, usize), b: (usize, usize)) -> bool {
    ROUTE.windows(2).any(|w| (w[0], w[1]) == (a, b) || (w[0], w[1]) == (b, a))
}

/// A box given by its extent along the wall, upwards and across it.
fn wall_box(name: &str, along_z: bool, along: (f32, f32), up: (f32, f32), across: (f32, f32)) -> Object {
    let point = |a, y, c| if along_z { Vec3::new(c, y, a) } else { Vec3::new(a, y, c) };
    solid_box(name, point(along.0, up.0, across.0), point(along.1, up.1, across.1))
}

/// The walls between rooms, with doorways and doors.
fn inner_walls(dice: &mut Dice, objects: &mut Vec<Object>) -> Vec<Moving> {
    let full = (FLOOR, CEILING);
    let mut moving = Vec::new();
    for along_z in [false, true] {
        for line in 1..ROOMS {
            let at = line as f32 * PITCH;
            let across = (at - HALF_WALL, at + HALF_WALL);
            for piece in 0..ROOMS {
                let (from, to) = (piece as f32 * PITCH, (piece + 1) as f32 * PITCH);
                let (left, right) = ((from + to - DOOR_WIDTH) * 0.5, (from + to + DOOR_WIDTH) * 0.5);
                let top = FLOOR + DOOR_HEIGHT;
                objects.push(wall_box("wall", along_z, (from, left), full, across));
                objects.push(wall_box("wall", along_z, (right, to), full, across));
                objects.push(wall_box("lintel", along_z, (left, right), (top, CEILING), across));
                // The door hangs in front of the wall and slides aside along it.
                let face = (across.1 + 0.01, across.1 + 0.06);
                let leaf = (left - 0.02, right + 0.02);
                objects.push(wall_box("door", along_z, leaf, (FLOOR, top + 0.02), face));
                let (a, b) = if along_z {
                    ((line - 1, piece), (line, piece))
                } else {
                    ((piece, line - 1), (piece, line))
                };
                let way = if along_z { Vec3::Z } else { Vec3::X } * (DOOR_WIDTH + 0.1);
                let (rate, phase) =
                    if on_route(a, b) { (0.0, PI) } else { (dice.range(0.4, 2.0), dice.range(0.0, TAU)) };
                moving.push(Moving::last(objects, Way::Slide { way, rate, phase }));
            }
        }
    }
    moving
}

/// Furniture in all rooms, but where the walk goes.
fn furniture(dice: &mut Dice, scale: f32, walk: &[Vec3], objects: &mut Vec<Object>) {
    for rz in 0..ROOMS {
        for rx in 0..ROOMS {
            let corner = Vec3::new(rx as f32 * PITCH, FLOOR, rz as f32 * PITCH);
            let pieces = (dice.range(8.0, 20.99) * scale) as usize;
            for _ in 0..pieces {
                let size = dice.point(Vec3::new(0.2, 0.2, 0.2), Vec3::new(1.2, 1.8, 1.2));
                let offset = Vec3::new(dice.range(0.9, PITCH - 0.9), 0.0, dice.range(0.9, PITCH - 0.9));
                let base = corner + offset;
                let reach = size.x.max(size.z) + 0.3;
                let flat = |p: &Vec3| (*p - base) * Vec3::new(1.0, 0.0, 1.0);
                if walk.iter().any(|p| flat(p).length() < reach) {
                    continue;
                }
                if dice.chance(0.25) {
                    let radius = size.x * 0.25;
                    let height = dice.range(radius, 2.0);
                    objects.push(object("lamp", Shape::Sphere { center: base + Vec3::Y * height, radius }));
                } else {
                    objects.push(standing_box("furniture", base, size));
                }
            }
        }
    }
}

pub(super) fn build(options: &SceneOptions) -> World {
    let mut dice = Dice::new(options.seed, 3);
    let path = path();
    let samples = path.samples(2000);
    let mut objects = vec![
        solid_box("floor", Vec3::ZERO, Vec3::new(SIZE, FLOOR, SIZE)),
        solid_box("ceiling", Vec3::new(0.0, CEILING, 0.0), Vec3::new(SIZE, CEILING + 0.2, SIZE)),
    ];
    let full = (FLOOR, CEILING);
    for along_z in [false, true] {
        for border in [(0.0, 0.2), (SIZE - 0.2, SIZE)] {
            objects.push(wall_box("outer wall", along_z, (0.0, SIZE), full, border));
        }
    }
    let moving = inner_walls(&mut dice, &mut objects);
    furniture(&mut dice, options.scale, &samples, &mut objects);
    let max = Vec3::new(SIZE, CEILING + 0.2, SIZE);
    let walk = Walk { moving, glance: 0.7, far: 100.0, ..Walk::along(path, options) };
    // Two cells are a little thinner than a wall, so that every wall holds a
    // whole layer of them wherever it stands.
    walk.through("rooms", objects, [Vec3::ZERO, max], 0.0999)
}
