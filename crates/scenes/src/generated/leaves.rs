//! A wood on hills: trees of a trunk, branches and leaf quads around these, ferns of such quads, and
//! small things. Nothing of it is closed, and all of it hides.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Quat, Vec3};

use super::ground::{self, Ground, Places};
use super::options::SceneOptions;
use super::parts::{mesh, object, placed};
use super::valley::{leaf, tube};
use crate::random::Dice;
use crate::world::{Mesh, World};

const TREES: f32 = 1300.0;
const FERNS: f32 = 900.0;
const SMALL: f32 = 300.0;
const MODELS: usize = 6;
/// Leaf quads around a branch, and of a fern.
const LEAVES: usize = 22;
/// Trees are up to this many times as large as their models.
const LARGEST: f32 = 1.2;
/// No trunk is closer to the walk, and no fern.
const OFF: (f32, f32) = (4.9, 2.0);

const STOPS: [(f32, f32); 6] =
    [(290.0, 40.0), (220.0, 90.0), (240.0, 180.0), (130.0, 160.0), (90.0, 270.0), (30.0, 200.0)];

/// A tree of about 10 m with seven to ten branches that go outwards and up.
fn tree(dice: &mut Dice) -> Mesh {
    let height = dice.range(7.0, 10.0);
    let mut tree = tube(7, dice.range(0.2, 0.35), -1.0, height);
    let branches = dice.range(7.0, 10.99) as usize;
    for i in 0..branches {
        let turn = Quat::from_rotation_y(TAU * (0.38 * i as f32 + dice.range(0.0, 0.1)));
        let ahead = turn * Vec3::new(1.0, dice.range(0.1, 0.7), 0.0).normalize();
        let at = Vec3::Y * height * (0.3 + 0.65 * i as f32 / branches as f32);
        let length = dice.range(0.7, 1.0) * (2.6 - 1.2 * i as f32 / branches as f32);
        let mut branch = tube(4, 0.07, 0.0, length);
        let lie = Quat::from_rotation_arc(Vec3::Y, ahead);
        branch.positions.iter_mut().for_each(|p| *p = lie * *p + at);
        tree.append(branch);
        for _ in 0..LEAVES {
            let middle = at + ahead * length * dice.range(0.35, 1.1) + dice.ball() * 0.9;
            tree.append(leaf(dice, middle));
        }
    }
    tree
}

fn fern(dice: &mut Dice) -> Mesh {
    let mut fern = Mesh::default();
    for _ in 0..LEAVES {
        let middle = Vec3::Y * 0.45 + dice.ball() * Vec3::new(0.7, 0.4, 0.7);
        fern.append(leaf(dice, middle));
    }
    fern
}

pub(super) fn build(options: &SceneOptions) -> World {
    let mut dice = Dice::new(options.seed, 15);
    let ground = Ground::new(&mut dice);
    let path = ground.path(&STOPS);
    let mut objects = vec![object("ground", mesh(ground.mesh()))];
    let places = Places::new(ground, &path);
    let tree: fn(&mut Dice) -> Mesh = tree;
    for (name, count, off, model) in [("tree", TREES, OFF.0, tree), ("fern", FERNS, OFF.1, fern)] {
        let models = [(); MODELS].map(|()| Arc::new(model(&mut dice)));
        for i in 0..(count * options.scale) as usize {
            let (base, size) = (places.pick(&mut dice, off), Vec3::splat(dice.range(0.7, LARGEST)));
            objects.push(object(name, placed(&models[i % MODELS], size, dice.range(0.0, TAU), base)));
        }
    }
    ground::small_things(&mut dice, &places, (SMALL * options.scale) as usize, &mut objects);
    ground::world("leaves", objects, path, options)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trees_stay_off_the_walk_and_their_leaves_are_apart() {
        let mut dice = Dice::new(5, 15);
        for tree in [(); 20].map(|()| tree(&mut dice)) {
            let reach = tree.positions.iter().map(|p| p.x.hypot(p.z)).fold(0.0, f32::max);
            assert!(reach * LARGEST < OFF.0 && !tree.is_closed(), "{reach} m");
            assert!(tree.triangles.len() > 2 * 7 * LEAVES);
        }
    }
}
