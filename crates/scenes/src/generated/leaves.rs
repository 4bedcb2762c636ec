//! A wood on rolling ground, one mesh: trees of a trunk, branches and leaf quads around these, ferns
//! of such quads, and small things, seen from the height of a walker. Nothing but the small things is
//! closed, and all of it hides.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};

use super::motion::{Path, Walk};
use super::noise::Noise;
use super::options::SceneOptions;
use super::parts::{mesh, object, placed, prism};
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
const SIZE: f32 = 320.0;
/// Squares along each side, of two triangles each.
const SQUARES: usize = 160;
const PITCH: f32 = SIZE / SQUARES as f32;
/// Height of a walker's eyes.
const EYE: f32 = 1.7;
/// Metres between two places of a walk.
const STRIDE: f32 = 0.5;

const STOPS: [(f32, f32); 6] =
    [(290.0, 40.0), (220.0, 90.0), (240.0, 180.0), (130.0, 160.0), (90.0, 270.0), (30.0, 200.0)];

/// The mesh of the ground.
struct Ground(Mesh);

impl Ground {
    fn new(dice: &mut Dice) -> Self {
        let noise = Noise::new(dice);
        Self(Mesh::sheet(SQUARES as u32, SQUARES as u32, |i, j| {
            let p = Vec3::new(i as f32, 0.0, j as f32) * PITCH;
            let octave = |metres: f32, layer: f32| noise.at(p / metres + Vec3::Y * layer);
            p.with_y(20.0 + 11.0 * octave(60.0, 0.0) + 3.0 * octave(23.0, 3.0) + 0.35 * octave(7.0, 6.0))
        }))
    }

    /// Height of the triangles of the mesh at a place.
    fn at(&self, x: f32, z: f32) -> f32 {
        let (u, v) = ((x / PITCH).clamp(0.0, SQUARES as f32), (z / PITCH).clamp(0.0, SQUARES as f32));
        let (i, j) = ((u as usize).min(SQUARES - 1), (v as usize).min(SQUARES - 1));
        let (u, v) = (u - i as f32, v - j as f32);
        let corner = |di: usize, dj: usize| self.0.positions[(j + dj) * (SQUARES + 1) + i + di].y;
        let (near, far) = (corner(0, 0), corner(1, 1));
        // The diagonal goes from the least to the greatest corner.
        if u > v {
            near + (corner(1, 0) - near) * u + (far - corner(1, 0)) * v
        } else {
            near + (corner(0, 1) - near) * v + (far - corner(0, 1)) * u
        }
    }

    /// A walk over hills past places given by x and z, at the height of the eyes.
    fn path(&self, stops: &[(f32, f32)]) -> Path {
        let stops: Vec<Vec3> = stops.iter().map(|&(x, z)| Vec3::new(x, 0.0, z)).collect();
        let flat = Path::new(&stops);
        let mut eyes = flat.samples((flat.length() / STRIDE) as usize);
        eyes.iter_mut().for_each(|p| p.y = self.at(p.x, p.z) + EYE);
        Path::new(&eyes)
    }
}

/// Where things may stand: on the ground, and off the path.
struct Places {
    ground: Ground,
    path: Vec<Vec2>,
}

impl Places {
    fn new(ground: Ground, path: &Path) -> Self {
        let eyes = path.samples((path.length() / STRIDE) as usize);
        Self { ground, path: eyes.iter().map(|eye| Vec2::new(eye.x, eye.z)).collect() }
    }

    /// A place farther than `margin` from the path and the border.
    fn pick(&self, dice: &mut Dice, margin: f32) -> Vec3 {
        loop {
            let p = Vec2::new(dice.range(margin, SIZE - margin), dice.range(margin, SIZE - margin));
            if self.path.iter().all(|s| s.distance(p) > margin) {
                return Vec3::new(p.x, self.ground.at(p.x, p.y), p.y);
            }
        }
    }
}

/// The side of a prism around the y axis, without caps.
fn tube(sides: u32, radius: f32, low: f32, high: f32) -> Mesh {
    let mut tube = prism(sides);
    tube.triangles.retain(|t| t.iter().all(|&v| v < 2 * sides));
    tube.positions.truncate(2 * sides as usize);
    for p in &mut tube.positions {
        *p = Vec3::new(p.x * radius, low + p.y * (high - low), p.z * radius);
    }
    tube
}

