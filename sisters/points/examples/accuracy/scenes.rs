//! Scenes of triangles, made by rules: kinds that the defaults of `surface` were chosen on,
//! and others that they were not.

use glam::{Mat3, Quat, Vec3, vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f32::consts::{PI, TAU};

/// Triangles of which twice the area is less, in square metres, are lines.
const LEAST_CROSS: f32 = 1e-12;

/// Triangles, and eyes that look at them.
pub struct Scene {
    pub name: &'static str,
    pub triangles: Vec<[Vec3; 3]>,
    pub eyes: Vec<Vec3>,
}

/// The scenes that defaults were chosen on, and those that they were not.
pub fn tuned(seed: u64) -> Vec<Scene> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    vec![boards(&mut random), fence(&mut random), solids()]
}

pub fn held_out(seed: u64) -> Vec<Scene> {
    let mut random = Pcg64Mcg::seed_from_u64(seed ^ 0x5eed);
    vec![tree(&mut random), pipes(&mut random)]
}

/// Triangles that grow.
#[derive(Default)]
struct Build(Vec<[Vec3; 3]>);

impl Build {
    fn quad(&mut self, [a, b, c, d]: [Vec3; 4]) {
        self.0.extend([[a, b, c], [a, c, d]]);
    }

    /// A box with half sides, turned about its middle.
    fn turned(&mut self, middle: Vec3, half: Vec3, turn: Quat) {
        for axis in 0..3 {
            for side in [-1.0_f32, 1.0] {
                let [mut n, mut u, mut v] = [Vec3::ZERO; 3];
                n[axis] = side * half[axis];
                u[(axis + 1) % 3] = half[(axis + 1) % 3] * side;
                v[(axis + 2) % 3] = half[(axis + 2) % 3];
                let corner = |a: f32, b: f32| middle + turn * (n + u * a + v * b);
                self.quad([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
            }
        }
    }

    fn cuboid(&mut self, low: Vec3, high: Vec3) {
        self.turned((low + high) / 2.0, (high - low) / 2.0, Quat::IDENTITY);
    }

    /// A closed tube of changing radius around a line.
    fn tube(&mut self, [from, to]: [Vec3; 2], [r, s]: [f32; 2], sides: usize) {
        let axis = (to - from).normalize();
        let (u, v) = axis.any_orthonormal_pair();
        let at = |i: usize, middle: Vec3, r: f32| {
            let (y, x) = (TAU * i as f32 / sides as f32).sin_cos();
            middle + (u * x + v * y) * r
        };
        for i in 0..sides {
            let j = (i + 1) % sides;
            self.quad([at(i, from, r), at(j, from, r), at(j, to, s), at(i, to, s)]);
            self.0.push([from, at(j, from, r), at(i, from, r)]);
            self.0.push([to, at(i, to, s), at(j, to, s)]);
        }
    }

    /// A surface of two parameters from 0 to 1, with its fronts where `du x dv` points.
    fn patch(&mut self, steps: [usize; 2], at: impl Fn(f32, f32) -> Vec3) {
        let corner = |i: usize, j: usize| at(i as f32 / steps[0] as f32, j as f32 / steps[1] as f32);
        for i in 0..steps[0] {
            for j in 0..steps[1] {
                self.quad([corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]);
            }
        }
    }

    fn ball(&mut self, middle: Vec3, r: f32) {
        self.patch([32, 16], |u, v| {
            let ((sin, cos), (y, x)) = ((PI * (v - 0.5)).sin_cos(), (TAU * u).sin_cos());
            middle + r * vec3(cos * x, cos * y, sin)
        });
    }

    /// A plate on four legs.
    fn table(&mut self, at: Vec3, half: Vec3) {
        self.cuboid(at + vec3(-half.x, half.y - 0.03, -half.z), at + half);
        for (x, z) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let leg = at + vec3(x * (half.x - 0.03), 0.0, z * (half.z - 0.03));
            self.cuboid(leg - vec3(0.02, 0.0, 0.02), leg + vec3(0.02, half.y - 0.03, 0.02));
        }
    }

    fn tree(&mut self, random: &mut Pcg64Mcg) {
        self.tube([Vec3::ZERO, vec3(0.1, 2.4, 0.0)], [0.16, 0.1], 14);
        for _ in 0..14 {
            let from = vec3(0.05, random.random_range(1.0..2.4), 0.0);
            let to = from + (direction(random) + Vec3::Y * 0.5) * random.random_range(0.6..1.3);
            self.tube([from, to], [0.04, 0.015], 8);
            for _ in 0..22 {
                let at = from.lerp(to, random.random_range(0.3..1.0)) + direction(random) * 0.2;
                self.leaf(at, random);
            }
        }
    }

    fn leaf(&mut self, at: Vec3, random: &mut Pcg64Mcg) {
        let q = turn(random);
        let leaf = |x: f32, y: f32| at + q * vec3(x * 0.07, y * 0.11, 0.0);
        self.quad([leaf(-1.0, 0.0), leaf(0.0, -1.0), leaf(1.0, 0.0), leaf(0.0, 1.0)]);
    }

    /// Adds triangles of another, moved.
    fn add(&mut self, other: &[[Vec3; 3]], by: Vec3) {
        self.0.extend(other.iter().map(|t| t.map(|p| p + by)));
    }

    fn scene(self, name: &'static str, eyes: &[Vec3]) -> Scene {
        let whole = |t: &&[Vec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]).length() > LEAST_CROSS;
        Scene { name, triangles: self.0.iter().filter(whole).copied().collect(), eyes: eyes.to_vec() }
    }
}

