//! Rolling ground, one mesh, with trees, houses and small things on it, seen from the height of a
//! walker.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Affine3A, Quat, Vec2, Vec3};

use super::dice::Dice;
use super::motion::{Path, Walk};
use super::noise::Noise;
use super::options::SceneOptions;
use super::parts::{mesh, object};
use crate::world::{GridHint, Mesh, Object, Shape, World};

const SIZE: f32 = 320.0;
/// Squares along each side, of two triangles each.
const SQUARES: usize = 160;
const PITCH: f32 = SIZE / SQUARES as f32;
const EYE: f32 = 1.7;
const TREES: f32 = 320.0;
const HOUSES: f32 = 60.0;
const SMALL: f32 = 260.0;

/// Heights above corners of squares.
struct Ground(Vec<f32>);

impl Ground {
    fn new(dice: &mut Dice) -> Self {
        let noise = Noise::new(dice);
        let side = SQUARES + 1;
        let height = |i: usize| {
            let p = Vec3::new((i % side) as f32, 0.0, (i / side) as f32) * PITCH;
            let octave = |metres: f32, layer: f32| noise.at(p / metres + Vec3::Y * layer);
            20.0 + 11.0 * octave(60.0, 0.0) + 3.0 * octave(23.0, 3.0) + 0.35 * octave(7.0, 6.0)
        };
        Self((0..side * side).map(height).collect())
    }

    /// Height of the triangles of the mesh at a place.
    fn at(&self, x: f32, z: f32) -> f32 {
        let (u, v) = ((x / PITCH).clamp(0.0, SQUARES as f32), (z / PITCH).clamp(0.0, SQUARES as f32));
        let (i, j) = ((u as usize).min(SQUARES - 1), (v as usize).min(SQUARES - 1));
        let (u, v) = (u - i as f32, v - j as f32);
        let corner = |di: usize, dj: usize| self.0[(j + dj) * (SQUARES + 1) + i + di];
        let (near, far) = (corner(0, 0), corner(1, 1));
        // The diagonal goes from the least to the greatest corner.
        if u > v {
            near + (corner(1, 0) - near) * u + (far - corner(1, 0)) * v
        } else {
            near + (corner(0, 1) - near) * v + (far - corner(0, 1)) * u
        }
    }

    fn mesh(&self) -> Mesh {
        let side = SQUARES + 1;
        let corner =
            |(i, &y): (usize, &f32)| Vec3::new((i % side) as f32 * PITCH, y, (i / side) as f32 * PITCH);
        let mut triangles = Vec::with_capacity(2 * SQUARES * SQUARES);
        for square in 0..SQUARES * SQUARES {
            let a = (square / SQUARES * side + square % SQUARES) as u32;
            let (b, c, d) = (a + 1, a + side as u32, a + side as u32 + 1);
            triangles.extend([[a, d, b], [a, c, d]]);
        }
        Mesh { positions: self.0.iter().enumerate().map(corner).collect(), triangles }
    }

    /// A walk over hills, at the height of the eyes.
    fn path(&self) -> Path {
        let stops =
            [(20.0, 30.0), (90.0, 60.0), (150.0, 150.0), (100.0, 230.0), (190.0, 280.0), (290.0, 190.0)];
        let flat = Path::new(&stops.map(|(x, z)| Vec3::new(x, 0.0, z)));
        let steps = (flat.length() / 0.5) as usize;
        let at = |i: usize| {
            let p = flat.at(flat.length() * i as f32 / steps as f32);
            p + Vec3::Y * (self.at(p.x, p.z) + EYE)
        };
        Path::new(&(0..=steps).map(at).collect::<Vec<_>>())
    }
}

/// A prism of so many sides around the y axis, of radius 1 and from y = 0 to 1.
fn prism(sides: u32) -> Mesh {
    let rim = |i: u32, y: f32| {
        let (sin, cos) = (TAU * i as f32 / sides as f32).sin_cos();
        Vec3::new(cos, y, sin)
    };
    let mut positions: Vec<Vec3> = (0..sides).flat_map(|i| [rim(i, 0.0), rim(i, 1.0)]).collect();
    positions.extend([Vec3::ZERO, Vec3::Y]);
    let triangle = |i: u32| {
        let (a, b) = (2 * i, 2 * ((i + 1) % sides));
        [[a, a + 1, b + 1], [a, b + 1, b], [2 * sides, a, b], [2 * sides + 1, b + 1, a + 1]]
    };
    Mesh { positions, triangles: (0..sides).flat_map(triangle).collect() }
}

