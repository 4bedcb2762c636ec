//! A tower: storeys of rooms around a ring of corridors, with thin walls, stairs, furniture and
//! small things. Walls, floors and stairs are meshes of boxes that abut.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::furniture::Furniture;
use super::motion::{Path, Sliding, Walk};
use super::options::SceneOptions;
use super::parts::{boxes, mesh, object, standing_box};
use crate::random::Dice;
use crate::world::{Mesh, Object, World};

const STOREYS: usize = 8;
const SIZE: Vec2 = Vec2::new(28.0, 20.0);
/// From a floor to the next one.
const HEIGHT: f32 = 3.2;
/// Thickness of slabs, of outer walls and of walls inside.
const SLAB: f32 = 0.25;
const OUTER: f32 = 0.3;
const INNER: f32 = 0.12;
/// Height of the eyes above a floor.
const EYE: f32 = 1.6;
const DOOR: f32 = 2.1;
/// The walk goes around this many storeys.
const WALKED: usize = 5;

/// Stairs: steps of each of the two flights of a storey, of which the landing is the last of the
/// first, and how high and deep a step is.
const STEPS: usize = 9;
const RISE: f32 = HEIGHT / (2 * STEPS) as f32;
const TREAD: f32 = 0.3;
const STEP_THICK: f32 = 0.3;
/// The shaft of the stairs: least and greatest corner as seen from above.
const SHAFT: (Vec2, Vec2) = (Vec2::new(9.0, 8.06), Vec2::new(13.14, 11.94));
/// Where the flights end at the landing, and the middles of their widths.
const LANDING: f32 = SHAFT.0.x + (STEPS - 1) as f32 * TREAD;
const FLIGHT_WIDTH: f32 = 1.64;
const UP: f32 = SHAFT.0.y + 0.5 * FLIGHT_WIDTH;
const FURTHER_UP: f32 = SHAFT.1.y - 0.5 * FLIGHT_WIDTH;

/// Rooms by their least and greatest x and z, between walls, where furniture may stand. Those to
/// the south leave room for people along the corridor.
const ROOMS: [[f32; 4]; 11] = [
    [0.3, 7.0, 0.3, 6.0],
    [7.0, 14.0, 0.3, 6.0],
    [14.0, 21.0, 0.3, 6.0],
    [21.0, 27.7, 0.3, 6.0],
    [0.3, 7.0, 15.2, 19.7],
    [7.0, 14.0, 15.2, 19.7],
    [14.0, 21.0, 15.2, 19.7],
    [21.0, 27.7, 15.2, 19.7],
    [0.3, 6.0, 6.0, 14.0],
    [22.0, 27.7, 6.0, 14.0],
    [13.2, 20.0, 8.0, 12.0],
];

/// Up the stairs, and around each storey: along corridors on even ones, through rooms on odd ones.
fn path() -> Path {
    let mut stops = vec![Vec3::new(4.0, EYE, 10.0)];
    for storey in 0..WALKED {
        let at = |x: f32, z: f32| Vec3::new(x, storey as f32 * HEIGHT + EYE, z);
        let west = if storey == 0 { 10.0 } else { FURTHER_UP };
        stops.extend([at(7.0, west), at(7.0, 13.0), at(21.0, 13.0), at(21.0, 7.0)]);
        if storey % 2 == 1 {
            let rooms = [(17.5, 7.0), (17.5, 3.0), (10.5, 3.0), (10.5, 7.0)];
            stops.extend(rooms.map(|(x, z)| at(x, z)));
        }
        stops.extend([at(7.0, 7.0), at(7.0, UP)]);
        // Above the middles of steps.
        let (low, high) = (SHAFT.0.x - 0.5 * TREAD, LANDING + 0.5 * TREAD);
        let (middle, up) = ((high + SHAFT.1.x) * 0.5, |p: Vec3, half: f32| p + Vec3::Y * HEIGHT * half);
        stops.extend([at(low, UP), up(at(high, UP), 0.5), up(at(middle, UP), 0.5)]);
        stops.extend([up(at(middle, FURTHER_UP), 0.5), up(at(high, FURTHER_UP), 0.5)]);
        stops.push(up(at(low, FURTHER_UP), 1.0));
    }
    let top = WALKED as f32 * HEIGHT + EYE;
    stops.extend([Vec3::new(7.0, top, FURTHER_UP), Vec3::new(7.0, top, 13.0), Vec3::new(18.0, top, 13.0)]);
    Path::close_to(&stops, 0.25)
}