fn direction(random: &mut Pcg64Mcg) -> Vec3 {
    loop {
        let v = Vec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0_f32)));
        if v.length_squared() > 0.01 && v.length_squared() < 1.0 {
            return v.normalize();
        }
    }
}

fn turn(random: &mut Pcg64Mcg) -> Quat {
    Quat::from_axis_angle(direction(random), random.random_range(0.0..TAU))
}

fn boards(random: &mut Pcg64Mcg) -> Scene {
    let mut build = Build::default();
    for _ in 0..24 {
        let middle = vec3(
            random.random_range(-2.0..2.0),
            random.random_range(-1.5..1.5),
            random.random_range(-2.0..2.0),
        );
        let half = vec3(random.random_range(0.3..0.8), random.random_range(0.2..0.5), 0.012);
        build.turned(middle, half, turn(random));
    }
    build.scene("thin boards", &[vec3(5.0, 2.0, 4.0), vec3(-6.0, 0.5, 1.0), vec3(0.5, 5.0, -3.0)])
}

fn fence(random: &mut Pcg64Mcg) -> Scene {
    let mut build = Build::default();
    build.cuboid(vec3(-4.0, -0.2, -3.0), vec3(4.0, 0.0, 3.0));
    for i in 0..48 {
        let x = -3.8 + 7.6 * i as f32 / 47.0;
        let high = 1.1 + random.random_range(-0.05..0.05);
        build.cuboid(vec3(x - 0.045, 0.0, -0.012), vec3(x + 0.045, high, 0.012));
    }
    for y in [0.25, 0.8] {
        build.cuboid(vec3(-3.9, y, -0.05), vec3(3.9, y + 0.09, -0.012));
    }
    for x in [-2.6, 0.3, 2.2] {
        build.cuboid(vec3(x, 0.0, -2.0), vec3(x + 0.8, 0.9, -1.3));
    }
    build.scene("fence", &[vec3(1.0, 1.5, 5.0), vec3(-3.0, 1.2, 3.5), vec3(2.0, 2.5, -5.0)])
}

fn solids() -> Scene {
    let mut build = Build::default();
    build.ball(vec3(-1.4, 0.0, 0.0), 1.0);
    build.turned(vec3(1.3, 0.0, 0.3), vec3(0.8, 0.8, 0.8), Quat::from_rotation_y(0.4));
    build.patch([48, 24], |u, v| {
        let (a, b) = (Mat3::from_rotation_z(TAU * u), TAU * v);
        vec3(0.0, 0.4, -2.4) + a * vec3(1.1 + 0.4 * b.cos(), 0.0, 0.4 * b.sin())
    });
    build.scene("thick solids", &[vec3(2.0, 3.0, 6.0), vec3(-6.0, 1.0, 2.0), vec3(4.0, 2.5, -6.0)])
}

/// A tree whose leaves are sheets of one side each.
fn tree(random: &mut Pcg64Mcg) -> Scene {
    let mut build = Build::default();
    build.cuboid(vec3(-3.0, -0.2, -3.0), vec3(3.0, 0.0, 3.0));
    build.tree(random);
    build.scene("tree", &[vec3(4.0, 1.7, 3.0), vec3(-3.0, 3.0, 4.0), vec3(0.5, 0.8, -5.0)])
}

