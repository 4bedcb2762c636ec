//! A town of modules: buildings put together from panels that abut without sharing vertices, thin
//! railings, and thousands of small things on streets, floors and roofs.

use std::sync::Arc;

use glam::Vec3;

use super::city::{self, BLOCKS, GROUND, PITCH, SIZE, STREET};
use super::motion::Walk;
use super::options::SceneOptions;
use super::parts::{mesh, object, placed, standing_box};
use crate::random::Dice;
use crate::world::{Mesh, Object, World};

const HEIGHT: f32 = 40.0;
/// Length of a side of a building.
const WIDTH: f32 = PITCH - STREET;
const STOREY: f32 = 3.0;
/// Thickness of panels and floors.
const THICK: f32 = 0.2;
const SMALL: f32 = 20_000.0;

/// A side of a building: where it starts, along which axis it goes, and which way is out.
struct Side {
    corner: Vec3,
    along: Vec3,
    out: Vec3,
}

impl Side {
    /// A box given by its extent along the side, upwards and inwards.
    fn cuboid(&self, along: (f32, f32), up: (f32, f32), inwards: (f32, f32)) -> Mesh {
        let at = |a: f32, y: f32, d: f32| self.corner + self.along * a + Vec3::Y * y - self.out * d;
        let (p, q) = (at(along.0, up.0, inwards.0), at(along.1, up.1, inwards.1));
        Mesh::cuboid(p.min(q), p.max(q))
    }
}

/// The four sides of a building.
fn sides(corner: Vec3) -> [Side; 4] {
    let far = corner + Vec3::new(WIDTH, 0.0, WIDTH);
    [
        Side { corner, along: Vec3::X, out: Vec3::NEG_Z },
        Side { corner: far, along: Vec3::NEG_X, out: Vec3::Z },
        Side { corner: far, along: Vec3::NEG_Z, out: Vec3::X },
        Side { corner, along: Vec3::Z, out: Vec3::NEG_X },
    ]
}

/// A wall of panels. Those of one storey are wider than those of the next, so that corners abut on
/// edges.
fn facade(dice: &mut Dice, side: &Side, storeys: usize) -> Mesh {
    let mut wall = Mesh::default();
    for storey in 0..storeys {
        let panels = if storey % 2 == 0 { 7 } else { 8 };
        let width = WIDTH / panels as f32;
        let up = (storey as f32 * STOREY, (storey + 1) as f32 * STOREY);
        for panel in 0..panels {
            let along = (panel as f32 * width, (panel + 1) as f32 * width);
            if dice.chance(0.55) {
                window(dice, &mut wall, side, along, up);
            } else {
                wall.append(side.cuboid(along, up, (0.0, THICK)));
            }
        }
    }
    wall
}

/// A panel of four strips around a window, which most often a thin pane closes.
fn window(dice: &mut Dice, wall: &mut Mesh, side: &Side, along: (f32, f32), up: (f32, f32)) {
    let (left, right, sill, top) = (along.0 + 0.9, along.1 - 0.9, up.0 + 0.9, up.1 - 0.6);
    let full = (0.0, THICK);
    wall.append(side.cuboid(along, (up.0, sill), full));
    wall.append(side.cuboid(along, (top, up.1), full));
    wall.append(side.cuboid((along.0, left), (sill, top), full));
    wall.append(side.cuboid((right, along.1), (sill, top), full));
    if dice.chance(0.85) {
        wall.append(side.cuboid((left, right), (sill, top), (0.12, 0.14)));
    }
}

/// Posts and bars between two ends.
fn railing(side: &Side, along: (f32, f32), base: f32, inwards: f32) -> Mesh {
    const BAR: f32 = 0.03;
    let mut rail = Mesh::default();
    let posts = ((along.1 - along.0) / 1.2).ceil() as usize;
    for i in 0..=posts {
        let at = along.0 + (along.1 - along.0 - BAR) * i as f32 / posts as f32;
        rail.append(side.cuboid((at, at + BAR), (base, base + 1.0), (inwards, inwards + BAR)));
    }
    for height in [0.35, 0.65, 1.0] {
        let up = (base + height, base + height + BAR);
        rail.append(side.cuboid(along, up, (inwards, inwards + BAR)));
    }
    rail
}

