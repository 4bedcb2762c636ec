//! A wood on rolling ground: firs of open cones and broadleaf trees of separate leaves, which are
//! no solids, with houses and small things between them, seen from the height of a walker.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};

use super::ground::{self, Ground, Places};
use super::options::SceneOptions;
use super::parts::{mesh, object, placed, prism};
use crate::random::Dice;
use crate::world::{Mesh, Object, Shape, World};

const TREES: f32 = 2500.0;
const HOUSES: f32 = 40.0;
const SMALL: f32 = 600.0;
/// Models of firs, and as many of broadleaf trees.
const MODELS: usize = 4;
const LEAVES: usize = 60;
/// No tree is wider, measured from the middle of its trunk.
const REACH: f32 = 3.2;
/// Trees are up to this many times as large as their models.
const LARGEST: f32 = 1.2;
/// Depth of trunks in the ground.
const ROOT: f32 = 0.8;
/// Tries for a place outside houses.
const TRIES: usize = 20;

const STOPS: [(f32, f32); 6] =
    [(30.0, 20.0), (60.0, 110.0), (150.0, 90.0), (210.0, 170.0), (120.0, 250.0), (280.0, 290.0)];

/// The side of a prism around the y axis, without caps.
pub(super) fn tube(sides: u32, radius: f32, low: f32, high: f32) -> Mesh {
    let mut tube = prism(sides);
    tube.triangles.retain(|t| t.iter().all(|&v| v < 2 * sides));
    tube.positions.truncate(2 * sides as usize);
    for p in &mut tube.positions {
        *p = Vec3::new(p.x * radius, low + p.y * (high - low), p.z * radius);
    }
    tube
}

/// The side of a cone around the y axis, without its base.
fn cone(sides: u32, radius: f32, low: f32, high: f32) -> Mesh {
    let rim = |i: u32| {
        let (sin, cos) = (TAU * i as f32 / sides as f32).sin_cos();
        Vec3::new(cos * radius, low, sin * radius)
    };
    let mut positions: Vec<Vec3> = (0..sides).map(rim).collect();
    positions.push(Vec3::Y * high);
    Mesh {
        positions,
        triangles: (0..sides).map(|i| [i, sides, (i + 1) % sides]).collect(),
        ..Mesh::default()
    }
}

/// A trunk below three cones, each of which starts inside the one below.
fn fir(dice: &mut Dice) -> Mesh {
    let sides = dice.range(8.0, 10.99) as u32;
    let (mut low, mut radius) = (dice.range(1.4, 2.0), dice.range(1.8, 2.3));
    let mut fir = tube(6, dice.range(0.18, 0.3), -ROOT, low + 0.8);
    for _ in 0..3 {
        let height = radius * dice.range(1.4, 1.6);
        fir.append(cone(sides, radius, low, low + height));
        (low, radius) = (low + 0.6 * height, 0.78 * radius);
    }
    fir
}

/// A leaf, or a twig of leaves: two triangles.
pub(super) fn leaf(dice: &mut Dice, middle: Vec3) -> Mesh {
    let axis = dice.point(Vec3::NEG_ONE, Vec3::ONE).normalize_or(Vec3::Y);
    let turn = Quat::from_axis_angle(axis, dice.range(0.0, TAU));
    let (x, y) = (turn * Vec3::X * dice.range(0.25, 0.4), turn * Vec3::Y * dice.range(0.25, 0.4));
    Mesh {
        positions: [-x - y, x - y, x + y, y - x].map(|p| middle + p).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// A trunk below leaves that do not touch it.
fn broadleaf(dice: &mut Dice) -> Mesh {
    let height = dice.range(2.5, 3.5);
    let mut tree = tube(6, dice.range(0.18, 0.3), -ROOT, height);
    let half = dice.point(Vec3::new(1.5, 1.4, 1.5), Vec3::new(2.0, 2.0, 2.0));
    let middle = Vec3::Y * (height + 0.5 * half.y);
    for _ in 0..LEAVES {
        let p = dice.point(Vec3::NEG_ONE, Vec3::ONE);
        // More of them near the outside of the crown.
        let p = p.normalize_or(Vec3::Y) * p.length().min(1.0).sqrt();
        tree.append(leaf(dice, middle + p * half));
    }
    tree
}

fn trees(dice: &mut Dice, places: &Places, count: usize, objects: &mut Vec<Object>) {
    let models = |dice: &mut Dice, name: &'static str, model: fn(&mut Dice) -> Mesh| {
        [(); MODELS].map(|()| (name, Arc::new(model(dice))))
    };
    let (firs, broadleaves) = (models(dice, "fir", fir), models(dice, "broadleaf", broadleaf));
    let house = |o: &Object| match &o.shape {
        Shape::Mesh { transform, .. } if o.name == "house" => Some(Vec3::from(transform.translation)),
        _ => None,
    };
    let houses: Vec<Vec3> = objects.iter().filter_map(house).collect();
    let flat = |p: Vec3| Vec2::new(p.x, p.z);
    for _ in 0..count {
        let mut base = places.pick(dice, REACH);
        for _ in 1..TRIES {
            if houses.iter().all(|&h| flat(h).distance(flat(base)) > 9.0) {
                break;
            }
            base = places.pick(dice, REACH);
        }
        let kind = if dice.chance(0.6) { &firs } else { &broadleaves };
        let (name, model) = &kind[(dice.range(0.0, 1.0) * MODELS as f32) as usize % MODELS];
        let size = dice.range(0.7, LARGEST) * Vec3::new(1.0, dice.range(0.85, 1.15), 1.0);
        objects.push(object(name, placed(model, size, dice.range(0.0, TAU), base)));
    }
}

pub(super) fn build(options: &SceneOptions) -> World {
    let mut dice = Dice::new(options.seed, 12);
    let ground = Ground::new(&mut dice);
    let path = ground.path(&STOPS);
    let mut objects = vec![object("ground", mesh(ground.mesh()))];
    let places = Places::new(ground, &path);
    let count = |n: f32| (n * options.scale) as usize;
    ground::houses(&mut dice, &places, count(HOUSES), &mut objects);
    trees(&mut dice, &places, count(TREES), &mut objects);
    ground::small_things(&mut dice, &places, count(SMALL), &mut objects);
    ground::world("valley", objects, path, options)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trees_are_open_and_not_too_wide() {
        let mut dice = Dice::new(5, 12);
        for _ in 0..20 {
            for tree in [fir(&mut dice), broadleaf(&mut dice)] {
                assert!(!tree.is_closed());
                let reach = tree.positions.iter().map(|p| p.x.hypot(p.z)).fold(0.0, f32::max);
                assert!(reach * LARGEST < REACH, "{reach} m");
            }
        }
        let mut capped = cone(8, 2.0, 0.0, 3.0);
        capped.triangles.extend((1..7).map(|i| [0, i, i + 1]));
        assert!(capped.is_closed(), "nothing but its base is missing");
    }
}