fn pipes(random: &mut Pcg64Mcg) -> Scene {
    let mut build = Build::default();
    build.cuboid(vec3(-3.0, -0.1, -2.2), vec3(3.0, 3.0, -2.0));
    for i in 0..36 {
        let r = random.random_range(0.03..0.16);
        let [a, b] = std::array::from_fn(|_| random.random_range(0.2..2.8));
        let z = -1.8 + 0.06 * i as f32;
        let (from, to) = match i % 3 {
            0 => (vec3(-2.8, a, z), vec3(2.8, a, z)),
            1 => (vec3(2.0 * a - 3.0, 0.0, z), vec3(2.0 * a - 3.0, 3.0, z)),
            _ => (vec3(2.0 * a - 3.0, b, -2.0), vec3(2.0 * a - 3.0, b, 0.5)),
        };
        build.tube([from, to], [r, r], 16);
    }
    build.scene("pipes", &[vec3(0.5, 1.6, 5.0), vec3(-4.0, 2.0, 2.5), vec3(3.0, 0.6, 3.0)])
}

/// A garden of some 16 m with a house, a fence, trees, shrubs, a wire and a table.
pub fn garden(seed: u64) -> Scene {
    let mut random = Pcg64Mcg::seed_from_u64(seed ^ 0x9a);
    let mut build = Build::default();
    build.patch([40, 40], |u, v| {
        let (x, z) = (16.0 * v - 8.0, 16.0 * u - 8.0);
        vec3(x, 0.08 * (0.9 * x).sin() * (0.7 * z).cos(), z)
    });
    build.cuboid(vec3(-8.0, -0.2, -8.4), vec3(8.0, 3.2, -8.0));
    for x in [-5.0, -1.0, 3.5] {
        build.cuboid(vec3(x, 0.9, -8.05), vec3(x + 1.2, 2.2, -7.92));
    }
    for i in 0..96 {
        let z = -7.7 + 0.16 * i as f32;
        build.cuboid(vec3(5.988, -0.1, z - 0.045), vec3(6.012, random.random_range(1.05..1.15), z + 0.045));
    }
    for y in [0.25, 0.8] {
        build.cuboid(vec3(6.012, y, -7.8), vec3(6.05, y + 0.09, 7.6));
    }
    for at in [vec3(-4.0, 0.0, -3.5), vec3(3.0, 0.0, 4.0), vec3(-5.5, 0.0, 4.5)] {
        let mut tree = Build::default();
        tree.tree(&mut random);
        build.add(&tree.0, at);
    }
    for at in [vec3(1.0, 0.6, -6.5), vec3(-1.5, 0.6, -6.3), vec3(7.0, 0.6, 0.0)] {
        for _ in 0..200 {
            let off = direction(&mut random) * random.random_range(0.0..0.75_f32);
            build.leaf(at + off, &mut random);
        }
    }
    for x in [-6.0, 0.5] {
        build.tube([vec3(x, -0.1, 1.0), vec3(x, 2.0, 1.0)], [0.03, 0.03], 8);
    }
    build.tube([vec3(-6.0, 1.95, 1.0), vec3(0.5, 1.95, 1.0)], [0.008, 0.008], 6);
    build.table(vec3(2.5, 0.0, -2.5), vec3(0.8, 0.74, 0.45));
    for x in [1.9, 3.1] {
        for z in [-3.3, -1.7] {
            build.table(vec3(x, 0.0, z), vec3(0.22, 0.45, 0.22));
            let back = z + 0.22 * (z + 2.5_f32).signum();
            build.cuboid(vec3(x - 0.22, 0.45, back - 0.015), vec3(x + 0.22, 0.95, back + 0.015));
        }
    }
    build.scene("garden", &[vec3(0.0, 1.7, 7.0), vec3(7.6, 1.6, -4.0), vec3(-2.0, 2.6, -1.0)])
}