/// A building on four sides; returns the heights of its floors, the roof last.
fn building(dice: &mut Dice, corner: Vec3, objects: &mut Vec<Object>) -> usize {
    let storeys = dice.range(2.0, 7.99) as usize;
    let top = storeys as f32 * STOREY;
    for side in sides(corner) {
        objects.push(object("facade", mesh(facade(dice, &side, storeys))));
        objects.push(object("roof railing", mesh(railing(&side, (0.5, WIDTH - 0.5), top, 0.3))));
        let storey = 1.0 + dice.range(0.0, storeys as f32 - 1.01).floor();
        // A balcony in front of the facade.
        let (from, height) = (dice.range(1.0, WIDTH - 5.0), storey * STOREY);
        let floor = side.cuboid((from, from + 4.0), (height - THICK, height), (-1.2, 0.0));
        objects.push(object("balcony", mesh(floor)));
        objects.push(object("balcony railing", mesh(railing(&side, (from, from + 4.0), height, -1.2))));
    }
    let inner = Vec3::new(THICK, 0.0, THICK);
    for floor in 1..=storeys {
        let y = Vec3::Y * floor as f32 * STOREY;
        let (lo, hi) =
            (corner + inner + y - Vec3::Y * THICK, corner + y + Vec3::new(WIDTH, 0.0, WIDTH) - inner);
        objects.push(object("floor", mesh(Mesh::cuboid(lo, hi))));
    }
    storeys
}

/// The shape of a small thing; some hide others.
fn small_thing(dice: &mut Dice, ball: &Arc<Mesh>, base: Vec3) -> Object {
    let size = dice.point(Vec3::splat(0.1), Vec3::splat(0.7));
    let mut thing = if dice.chance(0.15) {
        let radius = size.x * 0.5;
        let at = base + Vec3::Y * radius;
        object("ball", placed(ball, Vec3::splat(radius), 0.0, at))
    } else {
        standing_box("thing", base, size)
    };
    thing.occludes = dice.chance(0.5);
    thing
}

/// A place on a pavement around a block.
fn on_pavement(dice: &mut Dice, block: Vec3) -> Vec3 {
    // Between the lane and the block, along x or along z.
    let across = if dice.chance(0.5) { dice.range(0.6, 2.2) } else { dice.range(9.8, 10.4) };
    let along = dice.range(STREET + 0.6, PITCH - 0.6);
    block + if dice.chance(0.5) { Vec3::new(across, GROUND, along) } else { Vec3::new(along, GROUND, across) }
}

pub(super) fn build(options: &SceneOptions) -> World {
    let mut dice = Dice::new(options.seed, 8);
    let mut objects = vec![object("ground", mesh(Mesh::cuboid(Vec3::ZERO, Vec3::new(SIZE, GROUND, SIZE))))];
    let block = |i: usize| Vec3::new((i % BLOCKS) as f32, 0.0, (i / BLOCKS) as f32) * PITCH;
    let mut storeys = Vec::new();
    for i in 0..BLOCKS * BLOCKS {
        let corner = block(i) + Vec3::new(STREET, GROUND, STREET);
        storeys.push(building(&mut dice, corner, &mut objects));
        // Between the street and the pavement.
        let [first, ..] = sides(corner);
        objects.push(object("street railing", mesh(railing(&first, (4.0, WIDTH - 4.0), 0.0, -2.4))));
    }
    let ball = Arc::new(Mesh::ball(0));
    for _ in 0..(SMALL * options.scale) as usize {
        let i = (dice.range(0.0, 1.0) * storeys.len() as f32) as usize % storeys.len();
        let base = if dice.chance(0.4) {
            on_pavement(&mut dice, block(i))
        } else {
            // On a floor, or on the roof.
            let inside = Vec3::new(dice.range(1.0, WIDTH - 1.0), GROUND, dice.range(1.0, WIDTH - 1.0));
            let floor = dice.range(0.0, storeys[i] as f32 + 0.99).floor();
            block(i) + Vec3::new(STREET, floor * STOREY, STREET) + inside
        };
        objects.push(small_thing(&mut dice, &ball, base));
    }
    let walk = Walk { glance: 0.5, ..Walk::along(city::path(), options) };
    walk.through("town", objects, [Vec3::ZERO, Vec3::new(SIZE + 2.0, HEIGHT, SIZE + 2.0)], 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_abut_without_sharing_vertices_and_stay_within_the_wall() {
        let side = &sides(Vec3::ZERO)[0];
        let wall = facade(&mut Dice::new(1, 8), side, 4);
        assert!(wall.is_closed());
        let (lo, hi) = (Vec3::splat(-1e-4), Vec3::new(WIDTH, 4.0 * STOREY, THICK) + 1e-4);
        assert!(wall.positions.iter().all(|p| p.cmpge(lo).all() && p.cmple(hi).all()));
        // A corner of a panel of the second storey lies within an edge of one below.
        let at = |x: f32| wall.positions.iter().any(|p| p.distance(Vec3::new(x, STOREY, 0.0)) < 1e-4);
        assert!(at(WIDTH / 7.0) && at(WIDTH / 8.0));
    }
}