/// A leaf, or a twig of leaves: two triangles.
fn leaf(dice: &mut Dice, middle: Vec3) -> Mesh {
    let axis = dice.point(Vec3::NEG_ONE, Vec3::ONE).normalize_or(Vec3::Y);
    let turn = Quat::from_axis_angle(axis, dice.range(0.0, TAU));
    let (x, y) = (turn * Vec3::X * dice.range(0.25, 0.4), turn * Vec3::Y * dice.range(0.25, 0.4));
    Mesh {
        positions: [-x - y, x - y, x + y, y - x].map(|p| middle + p).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

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
    let mut objects = vec![object("ground", mesh(ground.0.clone()))];
    let places = Places::new(ground, &path);
    let tree: fn(&mut Dice) -> Mesh = tree;
    for (name, count, off, model) in [("tree", TREES, OFF.0, tree), ("fern", FERNS, OFF.1, fern)] {
        let models = [(); MODELS].map(|()| Arc::new(model(&mut dice)));
        for i in 0..(count * options.scale) as usize {
            let (base, size) = (places.pick(&mut dice, off), Vec3::splat(dice.range(0.7, LARGEST)));
            objects.push(object(name, placed(&models[i % MODELS], size, dice.range(0.0, TAU), base)));
        }
    }
    let cuboid = Mesh::cuboid(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.5, 1.0, 0.5));
    let (stone, crate_) = (Arc::new(Mesh::ball(0)), Arc::new(cuboid));
    for _ in 0..(SMALL * options.scale) as usize {
        let base = places.pick(&mut dice, 2.0);
        let (size, turn) = (dice.point(Vec3::splat(0.2), Vec3::splat(0.9)), dice.range(0.0, TAU));
        let (name, model) = if dice.chance(0.5) { ("stone", &stone) } else { ("crate", &crate_) };
        objects.push(object(name, placed(model, size, turn, base)));
    }
    let walk = Walk { far: 500.0, ..Walk::along(path, options) };
    walk.through("leaves", objects, [Vec3::ZERO, Vec3::new(SIZE, 56.0, SIZE)], 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Shape;

    #[test]
    fn trees_stay_off_the_walk_and_their_leaves_are_apart() {
        let mut dice = Dice::new(5, 15);
        for tree in [(); 20].map(|()| tree(&mut dice)) {
            let reach = tree.positions.iter().map(|p| p.x.hypot(p.z)).fold(0.0, f32::max);
            assert!(reach * LARGEST < OFF.0 && !tree.is_closed(), "{reach} m");
            assert!(tree.triangles.len() > 2 * 7 * LEAVES);
        }
    }

    #[test]
    fn the_eye_is_at_a_walkers_height_and_things_stand_on_the_ground() {
        let world = build(&SceneOptions::default());
        let mut meshes = world.objects.iter().filter_map(|o| match &o.shape {
            Shape::Mesh { mesh, transform } => Some((o.name.as_str(), mesh, transform.translation)),
            _ => None,
        });
        let ground = Ground(Mesh::clone(meshes.next().unwrap().1));
        let stand = ["crate", "tree", "fern"];
        let bases: Vec<_> = meshes.filter(|(name, ..)| stand.contains(name)).map(|m| m.2).collect();
        assert!(bases.len() > 100 && bases.iter().all(|b| (b.y - ground.at(b.x, b.z)).abs() < 1e-3));
        for frame in 0..world.frames {
            let eye = world.camera(frame, 1.5).eye;
            let height = eye.y - ground.at(eye.x, eye.z);
            assert!((height - EYE).abs() < 0.05, "frame {frame}: {height} m above the ground");
            let off = bases.iter().map(|b| (eye.x - b.x).hypot(eye.z - b.z)).fold(f32::MAX, f32::min);
            assert!(off > 1.9, "frame {frame}: {off} m off what stands there");
        }
    }

    #[test]
    fn the_ground_between_corners_is_that_of_the_mesh() {
        let ground = Ground::new(&mut Dice::new(2, 6));
        let mesh = &ground.0;
        for t in mesh.triangles.iter().step_by(97) {
            let middle = t.map(|v| mesh.positions[v as usize]).iter().sum::<Vec3>() / 3.0;
            assert!((ground.at(middle.x, middle.z) - middle.y).abs() < 1e-3);
        }
    }
}
