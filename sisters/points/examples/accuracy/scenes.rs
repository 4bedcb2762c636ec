//! Scenes of triangles, made by rules: kinds that the defaults of `surface` were chosen on,
//! and others that they were not.

use crate::scans::Plan;
use glam::{Mat3, Quat, Vec3, vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f32::consts::{PI, TAU};
use std::ops::Range;

/// Triangles of which twice the area is less, in square metres, are lines.
const LEAST_CROSS: f32 = 1e-12;

/// Triangles, and eyes that look at them.
pub struct Scene {
    pub name: &'static str,
    pub triangles: Vec<[Vec3; 3]>,
    pub eyes: [Vec3; 3],
}

/// The scenes and scans that defaults were chosen on, and those that they were not.
pub fn tuned() -> (Vec<Scene>, Vec<Plan>) {
    let mut build = Build::new(3);
    let scenes = vec![
        build.scene("thin boards", Build::boards, [[5.0, 2.0, 4.0], [-6.0, 0.5, 1.0], [0.5, 5.0, -3.0]]),
        build.scene("fence", Build::fence, [[1.0, 1.5, 5.0], [-3.0, 1.2, 3.5], [2.0, 2.5, -5.0]]),
        build.scene("thick solids", Build::solids, [[2.0, 3.0, 6.0], [-6.0, 1.0, 2.0], [4.0, 2.5, -6.0]]),
    ];
    let eyes = [[-4.0, 1.6, 1.5], [0.9, 1.2, 1.9], [4.2, 2.2, -2.2]];
    let office = Build::new(0x0c).scene("office", Build::office, eyes);
    let scans = vec![
        (garden(0x99), vec![vec3(-1.0, 1.6, 2.5), vec3(4.5, 1.6, -5.0)], [0.5, 0.004, 0.0, 0.056, 0.010]),
        (office, vec![vec3(-2.5, 1.5, 0.6), vec3(2.6, 1.5, 0.8)], [0.6, 0.002, 0.0, 0.007, 0.003]),
    ];
    (scenes, scans)
}

pub fn held_out() -> (Vec<Scene>, Vec<Plan>) {
    let mut build = Build::new(0x5eee);
    build.cuboid(vec3(-3.0, -0.2, -3.0), vec3(3.0, 0.0, 3.0));
    let scenes = vec![
        build.scene("tree", Build::tree, [[4.0, 1.7, 3.0], [-3.0, 3.0, 4.0], [0.5, 0.8, -5.0]]),
        build.scene("pipes", Build::pipes, [[0.5, 1.6, 5.0], [-4.0, 2.0, 2.5], [3.0, 0.6, 3.0]]),
    ];
    let eyes = [[0.5, 1.6, 5.0], [-5.0, 2.0, 4.5], [4.8, 0.8, 4.2]];
    let plant = Build::new(0xa2).scene("plant", Build::plant, eyes);
    let eyes = [[7.0, 1.7, 7.0], [-8.0, 1.6, 0.0], [2.5, 1.5, 2.5]];
    let grove = Build::new(0x63).scene("grove", Build::grove, eyes);
    let scans = vec![
        (plant, vec![vec3(2.0, 1.4, 5.0), vec3(-3.0, 1.7, 5.5)], [0.3, 0.003, 0.0, 0.03, 0.004]),
        (grove, vec![vec3(2.0, 1.7, -2.0)], [0.4, 0.005, 0.0, 0.04, 0.01]),
        (garden(0x9e), vec![vec3(-2.0, 1.6, -1.0)], [0.35, 0.003, 0.0, 0.056, 0.010]),
    ];
    (scenes, scans)
}

fn garden(seed: u64) -> Scene {
    let eyes = [[0.0, 1.7, 7.0], [7.6, 1.6, -4.0], [-2.0, 2.6, -1.0]];
    Build::new(seed).scene("garden", Build::garden, eyes)
}

/// Triangles that grow, by chance.
struct Build(Vec<[Vec3; 3]>, Pcg64Mcg);

impl Build {
    fn new(seed: u64) -> Self {
        Self(Vec::new(), Pcg64Mcg::seed_from_u64(seed))
    }

    fn scene(&mut self, name: &'static str, make: impl Fn(&mut Self), eyes: [[f32; 3]; 3]) -> Scene {
        make(self);
        let whole = |t: &[Vec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]).length() > LEAST_CROSS;
        Scene { name, triangles: self.0.drain(..).filter(whole).collect(), eyes: eyes.map(Vec3::from) }
    }

    /// Adds the triangles of `make`, moved by an offset.
    fn moved(&mut self, by: Vec3, make: impl Fn(&mut Self)) {
        let start = self.0.len();
        make(self);
        self.0[start..].iter_mut().for_each(|t| *t = t.map(|p| p + by));
    }

    fn range(&mut self, range: Range<f32>) -> f32 {
        self.1.random_range(range)
    }

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

    /// A box at several places along an axis.
    fn boxes(&mut self, axis: Vec3, at: &[f32], corners: [[f32; 3]; 2]) {
        let [low, high] = corners.map(Vec3::from);
        at.iter().for_each(|at| self.cuboid(axis * at + low, axis * at + high));
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

    /// A plate on four legs.
    fn table(&mut self, at: Vec3, half: Vec3) {
        self.cuboid(at + vec3(-half.x, half.y - 0.03, -half.z), at + half);
        for (x, z) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let leg = at + vec3(x * (half.x - 0.03), 0.0, z * (half.z - 0.03));
            self.cuboid(leg - vec3(0.02, 0.0, 0.02), leg + vec3(0.02, half.y - 0.03, 0.02));
        }
    }

    fn direction(&mut self) -> Vec3 {
        loop {
            let v = Vec3::from_array(std::array::from_fn(|_| self.range(-1.0..1.0)));
            if v.length_squared() > 0.01 && v.length_squared() < 1.0 {
                return v.normalize();
            }
        }
    }

    fn turn(&mut self) -> Quat {
        Quat::from_axis_angle(self.direction(), self.range(0.0..TAU))
    }

    fn tree(&mut self) {
        self.tube([Vec3::ZERO, vec3(0.1, 2.4, 0.0)], [0.16, 0.1], 14);
        for _ in 0..14 {
            let from = vec3(0.05, self.range(1.0..2.4), 0.0);
            let to = from + (self.direction() + Vec3::Y * 0.5) * self.range(0.6..1.3);
            self.tube([from, to], [0.04, 0.015], 8);
            for _ in 0..22 {
                let at = from.lerp(to, self.range(0.3..1.0)) + self.direction() * 0.2;
                self.leaf(at);
            }
        }
    }

    fn shrub(&mut self, at: Vec3, leaves: usize, size: f32) {
        for _ in 0..leaves {
            let off = self.direction() * self.range(0.0..size);
            self.leaf(at + off);
        }
    }

    /// A sheet of one side.
    fn leaf(&mut self, at: Vec3) {
        let q = self.turn();
        let leaf = |x: f32, y: f32| at + q * vec3(x * 0.07, y * 0.11, 0.0);
        self.quad([leaf(-1.0, 0.0), leaf(0.0, -1.0), leaf(1.0, 0.0), leaf(0.0, 1.0)]);
    }

    fn boards(&mut self) {
        for _ in 0..24 {
            let middle = Vec3::from([2.0, 1.5, 2.0].map(|most| self.range(-most..most)));
            let half = vec3(self.range(0.3..0.8), self.range(0.2..0.5), 0.012);
            let turn = self.turn();
            self.turned(middle, half, turn);
        }
    }

    fn fence(&mut self) {
        self.cuboid(vec3(-4.0, -0.2, -3.0), vec3(4.0, 0.0, 3.0));
        for i in 0..48 {
            let x = -3.8 + 7.6 * i as f32 / 47.0;
            let high = 1.1 + self.range(-0.05..0.05);
            self.cuboid(vec3(x - 0.045, 0.0, -0.012), vec3(x + 0.045, high, 0.012));
        }
        self.boxes(Vec3::Y, &[0.25, 0.8], [[-3.9, 0.0, -0.05], [3.9, 0.09, -0.012]]);
        self.boxes(Vec3::X, &[-2.6, 0.3, 2.2], [[0.0, 0.0, -2.0], [0.8, 0.9, -1.3]]);
    }

    fn solids(&mut self) {
        self.patch([32, 16], |u, v| {
            let ((sin, cos), (y, x)) = ((PI * (v - 0.5)).sin_cos(), (TAU * u).sin_cos());
            vec3(-1.4, 0.0, 0.0) + vec3(cos * x, cos * y, sin)
        });
        self.turned(vec3(1.3, 0.0, 0.3), vec3(0.8, 0.8, 0.8), Quat::from_rotation_y(0.4));
        self.patch([48, 24], |u, v| {
            let (a, b) = (Mat3::from_rotation_z(TAU * u), TAU * v);
            vec3(0.0, 0.4, -2.4) + a * vec3(1.1 + 0.4 * b.cos(), 0.0, 0.4 * b.sin())
        });
    }

    fn pipes(&mut self) {
        self.cuboid(vec3(-3.0, -0.1, -2.2), vec3(3.0, 3.0, -2.0));
        for i in 0..36 {
            let r = self.range(0.03..0.16);
            let [a, b] = std::array::from_fn(|_| self.range(0.2..2.8));
            let z = -1.8 + 0.06 * i as f32;
            let (from, to) = match i % 3 {
                0 => (vec3(-2.8, a, z), vec3(2.8, a, z)),
                1 => (vec3(2.0 * a - 3.0, 0.0, z), vec3(2.0 * a - 3.0, 3.0, z)),
                _ => (vec3(2.0 * a - 3.0, b, -2.0), vec3(2.0 * a - 3.0, b, 0.5)),
            };
            self.tube([from, to], [r, r], 16);
        }
    }

    /// A garden of some 16 m with a house, a fence, trees, shrubs, a wire and a table.
    fn garden(&mut self) {
        self.patch([40, 40], |u, v| {
            let (x, z) = (16.0 * v - 8.0, 16.0 * u - 8.0);
            vec3(x, 0.08 * (0.9 * x).sin() * (0.7 * z).cos(), z)
        });
        self.cuboid(vec3(-8.0, -0.2, -8.4), vec3(8.0, 3.2, -8.0));
        self.boxes(Vec3::X, &[-5.0, -1.0, 3.5], [[0.0, 0.9, -8.05], [1.2, 2.2, -7.92]]);
        for i in 0..96 {
            let z = -7.7 + 0.16 * i as f32;
            let high = self.range(1.05..1.15);
            self.cuboid(vec3(5.988, -0.1, z - 0.045), vec3(6.012, high, z + 0.045));
        }
        self.boxes(Vec3::Y, &[0.25, 0.8], [[6.012, 0.0, -7.8], [6.05, 0.09, 7.6]]);
        for at in [vec3(-4.0, 0.0, -3.5), vec3(3.0, 0.0, 4.0), vec3(-5.5, 0.0, 4.5)] {
            self.moved(at, Self::tree);
        }
        for at in [vec3(1.0, 0.6, -6.5), vec3(-1.5, 0.6, -6.3), vec3(7.0, 0.6, 0.0)] {
            self.shrub(at, 200, 0.75);
        }
        for x in [-6.0, 0.5] {
            self.tube([vec3(x, -0.1, 1.0), vec3(x, 2.0, 1.0)], [0.03, 0.03], 8);
        }
        self.tube([vec3(-6.0, 1.95, 1.0), vec3(0.5, 1.95, 1.0)], [0.008, 0.008], 6);
        self.table(vec3(2.5, 0.0, -2.5), vec3(0.8, 0.74, 0.45));
        for x in [1.9, 3.1] {
            for z in [-3.3, -1.7] {
                self.table(vec3(x, 0.0, z), vec3(0.22, 0.45, 0.22));
                let back = z + 0.22 * (z + 2.5_f32).signum();
                self.cuboid(vec3(x - 0.22, 0.45, back - 0.015), vec3(x + 0.22, 0.95, back + 0.015));
            }
        }
    }

    /// Two offices with a door between them: desks, chairs, screens, shelves, a plant.
    fn office(&mut self) {
        // Floor, ceiling, outer walls, and a wall with a door.
        self.cuboid(vec3(-5.0, -0.1, -3.0), vec3(5.0, 0.0, 3.0));
        self.cuboid(vec3(-5.0, 2.7, -3.0), vec3(5.0, 2.8, 3.0));
        self.boxes(Vec3::X, &[-5.05, 5.05], [[-0.05, 0.0, -3.0], [0.05, 2.7, 3.0]]);
        self.boxes(Vec3::Z, &[-3.05, 3.05], [[-5.0, 0.0, -0.05], [5.0, 2.7, 0.05]]);
        self.cuboid(vec3(0.0, 0.0, -3.0), vec3(0.1, 2.7, 0.6));
        self.cuboid(vec3(0.0, 0.0, 1.5), vec3(0.1, 2.7, 3.0));
        self.cuboid(vec3(0.0, 2.1, 0.6), vec3(0.1, 2.7, 1.5));
        for x in [-3.6, -1.6, 1.7, 3.7] {
            let z = -1.2 + self.range(-0.2..0.2);
            self.table(vec3(x, 0.0, z), vec3(0.75, 0.73, 0.38));
            self.cuboid(vec3(x - 0.28, 0.85, z - 0.2), vec3(x + 0.28, 1.2, z - 0.17));
            self.cuboid(vec3(x - 0.03, 0.73, z - 0.2), vec3(x + 0.03, 0.9, z - 0.18));
            self.cuboid(vec3(x - 0.2, 0.73, z + 0.08), vec3(x + 0.2, 0.755, z + 0.22));
            // A chair on one leg with five feet.
            let at = vec3(x + self.range(-0.2..0.2), 0.0, z + 0.75);
            self.cuboid(at + vec3(-0.24, 0.44, -0.24), at + vec3(0.24, 0.5, 0.24));
            self.cuboid(at + vec3(-0.22, 0.6, 0.24), at + vec3(0.22, 1.05, 0.28));
            self.tube([at + Vec3::Y * 0.08, at + Vec3::Y * 0.44], [0.025, 0.025], 8);
            for k in 0..5 {
                let (sin, cos) = (TAU * k as f32 / 5.0).sin_cos();
                self.tube([at + Vec3::Y * 0.08, at + vec3(0.3 * cos, 0.05, 0.3 * sin)], [0.02, 0.02], 6);
            }
        }
        // Shelves with books.
        for x in [-4.6, 1.0, 3.0] {
            for k in 0..5 {
                let y = 0.05 + 0.4 * k as f32;
                self.cuboid(vec3(x, y, 2.7), vec3(x + 1.0, y + 0.02, 3.0));
                let mut at = x + 0.02;
                while at < x + 0.9 && k < 4 {
                    let (wide, high) = (self.range(0.02..0.06), self.range(0.2..0.34));
                    let front = self.range(2.72..2.82);
                    self.cuboid(vec3(at, y + 0.02, front), vec3(at + wide, y + 0.02 + high, 2.98));
                    at += wide + if self.1.random::<f32>() < 0.2 { 0.1 } else { 0.003 };
                }
            }
            self.boxes(Vec3::X, &[x, x + 0.98], [[0.0, 0.0, 2.7], [0.02, 1.7, 3.0]]);
        }
        self.tube([vec3(4.5, 0.0, 2.3), vec3(4.5, 0.4, 2.3)], [0.15, 0.2], 12);
        self.shrub(vec3(4.5, 0.9, 2.3), 60, 0.45);
    }

    /// The kinds for scans that are not tuned.
    fn plant(&mut self) {
        self.cuboid(vec3(-6.0, -0.1, -3.0), vec3(6.0, 0.0, 6.0));
        self.pipes();
        self.moved(vec3(3.5, 1.5, 1.0), Self::boards);
        self.moved(vec3(-4.2, 1.0, 2.5), Self::solids);
    }

    fn grove(&mut self) {
        self.patch([2, 2], |u, v| vec3(24.0 * v - 12.0, 0.0, 24.0 * u - 12.0));
        for k in 0..9 {
            let at = vec3((k % 3 * 5 - 5) as f32, 0.0, (k / 3 * 5 - 5) as f32) + self.direction();
            self.moved(vec3(at.x, 0.0, at.z), Self::tree);
        }
    }
}
