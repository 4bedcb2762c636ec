//! Meshes and random numbers for tests.

use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::mesh::{Mesh, Vertex, continuous_normals, weld};

/// Seeded random numbers.
pub(crate) struct Dice(Pcg64Mcg);

pub(crate) fn dice(seed: u64) -> Dice {
    Dice(Pcg64Mcg::seed_from_u64(seed))
}

impl Dice {
    /// A number from 0 to 1.
    pub(crate) fn next(&mut self) -> f64 {
        self.0.random()
    }

    /// A point with coordinates from -1 to 1.
    pub(crate) fn point(&mut self) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| (2.0 * self.next() - 1.0) as f32))
    }

    /// A direction.
    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let p = self.point();
            if p.length_squared() > 0.01 && p.length_squared() < 1.0 {
                return p.normalize();
            }
        }
    }
}

/// Adds a quad with its flat normal, counter-clockwise.
fn quad(soup: &mut Vec<Vertex>, q: [Vec3; 4]) {
    let normal = (q[1] - q[0]).cross(q[2] - q[0]).normalize();
    soup.extend([0, 1, 2, 0, 2, 3].map(|i| Vertex { position: q[i], normal }));
}

/// The six sides of a cube around the origin, each of n times n quads.
fn sides(half: f32, n: usize) -> Vec<Vertex> {
    let mut soup = Vec::new();
    for axis in 0..3 {
        for sign in [-1.0_f32, 1.0] {
            let at = |i: usize, j: usize| {
                let mut p = Vec3::ZERO;
                p[axis] = sign * half;
                let place = |i: usize| half * (2.0 * i as f32 / n as f32 - 1.0);
                p[(axis + 1) % 3] = place(i);
                p[(axis + 2) % 3] = place(j);
                p
            };
            for (i, j) in (0..n * n).map(|k| (k % n, k / n)) {
                let q = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                quad(&mut soup, if sign > 0.0 { q } else { [q[0], q[3], q[2], q[1]] });
            }
        }
    }
    soup
}

/// The twelve triangles of a cube around the origin, with flat normals.
pub(crate) fn cube(edge: f32) -> Vec<Vertex> {
    sides(edge / 2.0, 1)
}

/// A torus around the y axis, with flat normals: 2 n m triangles.
pub(crate) fn torus(large: f32, small: f32, n: usize, m: usize) -> Vec<Vertex> {
    let at = |i: usize, j: usize| {
        let angle = |i: usize, n: usize| (i % n) as f32 / n as f32 * std::f32::consts::TAU;
        let ((sa, ca), (sb, cb)) = (angle(i, n).sin_cos(), angle(j, m).sin_cos());
        Vec3::new((large + small * cb) * ca, small * sb, (large + small * cb) * sa)
    };
    let mut soup = Vec::new();
    for (i, j) in (0..n * m).map(|k| (k % n, k / n)) {
        quad(&mut soup, [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
    }
    soup
}

/// A torus of n rings with smooth normals.
pub(crate) fn torus_mesh(n: usize) -> Mesh {
    smooth(torus(3.0, 1.0, n, n / 3))
}

fn smooth(mut soup: Vec<Vertex>) -> Mesh {
    continuous_normals(&mut soup).unwrap();
    weld(&soup, &[]).unwrap()
}

/// A ball of radius 1 with smooth normals: 12 n² triangles.
pub(crate) fn ball(n: usize) -> Mesh {
    let mut soup = sides(1.0, n);
    soup.iter_mut().for_each(|v| *v = Vertex::at(v.position.normalize()));
    smooth(soup)
}
