//! Meshes for tests.

use casca_scenes::world;
use glam::Vec3;

use crate::mesh::{Mesh, Vertex, continuous_normals, weld};

/// The corners of a mesh with flat normals.
fn soup(mesh: &world::Mesh) -> Vec<Vertex> {
    let flat = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        let normal = (b - a).cross(c - a).normalize();
        [a, b, c].map(|position| Vertex { position, normal })
    };
    mesh.triangles.iter().flat_map(flat).collect()
}

/// The twelve triangles of a cube around the origin, with flat normals.
pub(crate) fn cube(edge: f32) -> Vec<Vertex> {
    soup(&world::Mesh::cuboid(Vec3::splat(-0.5 * edge), Vec3::splat(0.5 * edge)))
}

/// A torus around the y axis, with flat normals: 2 n m triangles.
pub(crate) fn torus(large: f32, small: f32, n: usize, m: usize) -> Vec<Vertex> {
    let at = |i: usize, j: usize| {
        let angle = |i: usize, n: usize| (i % n) as f32 / n as f32 * std::f32::consts::TAU;
        let ((sa, ca), (sb, cb)) = (angle(i, n).sin_cos(), angle(j, m).sin_cos());
        Vec3::new((large + small * cb) * ca, small * sb, (large + small * cb) * sa)
    };
    let quad = |k: usize| {
        let (i, j) = (k % n, k / n);
        let q = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
        let normal = (q[1] - q[0]).cross(q[2] - q[0]).normalize();
        [0, 1, 2, 0, 2, 3].map(|i| Vertex { position: q[i], normal })
    };
    (0..n * m).flat_map(quad).collect()
}

/// A torus of n rings with smooth normals.
pub(crate) fn torus_mesh(n: usize) -> Mesh {
    smooth(torus(3.0, 1.0, n, n / 3))
}

/// A ball of radius 1 with smooth normals: 20 triangles, each cut into 4 so often.
pub(crate) fn ball(cuts: u32) -> Mesh {
    smooth(soup(&world::Mesh::ball(cuts)))
}

fn smooth(mut soup: Vec<Vertex>) -> Mesh {
    continuous_normals(&mut soup).unwrap();
    weld(&soup, &[]).unwrap()
}