/// A hole in a wall: its middle and width along the wall, and its least and greatest height.
#[derive(Clone, Copy)]
struct Hole {
    at: f32,
    width: f32,
    from: f32,
    to: f32,
}

fn door(at: f32) -> Hole {
    Hole { at, width: 1.2, from: 0.0, to: DOOR }
}

fn window(at: f32) -> Hole {
    Hole { at, width: 1.6, from: 0.9, to: 2.2 }
}

/// A wall along x or z, from place to place along it, at a place across it, with holes in ascending
/// order.
struct Wall {
    along_z: bool,
    along: (f32, f32),
    across: (f32, f32),
    holes: Vec<Hole>,
}

impl Wall {
    fn inner(along_z: bool, at: f32, along: (f32, f32), holes: &[Hole]) -> Self {
        Self { along_z, along, across: (at - 0.5 * INNER, at + 0.5 * INNER), holes: holes.to_vec() }
    }

    /// Boxes between the holes, below and above them.
    fn mesh(&self, floor: f32) -> Mesh {
        let (low, high) = (floor, floor + HEIGHT - SLAB);
        let mut parts = Vec::new();
        let mut add = |along: (f32, f32), up: (f32, f32)| {
            let point = |a, y, c| if self.along_z { Vec3::new(c, y, a) } else { Vec3::new(a, y, c) };
            if along.0 < along.1 && up.0 < up.1 {
                parts.push((point(along.0, up.0, self.across.0), point(along.1, up.1, self.across.1)));
            }
        };
        let mut from = self.along.0;
        for hole in &self.holes {
            let (left, right) = (hole.at - 0.5 * hole.width, hole.at + 0.5 * hole.width);
            add((from, left), (low, high));
            add((left, right), (low, floor + hole.from));
            add((left, right), (floor + hole.to, high));
            from = right;
        }
        add((from, self.along.1), (low, high));
        boxes(parts)
    }
}

/// A door between windows, through which one sees into a room.
fn front(at: f32) -> [Hole; 3] {
    [window(at - 1.9), door(at), window(at + 1.9)]
}

/// The walls of a storey.
fn walls() -> Vec<Wall> {
    let mut walls = Vec::new();
    for across in [(0.0, OUTER), (SIZE.y - OUTER, SIZE.y)] {
        let holes = (0..8).map(|i| window(1.75 + 3.5 * i as f32)).collect();
        walls.push(Wall { along_z: false, along: (0.0, SIZE.x), across, holes });
    }
    for across in [(0.0, OUTER), (SIZE.x - OUTER, SIZE.x)] {
        let holes = [3.2, 8.0, 12.0, 16.8].map(window).to_vec();
        walls.push(Wall { along_z: true, along: (OUTER, SIZE.y - OUTER), across, holes });
    }
    let half = 0.5 * INNER;
    for at in [6.0, 14.0] {
        let fronts = [3.5, 10.5, 17.5, 24.5].map(front);
        walls.push(Wall::inner(false, at, (OUTER, SIZE.x - OUTER), fronts.as_flattened()));
    }
    for at in [6.0, 22.0] {
        walls.push(Wall::inner(true, at, (6.0 + half, 14.0 - half), &front(10.0)));
    }
    for at in [7.0, 14.0, 21.0] {
        walls.push(Wall::inner(true, at, (OUTER, 6.0 - half), &[door(3.0)]));
        walls.push(Wall::inner(true, at, (14.0 + half, SIZE.y - OUTER), &[door(17.0)]));
    }
    // The stairs, and a room beside them.
    for (at, doors) in [(8.0, &[door(17.0)][..]), (12.0, &[])] {
        walls.push(Wall::inner(false, at, (8.0 - half, 20.0 + half), doors));
    }
    let inside = (8.0 + half, 12.0 - half);
    walls.push(Wall::inner(true, 8.0, inside, &[door(UP), door(FURTHER_UP)]));
    walls.push(Wall::inner(true, SHAFT.1.x + half, inside, &[]));
    walls.push(Wall::inner(true, 20.0, inside, &[]));
    walls
}

