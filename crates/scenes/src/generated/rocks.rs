//! Boulders: closed meshes of high curvature, a few models turned and scaled, and small things
//! between them.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};

use super::motion::{Path, Walk};
use super::noise::Noise;
use super::options::SceneOptions;
use super::parts::{beside, mesh, object, standing_box};
use crate::random::Dice;
use crate::world::{Mesh, Shape, World};

const SIZE: f32 = 100.0;
const HEIGHT: f32 = 20.0;
const GROUND: f32 = 1.0;
const MODELS: usize = 6;
const ROCKS: f32 = 250.0;
const SMALL: f32 = 1500.0;

/// A ball of 1,280 triangles with dents and bumps, of radius 1 at most.
fn rock(dice: &mut Dice) -> Mesh {
    let noise = Noise::new(dice);
    let mut rock = Mesh::ball(3);
    for p in &mut rock.positions {
        // The pattern lies away from the origin, where the lattice repeats for no direction.
        let octave = |scale: f32| noise.at(*p * scale + 7.5);
        *p *= (0.72 + 0.2 * octave(1.5) + 0.08 * octave(4.5)).min(1.0);
    }
    rock
}

fn path() -> Path {
    let at = |x, z| Vec3::new(x, GROUND + 1.7, z);
    Path::new(&[at(6.0, 8.0), at(34.0, 20.0), at(50.0, 52.0), at(22.0, 74.0), at(58.0, 92.0), at(93.0, 60.0)])
}

pub(super) fn build(options: &SceneOptions) -> World {
    let mut dice = Dice::new(options.seed, 7);
    let path = path();
    let eyes = path.samples(500);
    let spot = |dice: &mut Dice, margin: f32| beside(&eyes, dice, (SIZE, GROUND), margin);
    let ground = Mesh::cuboid(Vec3::ZERO, Vec3::new(SIZE, GROUND, SIZE));
    let mut objects = vec![object("ground", mesh(ground))];
    let models: Vec<Arc<Mesh>> = (0..MODELS).map(|_| Arc::new(rock(&mut dice))).collect();
    for _ in 0..(ROCKS * options.scale) as usize {
        let size =
            dice.point(Vec3::splat(0.8), Vec3::splat(1.6)) * (0.8 + 2.6 * dice.range(0.0, 1.0).powi(2));
        let base = spot(&mut dice, size.max_element() + 0.6);
        let axis = dice.point(Vec3::NEG_ONE, Vec3::ONE).normalize_or(Vec3::Y);
        let turn = Quat::from_axis_angle(axis, dice.range(0.0, TAU));
        // Clear of the bottom of the grid, however it is turned.
        let lift = size.max_element() * dice.range(0.5, 0.8);
        let transform = Affine3A::from_scale_rotation_translation(size, turn, base + Vec3::Y * lift);
        let model = &models[(dice.range(0.0, 1.0) * MODELS as f32) as usize % MODELS];
        objects.push(object("rock", Shape::Mesh { mesh: model.clone(), transform }));
    }
    for _ in 0..(SMALL * options.scale) as usize {
        let base = spot(&mut dice, 1.0);
        let size = dice.point(Vec3::splat(0.1), Vec3::splat(0.5));
        let mut thing = standing_box("thing", base, size);
        thing.occludes = dice.chance(0.5);
        objects.push(thing);
    }
    let walk = Walk { far: 250.0, ..Walk::along(path, options) };
    walk.through("rocks", objects, [Vec3::new(0.0, -2.0, 0.0), Vec3::new(SIZE, HEIGHT, SIZE)], 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rocks_are_closed_and_within_their_radius() {
        let rock = rock(&mut Dice::new(3, 7));
        assert!(rock.is_closed() && rock.triangles.len() == 1280);
        let radii: Vec<f32> = rock.positions.iter().map(|p| p.length()).collect();
        let (least, most) = radii.iter().fold((f32::INFINITY, 0.0f32), |(a, b), &r| (a.min(r), b.max(r)));
        assert!(least > 0.4 && most <= 1.0 && most - least > 0.2, "{least} to {most}");
    }
}