/// Two offices with a door between them: desks, chairs, screens, shelves, a plant.
pub fn office(seed: u64) -> Scene {
    let mut random = Pcg64Mcg::seed_from_u64(seed ^ 0x0f);
    let mut build = Build::default();
    // Floor, ceiling, outer walls, and a wall with a door.
    build.cuboid(vec3(-5.0, -0.1, -3.0), vec3(5.0, 0.0, 3.0));
    build.cuboid(vec3(-5.0, 2.7, -3.0), vec3(5.0, 2.8, 3.0));
    for s in [-1.0, 1.0] {
        build.cuboid(vec3(5.05 * s - 0.05, 0.0, -3.0), vec3(5.05 * s + 0.05, 2.7, 3.0));
        build.cuboid(vec3(-5.0, 0.0, 3.05 * s - 0.05), vec3(5.0, 2.7, 3.05 * s + 0.05));
    }
    build.cuboid(vec3(0.0, 0.0, -3.0), vec3(0.1, 2.7, 0.6));
    build.cuboid(vec3(0.0, 0.0, 1.5), vec3(0.1, 2.7, 3.0));
    build.cuboid(vec3(0.0, 2.1, 0.6), vec3(0.1, 2.7, 1.5));
    for x in [-3.6, -1.6, 1.7, 3.7] {
        let z = -1.2 + random.random_range(-0.2..0.2);
        build.table(vec3(x, 0.0, z), vec3(0.75, 0.73, 0.38));
        build.cuboid(vec3(x - 0.28, 0.85, z - 0.2), vec3(x + 0.28, 1.2, z - 0.17));
        build.cuboid(vec3(x - 0.03, 0.73, z - 0.2), vec3(x + 0.03, 0.9, z - 0.18));
        build.cuboid(vec3(x - 0.2, 0.73, z + 0.08), vec3(x + 0.2, 0.755, z + 0.22));
        // A chair on one leg with five feet.
        let at = vec3(x + random.random_range(-0.2..0.2), 0.0, z + 0.75);
        build.cuboid(at + vec3(-0.24, 0.44, -0.24), at + vec3(0.24, 0.5, 0.24));
        build.cuboid(at + vec3(-0.22, 0.6, 0.24), at + vec3(0.22, 1.05, 0.28));
        build.tube([at + Vec3::Y * 0.08, at + Vec3::Y * 0.44], [0.025, 0.025], 8);
        for k in 0..5 {
            let (sin, cos) = (TAU * k as f32 / 5.0).sin_cos();
            build.tube([at + Vec3::Y * 0.08, at + vec3(0.3 * cos, 0.05, 0.3 * sin)], [0.02, 0.02], 6);
        }
    }
    // Shelves with books.
    for x in [-4.6, 1.0, 3.0] {
        for k in 0..5 {
            let y = 0.05 + 0.4 * k as f32;
            build.cuboid(vec3(x, y, 2.7), vec3(x + 1.0, y + 0.02, 3.0));
            let mut at = x + 0.02;
            while at < x + 0.9 && k < 4 {
                let (wide, high) = (random.random_range(0.02..0.06), random.random_range(0.2..0.34));
                let front = random.random_range(2.72..2.82);
                build.cuboid(vec3(at, y + 0.02, front), vec3(at + wide, y + 0.02 + high, 2.98));
                at += wide + if random.random::<f32>() < 0.2 { 0.1 } else { 0.003 };
            }
        }
        for side in [x, x + 0.98] {
            build.cuboid(vec3(side, 0.0, 2.7), vec3(side + 0.02, 1.7, 3.0));
        }
    }
    build.tube([vec3(4.5, 0.0, 2.3), vec3(4.5, 0.4, 2.3)], [0.15, 0.2], 12);
    for _ in 0..60 {
        let off = direction(&mut random) * random.random_range(0.0..0.45_f32);
        build.leaf(vec3(4.5, 0.9, 2.3) + off, &mut random);
    }
    build.scene("office", &[vec3(-4.0, 1.6, 1.5), vec3(0.9, 1.2, 1.9), vec3(4.2, 2.2, -2.2)])
}

/// Pipes and boards on a floor, and a grove: scenes of the other kinds, for scans.
pub fn plant(seed: u64) -> Scene {
    let mut random = Pcg64Mcg::seed_from_u64(seed ^ 0xa1);
    let mut build = Build::default();
    build.cuboid(vec3(-6.0, -0.1, -3.0), vec3(6.0, 0.0, 6.0));
    build.add(&pipes(&mut random).triangles, Vec3::ZERO);
    build.add(&boards(&mut random).triangles, vec3(3.5, 1.5, 1.0));
    build.add(&solids().triangles, vec3(-4.2, 1.0, 2.5));
    build.scene("plant", &[vec3(0.5, 1.6, 5.0), vec3(-5.0, 2.0, 4.5), vec3(4.8, 0.8, 4.2)])
}

pub fn grove(seed: u64) -> Scene {
    let mut random = Pcg64Mcg::seed_from_u64(seed ^ 0x60);
    let mut build = Build::default();
    build.patch([2, 2], |u, v| vec3(24.0 * v - 12.0, 0.0, 24.0 * u - 12.0));
    for k in 0..9 {
        let at = vec3((k % 3 * 5 - 5) as f32, 0.0, (k / 3 * 5 - 5) as f32) + direction(&mut random);
        let mut tree = Build::default();
        tree.tree(&mut random);
        build.add(&tree.0, vec3(at.x, 0.0, at.z));
    }
    build.scene("grove", &[vec3(7.0, 1.7, 7.0), vec3(-8.0, 1.6, 0.0), vec3(2.5, 1.5, 2.5)])
}