/// A slab below a floor at this height, with or without the hole of the stairs.
fn slab(floor: f32, hole: bool) -> Mesh {
    let part = |x: (f32, f32), z: (f32, f32)| (Vec3::new(x.0, floor - SLAB, z.0), Vec3::new(x.1, floor, z.1));
    let (lo, hi) = SHAFT;
    if hole {
        boxes([
            part((0.0, SIZE.x), (0.0, lo.y)),
            part((0.0, lo.x), (lo.y, hi.y)),
            part((hi.x, SIZE.x), (lo.y, hi.y)),
            part((0.0, SIZE.x), (hi.y, SIZE.y)),
        ])
    } else {
        boxes([part((0.0, SIZE.x), (0.0, SIZE.y))])
    }
}

/// The steps of a flight, without the landing or the floor at its end.
fn flight(floor: f32, further: bool) -> Mesh {
    boxes((1..STEPS).map(|step| {
        let (x, top, z) = if further {
            (LANDING - step as f32 * TREAD, floor + (STEPS + step) as f32 * RISE, FURTHER_UP)
        } else {
            (LANDING - (STEPS - step) as f32 * TREAD, floor + step as f32 * RISE, UP)
        };
        let (near, far) = (z - 0.5 * FLIGHT_WIDTH, z + 0.5 * FLIGHT_WIDTH);
        (Vec3::new(x, top - STEP_THICK, near), Vec3::new(x + TREAD, top, far))
    }))
}

fn landing(floor: f32) -> Mesh {
    let top = floor + 0.5 * HEIGHT;
    Mesh::cuboid(Vec3::new(LANDING, top - STEP_THICK, SHAFT.0.y), Vec3::new(SHAFT.1.x, top, SHAFT.1.y))
}

/// What does not depend on chance.
fn building(objects: &mut Vec<Object>) {
    for storey in 0..STOREYS {
        let floor = storey as f32 * HEIGHT;
        objects.push(object("slab", mesh(slab(floor, storey > 0))));
        objects.extend(walls().iter().map(|wall| object("wall", mesh(wall.mesh(floor)))));
        if storey + 1 < STOREYS {
            objects.push(object("flight", mesh(flight(floor, false))));
            objects.push(object("landing", mesh(landing(floor))));
            objects.push(object("flight", mesh(flight(floor, true))));
        }
    }
    objects.push(object("slab", mesh(slab(STOREYS as f32 * HEIGHT, false))));
}

/// People who go to and fro along a corridor and in rooms beside it.
fn people(dice: &mut Dice, objects: &mut Vec<Object>) -> Vec<Sliding> {
    let mut sliding = Vec::new();
    for storey in 0..STOREYS {
        for (from, to, z) in [(9.0, 19.0, 12.35), (7.5, 13.5, 14.7), (14.5, 20.5, 14.7)] {
            let base = Vec3::new(from, storey as f32 * HEIGHT, z);
            objects.push(standing_box("person", base, Vec3::new(0.5, dice.range(1.5, 1.9), 0.35)));
            let (rate, phase) = (dice.range(0.1, 0.25), dice.range(0.0, TAU));
            sliding.push(Sliding::last(objects, Vec3::X * (to - from), rate, phase));
        }
    }
    sliding
}

pub(super) fn build(options: &SceneOptions) -> World {
    let mut dice = Dice::new(options.seed, 14);
    let path = path();
    let mut objects = Vec::new();
    building(&mut objects);
    let furniture = Furniture::new(&ROOMS, &path);
    for storey in 0..STOREYS {
        furniture.furnish(&mut dice, storey as f32 * HEIGHT, options.scale, &mut objects);
    }
    let sliding = people(&mut dice, &mut objects);
    let top = STOREYS as f32 * HEIGHT;
    let walk = Walk { sliding, far: 100.0, ..Walk::along(path, options) };
    walk.through(
        "storeys",
        objects,
        [Vec3::new(-0.5, -0.5, -0.5), Vec3::new(SIZE.x + 0.5, top + 0.5, SIZE.y + 0.5)],
        0.2,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_slabs_and_stairs_are_closed() {
        assert!(walls().iter().all(|wall| wall.mesh(HEIGHT).is_closed()));
        let stairs = [flight(0.0, false), landing(0.0), flight(0.0, true)];
        assert!(stairs.iter().chain(&[slab(0.0, false), slab(HEIGHT, true)]).all(Mesh::is_closed));
    }
}
