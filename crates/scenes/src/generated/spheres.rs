//! The scene of the thesis (section 4): clusters of spheres of varied sizes.

use glam::Vec3;

use super::motion::{Moving, Path, Walk, Way};
use super::options::SceneOptions;
use super::parts::{object, solid_box};
use crate::random::Dice;
use crate::world::{Object, Shape, World};

const SIZE: Vec3 = Vec3::new(100.0, 60.0, 100.0);
const STATIC: f32 = 4800.0;
const DYNAMIC: f32 = 200.0;
/// Room kept free around the path.
const CLEARANCE: f32 = 1.2;

fn path() -> Path {
    Path::new(&[
        Vec3::new(8.0, 28.0, 12.0),
        Vec3::new(34.0, 33.0, 18.0),
        Vec3::new(52.0, 30.0, 48.0),
        Vec3::new(30.0, 24.0, 72.0),
        Vec3::new(58.0, 30.0, 90.0),
        Vec3::new(88.0, 36.0, 66.0),
    ])
}

/// Six boxes between two boxes, one of which holds the other.
fn shell(name: &str, inner: [Vec3; 2], outer: [Vec3; 2]) -> Vec<Object> {
    let mut walls = Vec::new();
    for axis in 0..3 {
        for (from, to) in [(outer[0][axis], inner[0][axis]), (inner[1][axis], outer[1][axis])] {
            let [mut a, mut b] = outer;
            (a[axis], b[axis]) = (from, to);
            walls.push(solid_box(name, a, b));
        }
    }
    walls
}

/// A closed bunker beside the hall, with small spheres that move in it.
fn bunker(dice: &mut Dice, hidden: usize, objects: &mut Vec<Object>, moving: &mut Vec<Moving>) {
    let (lo, hi) = (Vec3::new(102.0, 2.0, 20.0), Vec3::new(130.0, 30.0, 80.0));
    objects.extend(shell("bunker", [lo + 2.0, hi - 2.0], [lo, hi]));
    for _ in 0..hidden {
        let reach = dice.point(Vec3::splat(0.1), Vec3::splat(1.0));
        let center = dice.point(lo + 2.0 + reach + 0.3, hi - 2.0 - reach - 0.3);
        objects.push(object("hidden sphere", Shape::Sphere { center, radius: 0.3 }));
        moving.push(Moving::last(objects, Way::swing(dice, reach, 1.0)));
    }
}

/// Walls around a box, and spheres beyond them, as densely as `density` of them in the box. Gives
/// the extent of all.
fn beyond_walls(
    dice: &mut Dice,
    [min, max]: [Vec3; 2],
    extra: usize,
    density: f32,
    objects: &mut Vec<Object>,
) -> (Vec3, Vec3) {
    const WALL: f32 = 2.0;
    let (lo, hi) = (min - WALL, max + WALL);
    objects.extend(shell("wall", [min, max], [lo, hi]));
    // The same number in each unit of volume, in a box of the same shape.
    let grown = (1.0 + extra as f32 / density).cbrt();
    let (middle, half) = ((lo + hi) * 0.5, (hi - lo) * 0.5 * grown);
    let mut left = extra;
    while left > 0 {
        let radius = 0.5 + 5.0 * dice.range(0.0, 1.0).powi(7);
        let center = dice.point(middle - half, middle + half);
        if center.cmpgt(lo - radius).all() && center.cmplt(hi + radius).all() {
            continue;
        }
        objects.push(object("sphere beyond", Shape::Sphere { center, radius }));
        left -= 1;
    }
    ((middle - half - 6.0).min(lo), (middle + half + 6.0).max(hi))
}

pub(super) fn build(options: &SceneOptions) -> World {
    let mut dice = Dice::new(options.seed, 1);
    let path = path();
    let samples = path.samples(400);
    let free = |center: Vec3, reach: f32| samples.iter().all(|p| p.distance(center) > reach + CLEARANCE);
    let clusters: Vec<(Vec3, f32)> =
        (0..70).map(|_| (dice.point(Vec3::ZERO, SIZE), dice.range(4.0, 16.0))).collect();
    let place = |dice: &mut Dice, reach: Vec3| loop {
        // A few large spheres, many small ones; centres gather in clusters.
        let radius = 0.5 + 5.0 * dice.range(0.0, 1.0).powi(7);
        let center = if dice.chance(0.8) {
            let (middle, spread) = clusters[dice.range(0.0, 69.99) as usize];
            let offset = dice.point(Vec3::NEG_ONE, Vec3::ONE) + dice.point(Vec3::NEG_ONE, Vec3::ONE);
            middle + offset * spread * 0.5
        } else {
            dice.point(Vec3::ZERO, SIZE)
        };
        let margin = reach + radius;
        let inside = center.cmpgt(margin).all() && center.cmplt(SIZE - margin).all();
        if inside && free(center, radius + reach.length()) {
            return Shape::Sphere { center, radius };
        }
    };
    let mut objects: Vec<Object> = Vec::new();
    for _ in 0..(STATIC * options.scale) as usize {
        let shape = place(&mut dice, Vec3::ZERO);
        objects.push(object("sphere", shape));
    }
    let mut moving = Vec::new();
    for _ in 0..(DYNAMIC * options.scale) as usize {
        let reach = dice.point(Vec3::splat(0.5), Vec3::splat(4.0));
        let shape = place(&mut dice, reach);
        objects.push(object("moving sphere", shape));
        let speed = dice.range(0.5, 4.0);
        moving.push(Moving::last(&mut objects, Way::swing(&mut dice, reach, speed)));
    }
    let mut max = SIZE;
    if let Some(hidden) = options.bunker {
        max.x = 132.0;
        bunker(&mut dice, hidden, &mut objects, &mut moving);
    }
    let mut min = Vec3::ZERO;
    if let Some(extra) = options.beyond_walls {
        let density = STATIC * options.scale;
        (min, max) = beyond_walls(&mut dice, [min, max], extra, density, &mut objects);
    }
    let walk = Walk { moving, fov_y: 55.0, far: 300.0, ..Walk::along(path, options) };
    walk.through("spheres", objects, [min, max], 1.0)
}
