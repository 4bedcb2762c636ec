//! A wood: thin trunks, foliage that one can see through, and little to hide.

use glam::Vec3;

use super::motion::{Moving, Path, Walk, Way};
use super::options::SceneOptions;
use super::parts::{beside, object, solid_box, standing_box};
use crate::random::Dice;
use crate::world::{Object, Shape, World};

const SIZE: f32 = 120.0;
const HEIGHT: f32 = 20.0;
const GROUND: f32 = 1.0;
const TREES: f32 = 2000.0;

fn path() -> Path {
    let at = |x, z| Vec3::new(x, GROUND + 1.7, z);
    Path::new(&[
        at(6.0, 8.0),
        at(40.0, 20.0),
        at(60.0, 60.0),
        at(30.0, 90.0),
        at(70.0, 110.0),
        at(112.0, 70.0),
    ])
}

pub(super) fn build(options: &SceneOptions) -> World {
    let mut dice = Dice::new(options.seed, 4);
    let path = path();
    let eyes = path.samples(600);
    let spot = |dice: &mut Dice, margin: f32| beside(&eyes, dice, (SIZE, GROUND), margin);
    let see_through = |name: &str, center: Vec3, radius: f32| Object {
        occludes: false,
        ..object(name, Shape::Sphere { center, radius })
    };
    let mut objects = vec![solid_box("ground", Vec3::ZERO, Vec3::new(SIZE, GROUND, SIZE))];
    for _ in 0..(TREES * options.scale) as usize {
        let base = spot(&mut dice, 2.2);
        let (width, height) = (dice.range(0.3, 0.6), dice.range(6.0, 12.0));
        objects.push(standing_box("trunk", base, Vec3::new(width, height, width)));
        let crown = base + Vec3::Y * (height + dice.range(-1.0, 1.0));
        objects.push(see_through("foliage", crown, dice.range(1.0, 2.1)));
    }
    for _ in 0..(200.0 * options.scale) as usize {
        let (base, radius) = (spot(&mut dice, 1.5), dice.range(0.3, 0.9));
        objects.push(see_through("bush", base + Vec3::Y * radius, radius));
    }
    for _ in 0..(100.0 * options.scale) as usize {
        let (center, radius) = (spot(&mut dice, 1.5), dice.range(0.2, 0.8));
        objects.push(object("stone", Shape::Sphere { center, radius }));
    }
    let mut moving = Vec::new();
    for _ in 0..20 {
        let base = spot(&mut dice, 6.0);
        objects.push(standing_box("animal", base, Vec3::new(0.5, 0.7, 1.1)));
        let reach = Vec3::new(dice.range(0.5, 3.0), 0.0, dice.range(0.5, 3.0));
        moving.push(Moving::last(&mut objects, Way::swing(&mut dice, reach, 3.0)));
    }
    let walk = Walk { moving, far: 250.0, ..Walk::along(path, options) };
    walk.through("forest", objects, [Vec3::ZERO, Vec3::new(SIZE, HEIGHT, SIZE)], 1.0)
}