/// A roof over the square from -1 to 1 in x and z, with its ridge along z at y = 1.
fn roof() -> Mesh {
    let corners = [(-1.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
    let positions = [-1.0, 1.0].into_iter().flat_map(|z| corners.map(|(x, y)| Vec3::new(x, y, z)));
    Mesh {
        positions: positions.collect(),
        triangles: vec![
            [0, 2, 1],
            [3, 4, 5],
            [0, 1, 4],
            [0, 4, 3],
            [1, 2, 5],
            [1, 5, 4],
            [2, 0, 3],
            [2, 3, 5],
        ],
    }
}

/// A mesh scaled, turned about the y axis and placed.
fn placed(mesh: &Arc<Mesh>, size: Vec3, turn: f32, at: Vec3) -> Shape {
    let transform = Affine3A::from_scale_rotation_translation(size, Quat::from_rotation_y(turn), at);
    Shape::Mesh { mesh: mesh.clone(), transform }
}

/// Where things may stand: on the ground, and off the path.
struct Places {
    ground: Ground,
    path: Vec<Vec2>,
}

impl Places {
    fn pick(&self, dice: &mut Dice, margin: f32) -> Vec3 {
        loop {
            let p = Vec2::new(dice.range(margin, SIZE - margin), dice.range(margin, SIZE - margin));
            if self.path.iter().all(|s| s.distance(p) > margin) {
                return Vec3::new(p.x, self.ground.at(p.x, p.y), p.y);
            }
        }
    }
}

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

fn houses(dice: &mut Dice, places: &Places, count: usize, objects: &mut Vec<Object>) {
    let walls = Arc::new(Mesh::cuboid(Vec3::new(-1.0, 0.0, -1.0), Vec3::ONE));
    let roof = Arc::new(roof());
    for _ in 0..count {
        let base = places.pick(dice, 12.0) - Vec3::Y * 2.0;
        let (half, turn) =
            (dice.point(Vec3::new(3.0, 5.0, 4.0), Vec3::new(5.0, 8.5, 7.0)), dice.range(0.0, TAU));
        objects.push(object("house", placed(&walls, half, turn, base)));
        // The eaves stick out.
        let over = Vec3::new(half.x + 0.5, dice.range(2.0, 4.0), half.z + 0.5);
        objects.push(object("roof", placed(&roof, over, turn, base + Vec3::Y * half.y)));
    }
}

fn small_things(dice: &mut Dice, places: &Places, count: usize, objects: &mut Vec<Object>) {
    let (stone, crate_) = (
        Arc::new(Mesh::ball(0)),
        Arc::new(Mesh::cuboid(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.5, 1.0, 0.5))),
    );
    for _ in 0..count {
        let base = places.pick(dice, 2.0);
        let (size, turn) = (dice.point(Vec3::splat(0.2), Vec3::splat(0.9)), dice.range(0.0, TAU));
        let (name, model) = if dice.chance(0.5) { ("stone", &stone) } else { ("crate", &crate_) };
        objects.push(object(name, placed(model, size, turn, base)));
    }
}

pub(super) fn build(options: &SceneOptions) -> World {
    let mut dice = Dice::new(options.seed, 6);
    let ground = Ground::new(&mut dice);
    let path = ground.path();
    let mut objects = vec![object("ground", mesh(ground.mesh()))];
    let steps = (path.length() / 0.5) as usize;
    let at = |i: usize| path.at(path.length() * i as f32 / steps as f32);
    let places = Places { ground, path: (0..=steps).map(|i| Vec2::new(at(i).x, at(i).z)).collect() };
    let count = |n: f32| (n * options.scale) as usize;
    trees(&mut dice, &places, count(TREES), &mut objects);
    houses(&mut dice, &places, count(HOUSES), &mut objects);
    small_things(&mut dice, &places, count(SMALL), &mut objects);
    World {
        name: "terrain".to_owned(),
        objects,
        grid: GridHint { min: Vec3::ZERO, max: Vec3::new(SIZE, 56.0, SIZE), cell: 2.0 },
        frames: options.frames,
        animation: Box::new(Walk {
            swinging: Vec::new(),
            sliding: Vec::new(),
            path,
            frames: options.frames,
            fov_y: 60.0,
            glance: 0.6,
            far: 500.0,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_eye_is_at_a_walkers_height_and_things_stand_on_the_ground() {
        let ground = Ground::new(&mut Dice::new(1, 6));
        let world = build(&SceneOptions::default());
        for frame in 0..world.frames {
            let eye = world.camera(frame, 1.5).eye;
            let height = eye.y - ground.at(eye.x, eye.z);
            assert!((height - EYE).abs() < 0.05, "frame {frame}: {height} m above the ground");
        }
        for crate_ in world.objects.iter().filter(|o| o.name == "crate") {
            let Shape::Mesh { transform, .. } = &crate_.shape else { panic!("a crate is a mesh") };
            let base = transform.translation;
            assert!((base.y - ground.at(base.x, base.z)).abs() < 1e-3);
        }
    }

    #[test]
    fn the_ground_between_corners_is_that_of_the_mesh() {
        let ground = Ground::new(&mut Dice::new(2, 6));
        let mesh = ground.mesh();
        for t in mesh.triangles.iter().step_by(97) {
            let middle = t.map(|v| mesh.positions[v as usize]).iter().sum::<Vec3>() / 3.0;
            assert!((ground.at(middle.x, middle.z) - middle.y).abs() < 1e-3);
        }
    }

    #[test]
    fn models_are_closed() {
        assert!([prism(6), roof()].iter().all(Mesh::is_closed));
        assert!(!Ground::new(&mut Dice::new(2, 6)).mesh().is_closed());
    }
}
