//! A container terminal: stacks of containers with lanes between them, cranes of thin beams, a ship
//! without a deck, small things and vehicles.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::motion::{Moving, Path, Walk, Way};
use super::options::SceneOptions;
use super::parts::{beams, mesh, object, placed, prism, standing_box};
use crate::random::Dice;
use crate::world::{Mesh, Object, World};

const CONTAINERS: f32 = 900.0;
const SMALL: f32 = 2500.0;
/// Width of lanes.
const LANE: f32 = 7.0;
/// Blocks of stacks along x and z.
const BLOCKS: (usize, usize) = (5, 4);
/// Places for stacks in a block: bays along x, rows along z.
const BAYS: usize = 3;
const ROWS: usize = 4;
const BAY: f32 = 12.8;
const ROW: f32 = 2.6;
/// A block and the lane before it.
const PITCH: Vec2 = Vec2::new(LANE + BAYS as f32 * BAY, LANE + ROWS as f32 * ROW);
/// Least corner of the first crossing of lanes.
const YARD: Vec2 = Vec2::new(4.0, 70.0);
const SIZE: Vec3 = Vec3::new(
    2.0 * YARD.x + BLOCKS.0 as f32 * PITCH.x + LANE,
    48.0,
    YARD.y + BLOCKS.1 as f32 * PITCH.y + LANE + 4.0,
);
/// Top of the quay, and its edge at the water.
const QUAY: f32 = 3.0;
const EDGE: f32 = 42.0;
/// Extent of a container: of the shorter of two lengths, upwards and across.
const CONTAINER: Vec3 = Vec3::new(6.1, 2.6, 2.44);
/// Depth of the dents in a container's sides.
const DENT: f32 = 0.05;
/// How far containers stand out of line, at most.
const SHIFT: f32 = 0.05;
const TIERS: f32 = 5.0;
/// Cranes over the ship's side, one beside each block, and cranes over the stacks.
const SHIP_CRANES: usize = 5;
const YARD_CRANES: usize = 7;
/// How far small things are from the path at least.
const OFF: f32 = 1.2;

/// A crossing of lanes: its middle on the ground.
fn crossing(x: usize, z: usize) -> Vec3 {
    let at = YARD + Vec2::new(x as f32, z as f32) * PITCH + LANE * 0.5;
    Vec3::new(at.x, QUAY, at.y)
}

/// From the ship's side along lanes and around stacks.
fn path() -> Path {
    let eye = Vec3::Y * 1.7;
    let mut stops = vec![Vec3::new(crossing(0, 0).x, QUAY, EDGE + 7.0) + eye];
    let crossings = [(0, 1), (2, 1), (2, 3), (4, 3), (4, 2), (3, 2), (3, 0)];
    stops.extend(crossings.map(|(x, z)| crossing(x, z) + eye));
    stops.push(Vec3::new(crossing(3, 0).x, QUAY, EDGE + 9.0) + eye);
    Path::close_to(&stops, 3.0)
}

