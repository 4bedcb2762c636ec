//! Rolling ground, one mesh, with trees, houses and small things on it, seen from the height of a
//! walker.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::Vec3;

use super::ground::{self, Ground, Places};
use super::options::SceneOptions;
use super::parts::{mesh, object, placed, prism};
use crate::random::Dice;
use crate::world::{Mesh, Object, World};

const TREES: f32 = 320.0;
const HOUSES: f32 = 60.0;
const SMALL: f32 = 260.0;

const STOPS: [(f32, f32); 6] =
    [(20.0, 30.0), (90.0, 60.0), (150.0, 150.0), (100.0, 230.0), (190.0, 280.0), (290.0, 190.0)];

fn trees(dice: &mut Dice, places: &Places, count: usize, objects: &mut Vec<Object>) {
    let (trunk, crown) = (Arc::new(prism(6)), Arc::new(Mesh::ball(1)));
    for _ in 0..count {
        let base = places.pick(dice, 4.5);
        let (width, height) = (dice.range(0.15, 0.4), dice.range(3.0, 8.0));
        let size = Vec3::new(width, height + 0.5, width);
        objects.push(object("trunk", placed(&trunk, size, dice.range(0.0, TAU), base - Vec3::Y * 0.5)));
        let size = dice.point(Vec3::new(1.2, 1.5, 1.2), Vec3::new(3.2, 4.0, 3.2));
        let middle = base + Vec3::Y * (height + size.y * 0.6);
        objects.push(object("crown", placed(&crown, size, dice.range(0.0, TAU), middle)));
    }
}

pub(super) fn build(options: &SceneOptions) -> World {
    let mut dice = Dice::new(options.seed, 6);
    let ground = Ground::new(&mut dice);
    let path = ground.path(&STOPS);
    let mut objects = vec![object("ground", mesh(ground.mesh()))];
    let places = Places::new(ground, &path);
    let count = |n: f32| (n * options.scale) as usize;
    trees(&mut dice, &places, count(TREES), &mut objects);
    ground::houses(&mut dice, &places, count(HOUSES), &mut objects);
    ground::small_things(&mut dice, &places, count(SMALL), &mut objects);
    ground::world("terrain", objects, path, options)
}