/// A skin over convex sections of equal numbers of corners, one behind the other along x, with both
/// ends closed. Corners run counter-clockwise as seen from beyond the last section; without its lid
/// a skin lacks the side between the last corner and the first.
fn loft(sections: &[Vec<Vec3>], lid: bool) -> Mesh {
    let (corners, last) = (sections[0].len() as u32, sections.len() as u32 - 1);
    let mut triangles = Vec::new();
    for section in 0..last {
        for i in 0..corners - u32::from(!lid) {
            let (a, b) = (section * corners + i, section * corners + (i + 1) % corners);
            let (c, d) = (a + corners, b + corners);
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    let end = last * corners;
    for i in 1..corners - 1 {
        triangles.extend([[0, i + 1, i], [end, end + i, end + i + 1]]);
    }
    Mesh { positions: sections.concat(), triangles, ..Mesh::default() }
}

/// A container with dents along its sides, this many times as long as the shorter ones.
fn container(lengths: u32) -> Mesh {
    let steps = 12 * lengths;
    let section = |i: u32| {
        let x = CONTAINER.x * lengths as f32 * i as f32 / steps as f32;
        let inwards = if i % 4 < 2 || i == steps { 0.0 } else { DENT };
        let (near, far) = (inwards, CONTAINER.z - inwards);
        [(CONTAINER.y, near), (CONTAINER.y, far), (0.0, far), (0.0, near)]
            .map(|(y, z)| Vec3::new(x, y, z))
            .to_vec()
    };
    loft(&(0..=steps).map(section).collect::<Vec<_>>(), true)
}

/// A place for a stack: its least corner, and the length of its containers in shorter ones.
struct Place {
    corner: Vec3,
    lengths: u32,
}

/// All places of the yard in a random order.
fn places(dice: &mut Dice) -> Vec<Place> {
    let mut places = Vec::new();
    for i in 0..BLOCKS.0 * BLOCKS.1 * BAYS * ROWS {
        let (row, bay, block) = (i % ROWS, i / ROWS % BAYS, i / (ROWS * BAYS));
        let least = crossing(block % BLOCKS.0, block / BLOCKS.0) + Vec3::new(0.5, 0.0, 0.5) * LANE;
        let corner = least + Vec3::new(bay as f32 * BAY + 0.1, 0.0, row as f32 * ROW + 0.08);
        if dice.chance(0.4) {
            let second = corner + Vec3::X * (CONTAINER.x + 0.25);
            places.extend([corner, second].map(|corner| Place { corner, lengths: 1 }));
        } else {
            places.push(Place { corner, lengths: 2 });
        }
    }
    for i in (1..places.len()).rev() {
        places.swap(i, (dice.range(0.0, 1.0) * (i + 1) as f32) as usize % (i + 1));
    }
    places
}

/// Stacks of one to five containers, until there are `count` or the yard is full.
fn stacks(dice: &mut Dice, count: usize, objects: &mut Vec<Object>) {
    let models = [1, 2].map(|lengths| Arc::new(container(lengths)));
    let mut left = count;
    for place in places(dice) {
        let tiers = (dice.range(1.0, TIERS + 0.99) as usize).min(left);
        for tier in 0..tiers {
            let shift = dice.point(Vec3::ZERO, Vec3::new(SHIFT, 0.0, SHIFT));
            let at = place.corner + shift + Vec3::Y * (tier as f32 * CONTAINER.y);
            let model = &models[place.lengths as usize - 1];
            objects.push(object("container", placed(model, Vec3::ONE, 0.0, at)));
        }
        left -= tiers;
    }
}

/// A crane at the quay's edge, around x = 0, that reaches over the ship.
fn ship_crane() -> Mesh {
    beams(&[
        // Legs, and beams along the rails.
        ([-7.5, 0.0, EDGE + 2.0], [0.7, 26.0, 0.7]),
        ([6.8, 0.0, EDGE + 2.0], [0.7, 26.0, 0.7]),
        ([-7.5, 0.0, EDGE + 15.0], [0.7, 26.0, 0.7]),
        ([6.8, 0.0, EDGE + 15.0], [0.7, 26.0, 0.7]),
        ([-6.8, 0.7, EDGE + 2.05], [13.6, 0.6, 0.6]),
        ([-6.8, 0.7, EDGE + 15.05], [13.6, 0.6, 0.6]),
        // Between the legs, half up and on top.
        ([-7.45, 12.0, EDGE + 2.7], [0.6, 0.6, 12.3]),
        ([6.85, 12.0, EDGE + 2.7], [0.6, 0.6, 12.3]),
        ([-7.5, 26.0, EDGE + 2.0], [15.0, 0.7, 0.7]),
        ([-7.5, 26.0, EDGE + 15.0], [15.0, 0.7, 0.7]),
        // The boom, its mast and stay, the cabin and the house of its engines.
        ([-1.8, 26.7, EDGE - 27.0], [0.4, 0.9, 50.0]),
        ([1.4, 26.7, EDGE - 27.0], [0.4, 0.9, 50.0]),
        ([-1.8, 27.6, EDGE + 2.1], [0.4, 12.0, 0.4]),
        ([1.4, 27.6, EDGE + 2.1], [0.4, 12.0, 0.4]),
        ([-1.4, 39.2, EDGE + 2.1], [2.8, 0.4, 0.4]),
        ([-1.0, 24.2, EDGE - 12.0], [2.0, 2.3, 2.5]),
        ([-3.0, 27.6, EDGE + 16.0], [6.0, 3.0, 6.0]),
    ])
}

/// A crane over the stacks of a block, whose least corner is the origin.
fn yard_crane() -> Mesh {
    const WIDE: f32 = ROWS as f32 * ROW;
    beams(&[
        ([0.0, 0.9, -0.8], [0.5, 17.1, 0.5]),
        ([6.5, 0.9, -0.8], [0.5, 17.1, 0.5]),
        ([0.0, 0.9, WIDE + 0.3], [0.5, 17.1, 0.5]),
        ([6.5, 0.9, WIDE + 0.3], [0.5, 17.1, 0.5]),
        // Wheels, and beams above them.
        ([-0.6, 0.0, -0.75], [1.7, 0.9, 0.4]),
        ([5.9, 0.0, -0.75], [1.7, 0.9, 0.4]),
        ([-0.6, 0.0, WIDE + 0.35], [1.7, 0.9, 0.4]),
        ([5.9, 0.0, WIDE + 0.35], [1.7, 0.9, 0.4]),
        ([0.5, 0.9, -0.75], [6.0, 0.4, 0.4]),
        ([0.5, 0.9, WIDE + 0.35], [6.0, 0.4, 0.4]),
        // Girders across, ties between them, the trolley, its cabin, and what holds containers.
        ([0.0, 18.0, -0.8], [0.5, 0.9, WIDE + 1.6]),
        ([6.5, 18.0, -0.8], [0.5, 0.9, WIDE + 1.6]),
        ([0.5, 18.2, -0.8], [6.0, 0.4, 0.4]),
        ([0.5, 18.2, WIDE + 0.4], [6.0, 0.4, 0.4]),
        ([0.2, 18.9, 3.0], [6.6, 0.5, 2.5]),
        ([0.8, 16.0, 5.6], [1.8, 2.0, 1.6]),
        ([0.4, 14.6, 3.1], [6.1, 0.3, 2.3]),
    ])
}

fn cranes(dice: &mut Dice, objects: &mut Vec<Object>) {
    let (ship_crane, yard_crane) = (Arc::new(ship_crane()), Arc::new(yard_crane()));
    let half = PITCH.x * 0.5;
    for i in 0..SHIP_CRANES {
        let at = Vec3::new(crossing(i, 0).x + half + dice.range(-9.0, 9.0), QUAY, 0.0);
        objects.push(object("ship crane", placed(&ship_crane, Vec3::ONE, 0.0, at)));
    }
    for i in 0..YARD_CRANES {
        // Each over another block.
        let block =
            crossing(i * 2 % BLOCKS.0, i * 2 / BLOCKS.0 % BLOCKS.1) + LANE * 0.5 * (Vec3::X + Vec3::Z);
        let at = block + Vec3::X * dice.range(0.6, BAYS as f32 * BAY - 8.0);
        objects.push(object("yard crane", placed(&yard_crane, Vec3::ONE, 0.0, at)));
    }
}

/// The hull of the ship, from the stern to the bow.
fn hull(deck: bool) -> Mesh {
    let section = |i: usize| {
        let along = i as f32 / 20.0;
        let beam = 12.0 * (1.0 - 0.45 * (1.0 - along).powi(6) - 0.96 * along.powi(7));
        let top = 11.0 + 3.0 * along.powi(4);
        let half = [(top, 1.0), (0.35 * top, 0.96), (0.3, 0.6)];
        let point = |(y, share): (f32, f32)| Vec3::new(34.0 + 172.0 * along, y, 22.0 + share * beam);
        let port = half.iter().rev().map(|&(y, share)| (y, -share));
        half.iter().copied().chain(port).map(point).collect()
    };
    loft(&(0..=20).map(section).collect::<Vec<Vec<Vec3>>>(), deck)
}

fn ship(objects: &mut Vec<Object>) {
    objects.push(object("hull", mesh(hull(false))));
    // Between the hatches one sees into the hold.
    for hatch in 0..7 {
        let x = 66.0 + 16.0 * hatch as f32;
        let (lo, hi) = (Vec3::new(x, 6.0, 13.5), Vec3::new(x + 12.5, 12.0, 30.5));
        objects.push(object("hatch", mesh(Mesh::cuboid(lo, hi))));
    }
    let bridge = beams(&[
        ([42.0, 8.0, 13.0], [14.0, 9.0, 18.0]),
        ([44.0, 17.0, 15.0], [10.0, 8.0, 14.0]),
        ([46.0, 25.0, 11.0], [6.0, 3.0, 22.0]),
        ([43.0, 17.0, 20.0], [0.9, 12.0, 4.0]),
        ([49.0, 28.0, 21.8], [0.4, 9.0, 0.4]),
        ([196.0, 10.0, 21.8], [0.4, 14.0, 0.4]),
    ]);
    objects.push(object("bridge", mesh(bridge)));
}

/// A place for a small thing: on the quay, or at the side of a lane.
fn small_place(dice: &mut Dice) -> Vec3 {
    let x = dice.range(1.0, SIZE.x - 1.0);
    if dice.chance(0.15) {
        return Vec3::new(x, QUAY, dice.range(EDGE + 3.5, EDGE + 14.0));
    }
    let side = if dice.chance(0.5) { dice.range(0.6, 1.3) } else { dice.range(LANE - 1.3, LANE - 0.6) };
    let lane = |dice: &mut Dice, blocks: usize| dice.range(0.0, blocks as f32 + 0.99) as usize;
    if dice.chance(0.6) {
        Vec3::new(x, QUAY, crossing(0, lane(dice, BLOCKS.1)).z - 0.5 * LANE + side)
    } else {
        let along = dice.range(YARD.y, crossing(0, BLOCKS.1).z);
        Vec3::new(crossing(lane(dice, BLOCKS.0), 0).x - 0.5 * LANE + side, QUAY, along)
    }
}

fn small_things(dice: &mut Dice, path: &Path, count: usize, objects: &mut Vec<Object>) {
    let samples = path.samples(1000);
    let free = |p: Vec3| samples.iter().all(|s| (s.x - p.x).hypot(s.z - p.z) > OFF);
    let (bollard, barrel) = (Arc::new(prism(8)), Arc::new(prism(10)));
    let cube = Arc::new(Mesh::cuboid(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.5, 1.0, 0.5)));
    for _ in 0..count {
        let at = loop {
            let at = small_place(dice);
            if free(at) {
                break at;
            }
        };
        let turn = dice.range(0.0, TAU);
        let thing = match dice.range(0.0, 1.0) {
            kind if kind < 0.1 => {
                let at = Vec3::new(at.x, QUAY, EDGE + dice.range(0.5, 0.8));
                object("bollard", placed(&bollard, Vec3::new(0.25, 0.6, 0.25), turn, at))
            }
            kind if kind < 0.55 => object("barrel", placed(&barrel, Vec3::new(0.3, 0.9, 0.3), turn, at)),
            _ => {
                let size = dice.point(Vec3::splat(0.2), Vec3::splat(0.8));
                object("crate", placed(&cube, size, turn, at))
            }
        };
        objects.push(thing);
    }
}

/// Trucks on the quay, and straddle carriers in the lanes that the walk keeps off, each along one
/// block.
fn vehicles(dice: &mut Dice, objects: &mut Vec<Object>) -> Vec<Moving> {
    let mut moving = Vec::new();
    for i in 0..4 * BLOCKS.0 {
        let (block, kind) = (i % BLOCKS.0, i / BLOCKS.0);
        let (name, z, size) = match kind {
            0 => ("truck", EDGE + 19.0, Vec3::new(13.0, 3.6, 2.5)),
            1 => ("truck", EDGE + 23.5, Vec3::new(13.0, 3.6, 2.5)),
            2 => ("carrier", crossing(0, 0).z, Vec3::new(8.0, 9.5, 3.2)),
            _ => ("carrier", crossing(0, BLOCKS.1).z, Vec3::new(8.0, 9.5, 3.2)),
        };
        let start = crossing(block, 0).x + 0.5 * (LANE + size.x);
        let way = PITCH.x - LANE - size.x;
        objects.push(standing_box(name, Vec3::new(start, QUAY + 0.2, z), size));
        let (rate, phase) = (dice.range(0.1, 0.4), dice.range(0.0, TAU));
        moving.push(Moving::last(objects, Way::Slide { way: Vec3::X * way, rate, phase }));
    }
    moving
}

pub(super) fn build(options: &SceneOptions) -> World {
    let mut dice = Dice::new(options.seed, 13);
    let path = path();
    let quay = Mesh::cuboid(Vec3::new(0.0, 0.0, EDGE), Vec3::new(SIZE.x, QUAY, SIZE.z));
    let mut objects = vec![object("quay", mesh(quay))];
    stacks(&mut dice, (CONTAINERS * options.scale) as usize, &mut objects);
    cranes(&mut dice, &mut objects);
    ship(&mut objects);
    small_things(&mut dice, &path, (SMALL * options.scale) as usize, &mut objects);
    let moving = vehicles(&mut dice, &mut objects);
    let walk = Walk { moving, ..Walk::along(path, options) };
    walk.through("harbour", objects, [Vec3::ZERO, SIZE], 1.25)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_are_closed_but_the_hull_lacks_its_deck() {
        assert!([container(1), container(2), ship_crane(), yard_crane()].iter().all(Mesh::is_closed));
        assert!(hull(true).is_closed() && !hull(false).is_closed());
    }
}
